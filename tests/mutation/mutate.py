#!/usr/bin/env python3
"""Takes each rule of safety out of the code, once, and sees that the tests named for it fail.

Usage: mutate.py --check                     every mutant of mutants.toml fits its file and is in the table of
                                             docs/evidence/safety-rules.md (nothing is built)
       mutate.py --build DIR [--only TEXT] [--program NAME] [--changed REF] [--jobs N]
                                             builds and runs them; TEXT in rule, what or file; --changed: only those
                                             whose file differs from the git revision REF
       mutate.py --table                     that table

Works in the source tree that DIR was configured for: each file gets its own bytes back, also after Ctrl-C or SIGTERM.
Exit status 1 when a mutant survives, does not build, or when its tests fail without it.
"""

import argparse
import collections
import pathlib
import signal
import subprocess
import sys
import time
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
DOCUMENT = ROOT / "docs/evidence/safety-rules.md"
LONGEST = 300  # s for the tests of one mutant; one that hangs is found out as well


def mutants():
    return tomllib.loads((HERE / "mutants.toml").read_text(encoding="utf-8"))["mutant"]


def misfits(all_mutants):
    """One line for each mutant that is not to be applied in exactly one place, or for a table that is not theirs."""
    found = []
    for one in all_mutants:
        text = (ROOT / one["file"]).read_text(encoding="utf-8")
        count = text.count(one["find"])
        if count != 1:
            found.append(f'{one["rule"]} {one["what"]}: "{one["find"].strip()}" is {count} times in {one["file"]}')
        if one["find"] == one["put"]:
            found.append(f'{one["rule"]} {one["what"]}: changes nothing')
    if table(mutants()) not in DOCUMENT.read_text(encoding="utf-8"):
        found.append(f"the table in {DOCUMENT.relative_to(ROOT)} is not the one of --table")
    return found


def changed_since(revision):
    names = subprocess.run(["git", "-C", ROOT, "diff", "--name-only", revision],
                           check=True, capture_output=True, text=True)
    return set(names.stdout.split())


def build(folder, target, jobs):
    done = subprocess.run(["cmake", "--build", folder, f"-j{jobs}", "--target", target],
                          capture_output=True, text=True, check=False)
    return done.returncode == 0, done.stdout[-2000:]


def tests_pass(folder, one):
    """Whether the named tests pass; None where there are none of that name."""
    program = [str(folder / "bin" / one["with"]), "--gtest_brief=1", "--gtest_filter=" + one["kill"]]
    try:
        done = subprocess.run(program, capture_output=True, text=True, timeout=LONGEST, cwd=ROOT, check=False)
    except subprocess.TimeoutExpired:
        return False
    return None if "[==========] 0 tests" in done.stdout else done.returncode == 0


def verdict_of(folder, one, jobs):
    """"killed", or what is wrong; the file is as it was when this returns."""
    path = ROOT / one["file"]
    original = path.read_bytes()
    try:
        path.write_bytes(original.replace(one["find"].encode(), one["put"].encode()))
        built, said = build(folder, one["with"], jobs)
        if not built:
            return "does not build:\n" + said
        passed = tests_pass(folder, one)
    finally:
        path.write_bytes(original)
    return "killed" if passed is False else "no such test" if passed is None else "SURVIVED"


def run(folder, chosen, jobs):
    """Number of mutants that are not killed, or whose tests fail without any mutant."""
    bad = 0
    # One program after the other: what a mutant leaves built is built again with the next one.
    for program in dict.fromkeys(one["with"] for one in chosen):
        own = [one for one in chosen if one["with"] == program]
        for one in sorted(own, key=lambda each: each["file"]):
            begin = time.monotonic()
            verdict = verdict_of(folder, one, jobs)
            bad += verdict != "killed"
            print(f'{verdict:8} {one["rule"]:5} {one["what"]} ({program}, {time.monotonic() - begin:.0f} s)', flush=True)
        built, said = build(folder, program, jobs)
        for one in own:
            if not built or tests_pass(folder, one) is not True:
                bad += 1
                print(f'FAILS WITHOUT A MUTANT: {program} {one["kill"]} {said if not built else ""}', flush=True)
    print(f"{len(chosen)} mutants, {bad} not as they should be")
    return bad


def table(all_mutants):
    lines = ["| rule | what it says | code | tests that fail without it |", "| --- | --- | --- | --- |"]
    for one in all_mutants:
        tests = one["kill"].replace("*", "\\*").replace(":", ", ")
        lines.append(f'| {one["rule"]} | {one["what"]} | {one["file"]} | {tests} ({one["with"]}) |')
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--build", type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--program", default="", help="those whose tests are in programs with this in their name")
    parser.add_argument("--changed")
    parser.add_argument("--jobs", type=int, default=2)
    asked = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # a file that is changed gets its bytes back
    chosen = [one for one in mutants()
              if asked.only in f'{one["rule"]} {one["what"]} {one["file"]}' and asked.program in one["with"]]
    if asked.table:
        print(table(chosen))
        return 0
    wrong = misfits(chosen)
    print("\n".join(wrong) if wrong else f"{len(chosen)} mutants fit "
          f"({len(collections.Counter(one['rule'] for one in chosen))} rules)")
    if wrong or not asked.build:
        return 1 if wrong else 0
    if asked.changed:
        changed = changed_since(asked.changed)
        chosen = [one for one in chosen if one["file"] in changed]
    return 1 if run(asked.build.resolve(), chosen, asked.jobs) else 0


if __name__ == "__main__":
    sys.exit(main())
