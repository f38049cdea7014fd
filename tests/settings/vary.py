#!/usr/bin/env python3
"""Varies the numbers that calib decides by, and shows which of them change what comes out.

Usage: tests/settings/vary.py prepare --into TREE                       numbers of TREE, a copy of this tree, obey the environment
       tests/settings/vary.py run BIN --rows FILE [--untried] [--recordings NAME...]  reads recordings with each number halved and doubled
       tests/settings/vary.py state                                     writes what the rows say into the settings files
       tests/settings/vary.py table                                     all numbers as a page: docs/developer/numbers.md
       tests/settings/vary.py --check                                   every number has an origin, and says what the rows say, as the page does
       tests/settings/vary.py --self-test

A number is a constant of a file calib/*/settings.hpp; those are varied whose comment gives no reason. In TREE each place that uses one may
go on with its half or its double (varied.hpp), so that one build serves all of them; what the compiler has to know (sizes of arrays,
constants made of constants) stays. BIN holds odomcalibctl and odomcalib-sim-record of TREE. trials.py has the recordings, and the commands
that read them. A number that the program does not read there is not varied there; those of a table are read when the program starts. With
--untried, only numbers are varied that no other recording has been read with, one recording after the other. FILE gets a line of JSON a
number, factor and recording, and is continued where it ends.

    cp -a . ../varied && tests/settings/vary.py prepare --into ../varied
    cmake -S ../varied -B ../varied/build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS="-std=c++20 -include $PWD/../varied/tests/settings/varied.hpp"
    cmake --build ../varied/build --target odomcalibctl odomcalib-sim-record
    tests/settings/vary.py run ../varied/build/bin --rows rows.jsonl
"""

import argparse
import collections
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

import trials

ROOT = pathlib.Path(__file__).resolve().parents[2]
FACTORS = (0.5, 2.0)
ROWS = ROOT / "tests/settings/rows.jsonl"
PAGE_FILE = ROOT / "docs/developer/numbers.md"
PAGE = """# The numbers of calib

Made by `tests/settings/vary.py table` from the settings files of `calib`, one of each layer, and from `tests/settings/rows.jsonl`. Of {count} numbers
{reasoned} have a reason: derived, published, measured, or chosen for what is said. The others were halved and doubled one at a time, and
{trials} recordings were read again, most by `solve`, some by `predict`, `compare`, `match` and `graph` (`tests/settings/trials.py`): {insensitive} changed
no byte of any result (*insensitive*), {sensitive} changed some (*sensitive*), {untried} are read in none of these recordings, or are known to
the compiler alone (*untried*).

The columns on the right say in how many of the recordings that were read with the number halved or doubled the result changed:
one that does not read it is left out, and most recordings have been read only with numbers that had been in no other. A byte that changes is no harm:
the last digit of a length is enough."""
CONSTANT = re.compile(r"^inline constexpr ([\w:]+) ([^;]*);", re.M)
NAME = re.compile(r"\b(k[A-Z]\w*) =")


def layer_of(file, root):
    parts = file.relative_to(root / "calib").parts
    return parts[0] if len(parts) > 1 else "calib"


def settings_of(root):
    """(layer, name) of every constant, in the order of files and lines."""
    found = []
    for file in sorted((root / "calib").glob("**/settings.hpp")):
        for constant in CONSTANT.finditer(file.read_text(encoding="utf-8")):
            found += [(layer_of(file, root), name) for name in NAME.findall(constant.group(2))]
    return found


# A count that the compiler has to know: what it is made of stays as it is in its file.
COUNT = re.compile(r"\bconstexpr (?:int|std::size_t) \w+ = ([^;]*);")
# A number or a table that the compiler works out; in its place the program does, when it starts.
WORKED_OUT = re.compile(r"\bconstexpr ((?:double|std::array(?:<[^=\n]*>)?) \w+ = .*?;)(?=[ \t]*(?://[^\n]*)?$)", re.M | re.S)


def with_varied(text, own_layer, numbers, shared=()):
    """A source whose uses of settings ask the environment; `shared` are the (layer, name) that a header of the layer makes its own."""
    stays = {name for count in COUNT.findall(text) for name in re.findall(r"settings::(k\w+)", count)}

    def replaced(match):
        qualifier, name = match.group(1) or "", match.group(2)
        if name in stays:
            return match.group(0)
        layers = [part for part in qualifier.split("::") if part]
        candidates = [layers[-1]] if layers else [own_layer, "calib"]
        number = next((numbers[layer, name] for layer in candidates if (layer, name) in numbers), None)
        return match.group(0) if number is None else f"odomcalib_varied_value<{number}>({match.group(0)})"

    lines = []
    # Names that a using declaration makes known without their namespace.
    known = {name: qualifier for qualifier, name in re.findall(r"^\s*using ((?:\w+::)*)settings::(k\w+);", text, re.M)}
    for line in text.split("\n"):
        code, comment_mark, comment = line.partition("//")
        if not re.match(r"\s*(#|using )", code):
            code = re.sub(r"(?<![\w:])((?:\w+::)*)settings::(k\w+)", replaced, code)
            for name, qualifier in known.items():
                layer = [part for part in qualifier.split("::") if part]
                number = numbers.get((layer[-1] if layer else own_layer, name))
                if number is not None:
                    code = re.sub(rf"(?<![\w:]){name}\b", f"odomcalib_varied_value<{number}>({name})", code)
            for layer, name in shared:
                use = f"{name}" if layer == own_layer else f"{layer}::{name}"
                if name not in known:
                    code = re.sub(rf"(?<![\w:]){use}\b", f"odomcalib_varied_value<{numbers[layer, name]}>({use})", code)
        lines.append(code + comment_mark + comment)
    return WORKED_OUT.sub(lambda match: match.group(0) if "odomcalib_varied" not in match.group(0) else "const " +
                          match.group(1).replace("odomcalib_varied_value", "odomcalib_varied_now"), "\n".join(lines))


def shared_of(tree, numbers):
    """(layer, name) of the settings that headers make known in the namespace of their layer."""
    return [(layer_of(file, tree), name) for file in sorted((tree / "calib").glob("**/*.hpp"))
            for name in re.findall(r"^using settings::(k\w+);", file.read_text(encoding="utf-8"), re.M)
            if (layer_of(file, tree), name) in numbers]


def without_threads(text):
    """The source of what shows how long a step takes, without its thread: a process that goes on as two has one thread alone."""
    for of_thread in (", thread_([this] { run(); })", "thread_.join();"):
        if of_thread not in text:
            sys.exit(f"{of_thread} is not in daemon/cli/output.cpp: a command that has a thread will not end")
        text = text.replace(of_thread, "")
    return text


def prepare(tree):
    shown = tree / "daemon/cli/output.cpp"
    shown.write_text(without_threads(shown.read_text(encoding="utf-8")), encoding="utf-8")
    numbers = {setting: number for number, setting in enumerate(settings_of(tree))}
    shared = shared_of(tree, numbers)
    for file in sorted((tree / "calib").glob("**/*.[ch]pp")):
        if file.name != "settings.hpp":
            text = file.read_text(encoding="utf-8")
            changed = with_varied(text, layer_of(file, tree), numbers, shared)
            if changed != text:
                file.write_text(changed, encoding="utf-8")
    (tree / "varied.json").write_text(json.dumps([f"{layer}.{name}" for layer, name in numbers]), encoding="utf-8")
    print(f"{len(numbers)} numbers")


def words_of(name, bins, folder):
    """The command of a trial with the names of its files; None where one of them is a real recording that is not there."""
    words = []
    for word in re.split(r" (?![^{]*})", trials.TRIALS[name].command):
        kind, _, other = word.strip("{}").partition(" of ")
        if word.startswith("{"):
            word = trials.file_of(other or name, bins, folder)
            if word is None:
                return None
        if kind == "calibration":
            calibration = folder / f"{other or name}.calibration.json"
            subprocess.run([bins / "odomcalibctl", "solve", word, "--out", calibration], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
            word = calibration
        words.append(word)
    return words


def answer(program, words, folder, environment=None):
    """What wait() said of the program, and the digest of what it wrote."""
    folder.mkdir(exist_ok=True)
    # With its tunables stated the program does not start itself again, which would forget its number.
    stated = {**os.environ, "GLIBC_TUNABLES": "glibc.malloc.hugetlb=1", **(environment or {})}
    with (folder / "stdout").open("wb") as out:
        done = subprocess.run([program, *words], cwd=folder, stdout=out, stderr=subprocess.DEVNULL, check=False, env=stated)
    return done.returncode << 8, digest_of(folder)


def digest_of(folder):
    """Of the files that a program wrote; where it writes none, of its standard output without the times that it took."""
    written = [file.read_bytes() for file in sorted(folder.iterdir()) if file.name != "stdout"]
    return hashlib.sha256(b"".join(written) or re.sub(rb'"time_us":-?\d+', b"", (folder / "stdout").read_bytes())).hexdigest()


def run_recording(bins, name, folder, names, asked, solved, write):
    """Reads a recording with every number that is asked about and that it reads; `solved` are the (setting, factor) of before."""
    words = words_of(name, bins, folder)
    if words is None:
        print(f"{name}: left out, {trials.DATA / trials.TRIALS[name].made} is not there", file=sys.stderr)
        return
    work = folder / name
    work.mkdir(exist_ok=True)
    plain = answer(bins / "odomcalibctl", words, work / "plain")

    def harvest():
        lines = (work / "status").read_text(encoding="utf-8").splitlines() if (work / "status").exists() else []
        for number, factor, status in map(str.split, lines):
            own = work / f"{number}_{factor}"
            write(setting=names[int(number)], factor=float(factor), recording=name, changed=(int(status), digest_of(own)) != plain)
            solved.add((names[int(number)], float(factor)))
            shutil.rmtree(own)
        (work / "status").unlink(missing_ok=True)

    harvest()  # of a run that was stopped
    whole = [str(number) for number, setting in enumerate(names)
             if setting not in asked or all((setting, factor) in solved for factor in FACTORS)]
    (work / "done").write_text("\n".join(whole), encoding="utf-8")
    if answer(bins / "odomcalibctl", words, work / "plain", {"ODOMCALIB_VARIED": str(work)}) != plain:
        sys.exit(f"{name}: the same numbers gave another result: its rows say nothing")
    harvest()
    read = set(map(int, (work / "read").read_text(encoding="utf-8").split()))
    tried = {setting for setting, _ in solved} & asked
    print(f"{name}: {len(read)} numbers read, {len(tried)} varied", file=sys.stderr)


def tried_elsewhere(name, solved):
    """Settings that other recordings than this one were read with."""
    return {setting for recording, pairs in list(solved.items()) if recording != name for setting, _ in list(pairs)}


def run(bins, rows, jobs, recordings, untried):
    names = json.loads((bins.parents[1] / "varied.json").read_text(encoding="utf-8"))
    asked = {f"{layer}.{name}" for layer, name, _, comment in described() if not has_reason(comment)}
    folder = rows.resolve().with_suffix(".recordings")
    folder.mkdir(exist_ok=True)
    solved = collections.defaultdict(set)
    if rows.exists():
        for line in map(json.loads, rows.read_text(encoding="utf-8").splitlines()):
            solved[line["recording"]].add((line["setting"], line["factor"]))
    with concurrent.futures.ThreadPoolExecutor(1 if untried else jobs) as pool, rows.open("a", encoding="utf-8") as out:
        def write(**row):
            out.write(json.dumps(row) + "\n")
            out.flush()

        def run_one(name):
            left = asked - tried_elsewhere(name, solved) if untried else asked
            run_recording(bins, name, folder, names, left, solved[name], write)

        list(pool.map(run_one, recordings))
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{(used.ru_utime + used.ru_stime) / 60.0:.1f} minutes of a processor", file=sys.stderr)


# Comment lines above constants, and the constants that follow one another without a line between.
GROUP = re.compile(r"((?:^///.*\n)*)((?:^inline constexpr [^;]*;[^\n]*\n)+)", re.M)


def described(root=ROOT):
    """Layer, name, value and comment of every number, as its settings file has them."""
    rows = []
    for file in sorted((root / "calib").glob("**/settings.hpp")):
        for group in GROUP.finditer(file.read_text(encoding="utf-8")):
            comment = " ".join(line[3:].strip() for line in group.group(1).splitlines())
            for constant in CONSTANT.finditer(group.group(2)):
                for part in re.split(r",\s*(?=k[A-Z]\w* =)", constant.group(2)):
                    name, value = (side.strip() for side in part.split("=", 1))
                    rows.append((layer_of(file, root), name, " ".join(value.split()), comment))
    return rows


# Numbers of every kind, for --self-test.
SELF_TEST_SETTINGS = """
/// m. Chosen.
inline constexpr double kA = 1.0, kAlso = 2.0;
/// s. Chosen, untried.
inline constexpr int kB = 1;

/// Counts. Chosen,
/// sensitive.
inline constexpr int kC = 1;
/// Chosen: why.
inline constexpr int kWhy = 1;
/// Nothing is known.
inline constexpr int kNone = 1;
"""
REASON = re.compile(r"\b(Derived|Published|Measured)\b|\bChosen(?:[:;]| as\b| for\b)")
BY_TRIAL = re.compile(r"\bChosen(?:,\s+(?:///\s+)?(sensitive|insensitive|untried))?\.(?=\s|$)")


def has_reason(comment):
    """Whether a number's comment says more about where it comes from than that somebody chose it."""
    return REASON.search(comment) is not None


def lines_by_setting(file):
    by_setting = collections.defaultdict(dict)
    for line in map(json.loads, file.read_text(encoding="utf-8").splitlines()):
        by_setting[line["setting"]][line["recording"], line["factor"]] = line
    return by_setting


def said_of(settings, by_setting):
    """What the recordings that were read with other values say of some settings together."""
    lines = [line for setting in settings for line in by_setting[setting].values()]
    if not lines:
        return "untried"
    return "sensitive" if any(line["changed"] for line in lines) else "insensitive"


def state(rows, root=ROOT):
    """Writes into the settings files what the rows say of each number whose origin is no other."""
    by_setting = lines_by_setting(rows)
    for file in sorted((root / "calib").glob("**/settings.hpp")):
        def stated(group):
            names = [name for constant in CONSTANT.finditer(group.group(2)) for name in NAME.findall(constant.group(2))]
            said = said_of([f"{layer_of(file, root)}.{name}" for name in names], by_setting)
            return BY_TRIAL.sub(f"Chosen, {said}.", group.group(1)) + group.group(2)

        text = file.read_text(encoding="utf-8")
        if GROUP.sub(stated, text) != text:
            file.write_text(GROUP.sub(stated, text), encoding="utf-8")


def problems(rows, root=ROOT):
    """Numbers without an origin, and those whose comment does not say what the rows say."""
    by_setting, found, groups = lines_by_setting(rows), [], collections.defaultdict(list)
    for layer, name, _, comment in described(root):
        groups[layer, comment].append(f"{layer}.{name}")
        if not has_reason(comment) and not BY_TRIAL.search(comment):
            found.append(f"{layer}.{name}: no origin; write Derived, Published or Measured and from what, or Chosen: and why")
    for (_, comment), settings in groups.items():
        trial = None if has_reason(comment) else BY_TRIAL.search(comment)
        if trial and trial.group(1) != said_of(settings, by_setting):
            found.append(f"{settings[0]}: the rows say \"Chosen, {said_of(settings, by_setting)}.\"; run vary.py state")
    return found


def effect_of(lines, factor):
    """Of the recordings that were read with a number times the factor: how many results changed, in words."""
    of_factor = [line for line in lines if line["factor"] == factor]
    return f"{sum(line['changed'] for line in of_factor)} of {len(of_factor)}" if of_factor else "–"


def table(rows):
    """The page of all numbers, Markdown."""
    by_setting = lines_by_setting(rows)
    read = {line["recording"] for lines in by_setting.values() for line in lines.values()}
    words = collections.Counter(said_of([f"{layer}.{name}"], by_setting)
                                for layer, name, _, comment in described() if not has_reason(comment))
    page = [PAGE.format(count=len(described()), trials=len(read),
                      **{word: words[word] for word in ("insensitive", "sensitive", "untried")},
                      reasoned=sum(has_reason(comment) for *_, comment in described()))]
    layer = None
    for of, name, value, comment in described():
        if of != layer:
            layer = of
            page.append(f"\n## {layer}\n\n| number | value | what it is, and where it comes from | halved | doubled |\n| --- | --- | --- | --- | --- |")
        lines = by_setting[f"{of}.{name}"].values()
        cells = [effect_of(lines, factor) for factor in FACTORS]
        page.append(f"| `{name}` | {value} | {comment.replace('|', chr(92) + '|')} | {cells[0]} | {cells[1]} |")
    return "\n".join(page) + "\n"


def self_test():
    numbers = {("fit", "kA"): 0, ("look", "kB"): 1, ("calib", "kC"): 2}
    for text, expected in [
            ("x = settings::kA;", "x = odomcalib_varied_value<0>(settings::kA);"),
            ("x = look::settings::kB * settings::kC;  // settings::kA",
             "x = odomcalib_varied_value<1>(look::settings::kB) * odomcalib_varied_value<2>(settings::kC);  // settings::kA"),
            ("using look::settings::kB;\nif (kB > kBar) x();", "using look::settings::kB;\nif (odomcalib_varied_value<1>(kB) > kBar) x();"),
            ("#include <settings::kA>", "#include <settings::kA>"), ("x = other::settings::kA;", "x = other::settings::kA;"),
            ("x = look::kB * kA;", "x = odomcalib_varied_value<1>(look::kB) * odomcalib_varied_value<0>(kA);"),
            ("constexpr double kX = settings::kA;  // twice\nf(settings::kC);",
             "const double kX = odomcalib_varied_now<0>(settings::kA);  // twice\nf(odomcalib_varied_value<2>(settings::kC));"),
            ("constexpr int kX = 2 * settings::kA;\nf(settings::kA);", "constexpr int kX = 2 * settings::kA;\nf(settings::kA);"),
            ("constexpr std::array kX = {\n    X{settings::kA, [] { return 1; }},\n};",
             "const std::array kX = {\n    X{odomcalib_varied_now<0>(settings::kA), [] { return 1; }},\n};")]:
        found = with_varied(text, "fit", numbers, [("look", "kB"), ("fit", "kA")] if "look::kB" in text else [])
        if found != expected:
            sys.exit(f"FAILED: {text}: {found}")
    if len(settings_of(ROOT)) < 500 or len({*settings_of(ROOT)}) != len(settings_of(ROOT)) or len(described()) < len(settings_of(ROOT)):
        sys.exit("FAILED: not every number of calib is found, or one twice")
    if tried_elsewhere("a", {"a": {("kA", 0.5)}, "b": {("kB", 0.5)}}) != {"kB"}:
        sys.exit("FAILED: what other recordings have tried is not found")
    for name, trial in trials.TRIALS.items():
        for what, of in re.findall(r"{(\w+)(?: of (\w+))?}", trial.command):
            if what not in ("file", "calibration") or (of and of not in trials.TRIALS):
                sys.exit(f"FAILED: {name} needs {what} of {of}, which is no recording")
    with tempfile.TemporaryDirectory() as folder:
        for number, time in enumerate((17, -3)):
            (pathlib.Path(folder) / str(number)).mkdir()
            (pathlib.Path(folder) / str(number) / "stdout").write_text(f'{{"time_us":{time},"x":1}}', encoding="utf-8")
        if len({digest_of(own) for own in pathlib.Path(folder).iterdir()}) != 1:
            sys.exit("FAILED: the time that a program took counts as a result")
    with tempfile.TemporaryDirectory() as folder:
        root, rows = pathlib.Path(folder), pathlib.Path(folder) / "rows.jsonl"
        (root / "calib/fit").mkdir(parents=True)
        file = root / "calib/fit/settings.hpp"
        file.write_text(SELF_TEST_SETTINGS, encoding="utf-8")
        rows.write_text("".join(json.dumps({"setting": f"fit.{name}", "factor": factor, "recording": "a", "changed": changed}) + "\n"
                                for name, factor, changed in [("kA", 0.5, False), ("kA", 2.0, True), ("kB", 0.5, False)]),
                        encoding="utf-8")
        if [problem.split(":")[0] for problem in problems(rows, root)] != ["fit.kNone", "fit.kA", "fit.kB", "fit.kC"]:
            sys.exit(f"FAILED: found {problems(rows, root)}")
        state(rows, root)
        said = {name: comment for _, name, _, comment in described(root)}
        for name, word in [("kA", "sensitive"), ("kAlso", "sensitive"), ("kB", "insensitive"), ("kC", "untried")]:
            if f"Chosen, {word}." not in said[name]:
                sys.exit(f"FAILED: {name} is said to be {said[name]}")
        if [problem.split(":")[0] for problem in problems(rows, root)] != ["fit.kNone"] or "Chosen: why." not in said["kWhy"]:
            sys.exit(f"FAILED: left {problems(rows, root)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="?", choices=["prepare", "run", "state", "table"])
    parser.add_argument("bin", nargs="?", type=pathlib.Path)
    parser.add_argument("--into", type=pathlib.Path)
    parser.add_argument("--rows", type=pathlib.Path, default=ROWS)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--recordings", nargs="+", choices=trials.TRIALS, default=list(trials.TRIALS))
    parser.add_argument("--untried", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--self-test", action="store_true")
    arguments = parser.parse_args()
    if arguments.self_test:
        self_test()
    elif arguments.check:
        found = problems(arguments.rows)
        if table(arguments.rows) != PAGE_FILE.read_text(encoding="utf-8"):
            found.append(f"{PAGE_FILE.relative_to(ROOT)} says something else; make it again: vary.py table")
        print("\n".join(found), f"{len(found)} numbers without a true origin", sep="\n" if found else "")
        return 1 if found else 0
    elif arguments.what == "prepare" and arguments.into:
        prepare(arguments.into.resolve())
    elif arguments.what == "run" and arguments.bin:
        run(arguments.bin.resolve(), arguments.rows, arguments.jobs, arguments.recordings, arguments.untried)
    elif arguments.what == "state":
        state(arguments.rows)
    elif arguments.what == "table":
        sys.stdout.write(table(arguments.rows))
    else:
        parser.error("prepare --into TREE, run BIN, state, table, or --check")
    return 0


if __name__ == "__main__":
    sys.exit(main())
