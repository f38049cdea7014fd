#!/usr/bin/python3
"""Draws mutants of the code by a seed, and puts all of them into a copy of the tree, each behind a switch.

Usage: draw.py --flags BUILD --seed N [--each 30] --list                 what is drawn, one mutant a line
       draw.py --flags BUILD --seed N [--each 30] --into TREE            puts them into TREE, a copy of this tree
       draw.py --flags BUILD --self-test

BUILD is a configured build tree: its compile_commands.json names the folders of headers. Mutant k of TREE is switched on
by ODOMCALIB_MUTANT=k in the environment (drawn_mutant.hpp); run_drawn.py runs them. The list goes to TREE/drawn.json.
Needs the Debian package python3-clang-14. Same seed, same code: same list.

From each folder as many mutants as --each says, from all kinds by turns: a comparison swapped, && and || exchanged, a
condition negated, a guard or a statement left out, an integer one off, a constant twice or half as large, left and right
exchanged, a call of another function (min for max) or with arguments exchanged. What must be constant for the compiler
is left alone, and what does not compile is drawn again.
"""

import argparse
import bisect
import dataclasses
import hashlib
import inspect
import itertools
import json
import pathlib
import pickle
import random
import re
import shlex
import sys

from clang import cindex
from clang.cindex import CursorKind as Kind

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FOLDERS = ["daemon/safety", "daemon/writeback", "daemon/service", "drivers/base", "calib/report", "calib/ingest",
           "calib/estimation"]
GUARD = '#include "tests/mutation/drawn_mutant.hpp"\n#line 1\n'
COMPARISONS = {"<": ["<=", ">"], ">": [">=", "<"], "<=": ["<", ">="], ">=": [">", "<="], "==": ["!="], "!=": ["=="]}
OTHER_CALLS = {"min": "max", "max": "min", "floor": "ceil", "ceil": "floor", "sin": "cos", "cos": "sin",
               "any_of": "all_of", "all_of": "any_of", "front": "back", "back": "front", "round": "floor"}
OTHER_SIDE = {"left": "right", "right": "left", "Left": "Right", "Right": "Left"}
NUMBER = re.compile(r"(0[xX][0-9a-fA-F']+|[0-9][0-9']*)([uUlLzZ]*)$")


@dataclasses.dataclass(frozen=True, order=True)
class Mutant:
    """One change: the text from begin to end becomes mutated while its switch is on. Both texts are made of the ranges in
    parts, which may hold further mutants: {0} is the first of them."""
    file: str
    begin: int
    end: int
    kind: str
    original: str
    mutated: str
    parts: tuple
    form: str  # of the two in one text; {on} is the switch
    function: str
    line: int
    last_line: int
    what: str


def flags_of(build):
    """What all sources of a build tree together find their headers with."""
    flags = dict.fromkeys(["-std=c++20", "-Wno-everything", "-Werror=vla", "-ferror-limit=0"])
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        words = shlex.split(entry["command"])
        for word, following in zip(words, words[1:] + [""]):
            if word == "-isystem":
                flags["-isystem" + following] = None
            elif word.startswith(("-I", "-D")) and "QUOTE" not in word:
                flags[word] = None
    return list(flags)


def type_of(cursor):
    return cursor.type.get_canonical().spelling.replace("const ", "")


class Source:
    """Finds what can be changed in one file."""

    def __init__(self, path, unit):
        self.path = path
        self.text = (ROOT / path).read_bytes().decode("latin-1")  # a byte a character: offsets are of bytes
        self.lines = [0] + [match.end() for match in re.finditer("\n", self.text)]
        self.found = []
        for cursor in unit.cursor.get_children():
            if cursor.location.file and cursor.location.file.name == str(ROOT / path):
                self.walk(cursor, "")

    def range_of(self, cursor):
        return cursor.extent.start.offset, cursor.extent.end.offset

    def words(self, place):
        return self.text[place[0]:place[1]]

    def add(self, kind, function, place, original, mutated, parts, what, form="({on} ? {mutated} : {original})"):
        short = lambda text: " ".join(text.split())
        self.found.append(Mutant(self.path, *place, kind, original, mutated, tuple(parts), form, function,
                                 bisect.bisect(self.lines, place[0]), bisect.bisect(self.lines, place[1] - 1),
                                 short(what)))

    def walk(self, cursor, function):
        kind, place = cursor.kind, self.range_of(cursor)
        text = self.words(place)
        if kind in (Kind.STATIC_ASSERT, Kind.ENUM_DECL, Kind.TYPE_ALIAS_DECL, Kind.TEMPLATE_TEMPLATE_PARAMETER):
            return
        if kind in (Kind.VAR_DECL, Kind.FUNCTION_DECL, Kind.CXX_METHOD, Kind.FUNCTION_TEMPLATE, Kind.CONSTRUCTOR):
            head = text[:text.find("{")] if kind != Kind.VAR_DECL and "{" in text else text
            if re.search(r"\bconst(expr|eval|init)\b", head.split("=")[0]):
                return
        if kind in (Kind.FUNCTION_DECL, Kind.CXX_METHOD, Kind.FUNCTION_TEMPLATE, Kind.CONSTRUCTOR):
            parent = cursor.semantic_parent
            of_type = parent.spelling + "::" if kind in (Kind.CXX_METHOD, Kind.CONSTRUCTOR) else ""
            function = of_type + re.sub("<.*", "", cursor.spelling)
        children = list(cursor.get_children())
        if function:
            self.look(cursor, kind, place, text, children, function)
        for number, child in enumerate(children):
            if kind == Kind.CASE_STMT and number == 0:
                continue
            if kind == Kind.IF_STMT and re.match(r"if\s+constexpr", text) and number == 0:
                continue
            self.walk(child, function)

    def look(self, cursor, kind, place, text, children, function):
        if kind == Kind.BINARY_OPERATOR or (kind == Kind.CALL_EXPR and len(children) == 3
                                            and cursor.spelling.startswith("operator")):
            self.operator(place, self.range_of(children[0]), self.range_of(children[-1]), function)
        if kind in (Kind.IF_STMT, Kind.CONDITIONAL_OPERATOR):
            self.condition(kind, text, children, function)
        if kind == Kind.COMPOUND_STMT:
            for child in children:
                self.statement(child, function)
        if kind == Kind.INTEGER_LITERAL and NUMBER.match(text):
            for sign in "+-" if text.rstrip("uUlLzZ") != "0" else "+":
                self.add("integer one off", function, place, text, f"{text} {sign} 1", [], f"`{text} {sign} 1`")
        if kind == Kind.CXX_BOOL_LITERAL_EXPR and text in ("true", "false"):
            other = "false" if text == "true" else "true"
            self.add("constant", function, place, text, other, [], f"`{other}` for `{text}`")
        if kind == Kind.FLOATING_LITERAL and float(text.rstrip("fF").replace("'", "")) != 0.0:
            self.scaled(place, text, function)
        if kind == Kind.DECL_REF_EXPR and re.fullmatch(r"([\w:]+::)?k[A-Z]\w*", text):
            if cursor.type.get_canonical().kind in (cindex.TypeKind.DOUBLE, cindex.TypeKind.FLOAT):
                self.scaled(place, text, function)
            elif cursor.type.get_canonical().kind in (cindex.TypeKind.INT, cindex.TypeKind.ULONG, cindex.TypeKind.UINT):
                for sign in "+-":
                    self.add("integer one off", function, place, text, f"{text} {sign} 1", [], f"`{text} {sign} 1`")
        if kind in (Kind.MEMBER_REF_EXPR, Kind.DECL_REF_EXPR) and not self.is_callee(place):
            self.side(place, text, function)
        if kind == Kind.CALL_EXPR and text.endswith(")"):
            self.call(cursor, place, text, function)

    def is_callee(self, place):
        return self.text[place[1]:place[1] + 1] == "("

    def operator(self, place, left, right, function):
        if not place[0] <= left[0] < left[1] <= right[0] < right[1] <= place[1]:
            return
        sign = re.sub(r"/\*.*?\*/|//[^\n]*|\s", "", self.words((left[1], right[0])))
        others = [("comparison", one) for one in COMPARISONS.get(sign, [])]
        others += [("connective", {"&&": "||", "||": "&&"}[sign])] if sign in ("&&", "||") else []
        for kind, other in others:
            self.add(kind, function, place, f"({{0}}) {sign} ({{1}})", f"({{0}}) {other} ({{1}})", [left, right],
                     f"`{other}` for `{sign}` in `{self.words(place)}`")

    def condition(self, kind, text, children, function):
        if not children or not children[0].kind.is_expression():
            return
        place = self.range_of(children[0])
        said = self.words(place)
        if not said or re.match(r"if\s+constexpr", text) or (kind == Kind.IF_STMT and not re.match(r"if\s*\(\s*$",
                                                             text[:max(0, text.find(said))])):
            return
        self.add("condition", function, place, "{0}", "!({0})", [place], f"`!({said})`",
                 "({on} != static_cast<bool>({original}))")
        if kind == Kind.IF_STMT and len(children) == 2:
            self.add("guard left out", function, place, "{0}", "false", [place], f"never `{said}`",
                     "(!{on} && ({original}))")

    def statement(self, child, function):
        place = self.range_of(child)
        said = self.words(place)
        if (child.kind.is_expression() or child.kind in (Kind.BREAK_STMT, Kind.CONTINUE_STMT)) and said:
            self.add("statement left out", function, place, "{0}", "", [place], f"without `{said}`",
                     "if ({on}) {{}} else {original}")

    def scaled(self, place, text, function):
        for factor in ("2.0", "0.5"):
            self.add("constant", function, place, text, f"{text} * {factor}", [], f"`{text} * {factor}`")

    def side(self, place, text, function):
        name = re.search(r"(\w+)$", text)
        other = name and re.sub(r"(?<![a-z])(left|right)(?![a-z])|(Left|Right)(?![a-z])",
                                lambda match: OTHER_SIDE[match.group()], name.group())
        if other and other != name.group():
            self.add("left and right", function, place, text, text[:name.start()] + other, [],
                     f"`{other}` for `{name.group()}` in `{text}`")

    def call(self, cursor, place, text, function):
        arguments = list(cursor.get_arguments())
        name = re.match(r"([\w:.>\[\]-]*?)(\w+)(?:<[^()]*>)?\(", text)
        if not name or cursor.spelling.startswith("operator"):
            return
        other = OTHER_CALLS.get(name.group(2))
        if other and name.group(2) == cursor.spelling:
            mutated = text[:name.start(2)] + other + text[name.end(2):]
            self.add("call", function, place, text, mutated, [], f"`{other}` for `{name.group(2)}` in `{text}`")
        if cursor.spelling in ("min", "max", "hypot", "swap"):  # the same either way
            return
        for first, second in zip(arguments, arguments[1:]):
            one, two = self.range_of(first), self.range_of(second)
            if not place[0] < one[0] < one[1] <= two[0] < two[1] < place[1] or self.words(one) == self.words(two):
                continue
            if type_of(first) == type_of(second):
                mutated = (text[:one[0] - place[0]] + self.words(two) + self.text[one[1]:two[0]] + self.words(one)
                           + text[two[1] - place[0]:])
                self.add("call", function, place, text, mutated, [],
                         f"`{self.words(one)}` and `{self.words(two)}` exchanged in `{text}`")


def rendered(text, numbered):
    """The source with the given mutants [(number, mutant)] behind their switches."""
    def render(begin, end, inside):
        result, at = "", begin
        while inside:
            number, outer = inside[0]
            covered = [one for one in inside[1:] if one[1].begin < outer.end]
            inside = inside[1 + len(covered):]
            result += text[at:outer.begin] + put(number, outer, covered)
            at = outer.end
        return result + text[at:end]

    def put(number, outer, covered):
        parts = [render(*part, [one for one in covered if part[0] <= one[1].begin and one[1].end <= part[1]])
                 for part in outer.parts]
        filled = lambda form: form if not outer.parts else form.format(*parts)
        original = filled(outer.original) if outer.parts else render(outer.begin, outer.end, covered)
        return outer.form.format(on=f"odomcalib_mutant({number})", original=original, mutated=filled(outer.mutated))

    return render(0, len(text), sorted(numbered, key=lambda one: (one[1].begin, -one[1].end, one[0])))


def parsed(paths, flags, changed=None):
    """Sources as one translation unit, as a build in batches has them: headers are read once. changed: {path: text}"""
    batch = str(ROOT / "drawn_batch.cpp")
    texts = [(str(ROOT / path), text) for path, text in (changed or {}).items()]
    texts.append((batch, "".join(f'#include "{path}"\n' for path in paths)))
    return cindex.Index.create().parse(batch, args=flags, unsaved_files=texts)


def errors_of(unit):
    """[(file, line, text)]; read while the unit lives."""
    return [(one.location.file.name if one.location.file else "", one.location.line, one.spelling)
            for one in unit.diagnostics if one.severity >= cindex.Diagnostic.Error]


def batches_of(files, flags):
    """[(files that compile as one, their unit)]"""
    for folder in dict.fromkeys(pathlib.PurePath(path).parent for path in files):
        own = [path for path in files if pathlib.PurePath(path).parent == folder]
        unit = parsed(own, flags)
        if errors_of(unit) and len(own) > 1:
            print(f"{folder}: {errors_of(unit)[0]}: one source at a time", file=sys.stderr)
            yield from (([path], parsed([path], flags)) for path in own)
        else:
            yield own, unit


def that_do_not_compile(batch, texts, mutants, flags):
    """The mutants of a batch that the compiler does not take, by what it says of their lines."""
    numbered = list(enumerate(mutants))
    changed = {path: GUARD + rendered(texts[path], [pair for pair in numbered if pair[1].file == path])
               for path in batch}
    wrong = errors_of(parsed(batch, flags, changed))
    # Presumed lines are not those of the location: two were put before.
    places = {(file, line - 2) for file, line, _ in wrong}
    blamed = [one for one in mutants
              if any((str(ROOT / one.file), line) in places for line in range(one.line, one.last_line + 1))]
    if not wrong or blamed:
        return blamed
    if len(mutants) == 1:
        return mutants
    half = len(mutants) // 2
    return that_do_not_compile(batch, texts, mutants[:half], flags) + that_do_not_compile(batch, texts, mutants[half:], flags)


def order(candidates, seed, folder):
    """All candidates of a folder as they are drawn: by turns of all kinds."""
    chance = random.Random(f"{seed} {folder}")
    kinds = {}
    for one in sorted(candidates):
        kinds.setdefault(one.kind, []).append(one)
    for own in kinds.values():
        chance.shuffle(own)
    while kinds:
        for kind in chance.sample(sorted(kinds), len(kinds)):
            yield kinds[kind].pop()
            if not kinds[kind]:
                del kinds[kind]


def places_of(files, flags, memory):
    """(batches, {path: mutants}) of all places of the files, from the memory where nothing changed: parsing takes minutes."""
    rules = inspect.getsource(Source) + inspect.getsource(Mutant)
    key = hashlib.sha256(repr([rules, flags, [(ROOT / path).read_bytes() for path in files]]).encode())
    stored = memory / f"drawn_places_{key.hexdigest()[:16]}.pickle"
    if stored.exists():
        return pickle.loads(stored.read_bytes())
    batches, places = [], {}
    for batch, unit in batches_of(files, flags):
        batches.append(batch)
        for path in batch:
            places[path] = Source(path, unit).found
            print(f"{path}: {len(places[path])} places", file=sys.stderr)
    stored.write_bytes(pickle.dumps((batches, places)))
    return batches, places


def draw(files, flags, memory, seed, each):
    """[(number, mutant)] that compile, and the texts of their files."""
    batches, places = places_of(files, flags, memory)
    texts = {path: (ROOT / path).read_bytes().decode("latin-1") for path in files}
    drawn = []
    for folder in dict.fromkeys(folder_of(path) for path in files):
        waiting = order([one for path in files if folder_of(path) == folder for one in places[path]], seed, folder)
        taken, dirty = list(itertools.islice(waiting, each)), batches
        while dirty:
            bad = set()
            for batch in dirty:
                own = [one for one in taken if one.file in batch]
                bad |= set(that_do_not_compile(batch, texts, own, flags) if own else [])
            fresh = list(itertools.islice(waiting, len(bad)))
            taken = [one for one in taken if one not in bad] + fresh
            dirty = [batch for batch in batches if any(one.file in batch for one in [*bad, *fresh])]
        drawn += sorted(taken)
    return list(enumerate(drawn)), texts


def folder_of(path):
    return next(folder for folder in FOLDERS if path.startswith(folder + "/"))


def sources_of_folders():
    found = [path.relative_to(ROOT).as_posix() for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.cpp"))]
    return sorted(found, key=lambda path: (FOLDERS.index(folder_of(path)), path))


def put_into(tree, numbered, texts):
    for path in dict.fromkeys(one.file for _, one in numbered):
        if (tree / path).read_bytes() != (ROOT / path).read_bytes():
            sys.exit(f"{tree / path} is not as it is here: copy the tree again")
        text = rendered(texts[path], [pair for pair in numbered if pair[1].file == path])
        (tree / path).write_bytes((GUARD + text).encode("latin-1"))
    guard = "tests/mutation/drawn_mutant.hpp"
    (tree / guard).write_bytes((ROOT / guard).read_bytes())


def listed(numbered):
    return "\n".join(f"{number} {one.file}:{one.line} {one.function}: {one.kind}: {one.what}" for number, one in numbered)


def self_test(flags, memory):
    """A seed draws the same twice, another one others; each mutant is in the text."""
    files = ["daemon/safety/speed_watch.cpp", "daemon/safety/lease.cpp"]
    first, texts = draw(files, flags, memory, 1, 12)
    assert len(first) == 12, "too few were drawn"
    assert listed(first) == listed(draw(files, flags, memory, 1, 12)[0]), "the same seed drew others"
    assert listed(first) != listed(draw(files, flags, memory, 2, 12)[0]), "another seed drew the same"
    text = "".join(rendered(texts[path], [pair for pair in first if pair[1].file == path]) for path in files)
    assert all(f"odomcalib_mutant({number})" in text for number, _ in first), "a mutant is not in the text"
    print(listed(first))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flags", type=pathlib.Path, required=True, metavar="BUILD")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--each", type=int, default=30)
    parser.add_argument("--into", type=pathlib.Path)
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--self-test", action="store_true")
    asked = parser.parse_args()
    flags = flags_of(asked.flags)
    if asked.self_test:
        self_test(flags, asked.flags)
        return
    if asked.into and asked.into.resolve() == ROOT:
        sys.exit("mutants go into a copy of the tree: cp -a, or git worktree add")
    numbered, texts = draw(sources_of_folders(), flags, asked.flags, asked.seed, asked.each)
    print(f"seed {asked.seed}: {len(numbered)} mutants")
    print(listed(numbered))
    if asked.into:
        put_into(asked.into, numbered, texts)
        records = [{"number": number, **dataclasses.asdict(one)} for number, one in numbered]
        (asked.into / "drawn.json").write_text(json.dumps({"seed": asked.seed, "mutants": records}, indent=1))


if __name__ == "__main__":
    main()
