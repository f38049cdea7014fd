#!/usr/bin/env python3
"""Checks docs/evidence/source-rows.md: every row has a test whose name holds its id, or a stated reason.

Usage: check_rows.py PROJECT_ROOT          the table against the tests of the project
       check_rows.py --list PROJECT_ROOT   also: every row of SOURCES.md in $ODOMCALIB_SHARED (default ../shared beside the project) is in
                                           the table; exit status 77 when that file is not there
       check_rows.py --self-test           shows that each rule accepts what is right and rejects what is wrong
"""

import os
import pathlib
import re
import sys

TABLE = "docs/evidence/source-rows.md"
SKIPPED = 77
ROW = re.compile(r"^\|\s*(S[0-3XD]-\d\d)\s*\|(.*)\|\s*$", re.MULTILINE)
# Defects of published programs have no id in the list: they are counted in its section 1.6.
DEFECTS = re.compile(r"^### 1\.6.*?\n\|[^\n]*\n\|[-| ]*\n((?:\|[^\n]*\n?)*)", re.MULTILINE | re.DOTALL)
GTEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)", re.MULTILINE)
CTEST = re.compile(r"add_test\(\s*NAME\s+([\w.]+)")
ID_IN_NAME = re.compile(r"(?<![A-Za-z0-9])(S[0-3XD])_(\d\d)(?!\d)")
NO_TEST = ("Reason: ", "Open: ")


def ids_in(name):
    """Rows that the name of a test stands for."""
    return {f"{source}-{number}" for source, number in ID_IN_NAME.findall(name.replace("_S", " S"))}


def tests_of(texts):
    """Names of all tests, Suite.name, in C++ and CMake sources."""
    names = set()
    for text in texts:
        names |= {f"{suite}.{name}" for suite, name in GTEST.findall(text)} | set(CTEST.findall(text))
    return names


def rows_of_list(text):
    """Ids of the rows that the list of the source documents asks for."""
    ids = [found.group(1) for found in ROW.finditer(text)]
    defects = DEFECTS.search(text)
    count = len(defects.group(1).strip().splitlines()) if defects else 0
    return ids + [f"SD-{number:02}" for number in range(1, count + 1)]


def problems_of_row(row, cells, tests):
    if len(cells) != 2 or not cells[1].strip():
        return [f"{row}: expected | row | tests | what holds |"]
    named = re.findall(r"`([^`]+)`", cells[0])
    if not named:
        reason = cells[1].strip()
        if not any(reason.startswith(word) and len(reason) > len(word) for word in NO_TEST):
            return [f"{row}: neither a test nor a reason ({' or '.join(word.strip() for word in NO_TEST)})"]
        return []
    found = [f"{row}: there is no test {name}" for name in named if name not in tests]
    if not any(row in ids_in(name) for name in named):
        found.append(f"{row}: no test of this row has {row.replace('-', '_')} in its name")
    return found


def problems(table, tests, wanted=()):
    """One line for each thing wrong with the table."""
    rows = [(found.group(1), found.group(2).split("|")) for found in ROW.finditer(table)]
    ids = [row for row, _ in rows]
    found = [f"{row}: twice in the table" for row in sorted(set(ids)) if ids.count(row) > 1]
    listed = set()
    for row, cells in rows:
        found += problems_of_row(row, cells, tests)
        listed |= set(re.findall(r"`([^`]+)`", cells[0]))
    found += [f"{row}: not in the table" for row in wanted if row not in ids]
    found += [f"{test}: holds the id of a row and is not in the table" for test in sorted(tests - listed) if ids_in(test)]
    return found


def sources(root):
    """Texts of the files below tests/ that may define tests."""
    for path in sorted((root / "tests").rglob("*")):
        if path.suffix == ".cpp" or path.name == "CMakeLists.txt":
            yield path.read_text(encoding="utf-8")


def self_test():
    tests = tests_of(["TEST(Linear, S0_05_two_samples)\nTEST_P(Other,\n  S0_06_S0_16_agree)\n", "add_test(NAME Package.S0_13_no_ros COMMAND x)",
                      "TEST(Plain, test)"])
    assert tests == {"Linear.S0_05_two_samples", "Other.S0_06_S0_16_agree", "Package.S0_13_no_ros", "Plain.test"}
    assert ids_in("Other.S0_06_S0_16_agree") == {"S0-06", "S0-16"} and ids_in("Slip.of_S1_050") == set()
    good = ("| S0-05 | `Linear.S0_05_two_samples`, `Plain.test` | x |\n| S0-06 | `Other.S0_06_S0_16_agree` | x |\n"
            "| S0-16 | `Other.S0_06_S0_16_agree` | x |\n| S0-13 | `Package.S0_13_no_ros` | x |\n| S0-22 | – | Reason: y |\n")
    assert problems(good, tests) == []
    wanted = rows_of_list("| S0-05 | L1 | x |\n### 1.6 Defects\n\n| repo | defect | test |\n| --- | --- | --- |\n| a | b | c |\n| d | e | f |\n")
    assert wanted == ["S0-05", "SD-01", "SD-02"]
    assert problems(good, tests, wanted) == ["SD-01: not in the table", "SD-02: not in the table"]
    bad = {"| S0-05 | `Linear.S0_05_gone` | x |": "there is no test",
           "| S0-05 | `Plain.test` | x |": "in its name",
           "| S0-05 | – | we trust it |": "neither a test nor a reason",
           "| S0-05 | – | Reason: |": "neither a test nor a reason",
           "| S0-05 | `Linear.S0_05_two_samples` |": "expected",
           "| S0-22 | – | Reason: z |": "twice"}
    for row, what in bad.items():
        table = good + row + "\n" if what == "twice" else re.sub(r"^\| S0-05.*$", row, good, flags=re.MULTILINE)
        assert any(what in problem for problem in problems(table, tests)), row
    assert problems(good.replace("| S0-13 ", "| none "), tests) == ["Package.S0_13_no_ros: holds the id of a row and is not in the table"]
    print(f"{len(bad) + 3} tables judged rightly")


def main():
    if "--self-test" in sys.argv:
        self_test()
        return 0
    root = pathlib.Path(sys.argv[-1]).resolve()
    wanted = []
    if "--list" in sys.argv:
        rows = pathlib.Path(os.environ.get("ODOMCALIB_SHARED", root.parent / "shared")) / "SOURCES.md"
        if not rows.is_file():
            print(f"SKIPPED: no list of the source documents at {rows}; ODOMCALIB_SHARED is the folder that holds it")
            return SKIPPED
        wanted = rows_of_list(rows.read_text(encoding="utf-8"))
        if len(wanted) < 100:
            print(f"{rows}: only {len(wanted)} rows found, the list has another form")
            return 1
    found = problems((root / TABLE).read_text(encoding="utf-8"), tests_of(sources(root)), wanted)
    print("\n".join(found + [f"{len(found)} rows are not as they should be"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
