#!/usr/bin/env python3
"""Checks the words of the sources: comments name their subject, and identifiers have no word that the glossary refuses.

Usage: check_words.py PROJECT_ROOT     lists what reads badly, exit status 1 if anything does
       check_words.py --self-test      shows that each rule accepts what is right and rejects what is wrong
"""

import pathlib
import re
import sys

GLOSSARY = "docs/glossary.md"
TABLE = "## Old words"
FOLDERS = ("calib", "daemon", "drivers", "examples", "proto", "tests")
ENDINGS = {".cpp", ".hpp", ".h", ".c", ".py"}
COMMENT = re.compile(r"^\s*(?://[/!]?<?|#)\s*(.*)$|///<\s*(.*)$")
NO_SUBJECT = re.compile(r"(?:Of|What|That|Whose|Which)\b")
IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")
PART = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
LITERAL = re.compile(r'"(?:[^"\\\n]|\\.)*"|//.*')


def refused_words(glossary):
    """Old words whose row says that identifiers must not have them."""
    words = set()
    for line in glossary.partition(TABLE)[2].splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 3 and cells[2] == "yes":
            words |= {word.strip() for word in cells[0].split(",")}
    return words


def without_subject(lines):
    """Numbers of lines whose comment begins with a clause instead of its subject; a question has its mark in the same comment."""
    found = []
    for number, line in enumerate(lines, 1):
        comment = COMMENT.search(line)
        text = comment and (comment.group(1) or comment.group(2) or "")
        if not text or not NO_SUBJECT.match(text):
            continue
        rest = number
        while "?" not in text and rest < len(lines) and (follows := COMMENT.match(lines[rest])):
            text += " " + (follows.group(1) or "")
            rest += 1
        sentence = re.match(r"[^.;]*", text).group(0)
        if "?" not in sentence:
            found.append(number)
    return found


def old_words(text, refused):
    """(line, identifier) for each identifier that has a refused word in it."""
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        for name in IDENTIFIER.findall(LITERAL.sub("", line)):
            if {part.lower() for part in PART.findall(name)} & refused:
                found.append((number, name))
    return found


def problems(name, text, refused):
    found = [f"{name}:{number}: the comment names no subject" for number in without_subject(text.splitlines())]
    if name.endswith((".cpp", ".hpp")):
        found += [f"{name}:{number}: {word} has an old word, see {GLOSSARY}" for number, word in old_words(text, refused)]
    return found


def check(root):
    refused = refused_words((root / GLOSSARY).read_text(encoding="utf-8"))
    found = []
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in ENDINGS and path.name != pathlib.Path(__file__).name:  # whose test has examples
                found += problems(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8", errors="replace"), refused)
    print("\n".join(found) if found else f"comments name their subjects; {len(refused)} old words are in no identifier")
    return 1 if found or not refused else 0


def self_test():
    table = f"{TABLE}\n\n| old word | term | refused |\n| --- | --- | --- |\n| footing, papers | evidence | yes |\n| way | distance | |\n"
    assert refused_words(table) == {"footing", "papers"}
    for wrong in ("// Of one robot.", "  /// What a chunk holds.", "int a;  ///< Which one", "# That candidates are tested on.",
                  "// What is it for. Is it?"):
        assert without_subject([wrong]) == [1], wrong
    for right in ("// The robot of one drive.", "/// What is wrong?", "int what = 1;  // of one", "# Offset of the clock.",
                  "// Whatever was read."):
        assert without_subject([right]) == [], right
    assert without_subject(["// Which of the two,", "// the left or the right?"]) == []
    assert [name for _, name in old_words('Footing f(paper_s, by_papers); // papers\nlog("footing");', {"footing", "papers"})] == \
        ["Footing", "by_papers"]
    print("self-test passed")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(self_test() if sys.argv[1] == "--self-test" else check(pathlib.Path(sys.argv[1])))
