#!/usr/bin/python3
"""Runs the mutants that draw.py put into a copy of the tree, built once, by the tests that reach them.

Usage: run_drawn.py --tree TREE --build BUILD reach [PROGRAM...]  runs each test once and notes which mutants it reaches
       run_drawn.py --tree TREE --build BUILD run [NUMBER...] [--again]      runs the mutants that have no result yet
       run_drawn.py --tree TREE --build BUILD table               docs/evidence/drawn-mutants.md

A mutant is killed by the first of these tests that fails, crashes, or does not come to an end in several times its time; one that no test
reaches survives without being run. What was noted stands in BUILD/drawn.json and goes on where it was interrupted.
drawn_judged.toml says of survivors why they change nothing, or which other layer keeps what they take away.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
DOCUMENT = ROOT / "docs/evidence/drawn-mutants.md"
MOST = 4096  # as drawn_mutant.hpp says
LONGEST = 240  # s of one run of a program that takes less than a quarter of it
# Quick ones first; a mutant sees a later program only when all earlier ones let it live.
PROGRAMS = [
    "unit_safety", "unit_routines", "unit_motion_run", "unit_service_parts", "unit_control_server", "unit_disk_worker",
    "unit_recorder", "unit_solver_job", "unit_lidar_link", "unit_base_link", "unit_config", "unit_report", "unit_drivers",
    "unit_controllers", "unit_writeback", "unit_causes", "unit_classical", "unit_comparison", "unit_calib", "unit_cli",
    "integration_service", "integration_nudge", "integration_faults", "integration_cli", "integration_solver",
    "integration_scan_path", "integration_loop", "integration_lines", "integration_mistakes", "integration_accuracy",
    "integration_manual"]
# Whole programs in real time: asked for by name.
REAL_TIME = ["integration_processes"]


RUNNING = set()


def end(*_):
    """At once, with all tests that run: what they would find is not known, and runs again."""
    for process in list(RUNNING):
        os.killpg(process.pid, 9)
    os._exit(1)


def tests_of(program):
    lines = subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    suite, found = "", []
    for line in lines.splitlines():
        name = line.split("#")[0].rstrip()
        if name.endswith(".") and not name.startswith(" "):
            suite = name
        elif name.startswith("  ") and "DISABLED_" not in suite + name:
            found.append(suite + name.strip())
    return found


def run_tests(tree, program, names, number, longest, reached=None):
    """(first test that failed or None, seconds)"""
    environment = {**os.environ, "ODOMCALIB_MUTANT": str(number)}
    if reached:
        environment["ODOMCALIB_MUTANTS_REACHED"] = reached
    begin = time.monotonic()
    with tempfile.TemporaryFile("w+") as output:
        process = subprocess.Popen([program, "--gtest_fail_fast", "--gtest_color=no", "--gtest_filter=" + ":".join(names)],
                                   stdout=output, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, cwd=tree,
                                   env=environment, start_new_session=True)
        RUNNING.add(process)
        try:
            status = process.wait(longest)
        except subprocess.TimeoutExpired:
            status = "late"
        finally:
            RUNNING.discard(process)
            if process.poll() is None:
                os.killpg(process.pid, 9)
                process.wait()
        output.seek(0)
        said = output.read()
    took = time.monotonic() - begin
    if status == 0:
        return None, took
    failed = re.search(r"^\[  FAILED  \] ([^\s,]+)", said, re.M)
    begun = re.findall(r"^\[ RUN      \] (\S+)", said, re.M)
    name = failed.group(1) if failed else begun[-1] if begun else names[0]
    return name + (" (too long)" if status == "late" else "" if failed else " (crash)"), took


class Campaign:
    def __init__(self, tree, build, longest=float("inf")):
        self.longest = longest  # s of a test that is run for a mutant
        self.tree, self.bin, self.file = tree, build / "bin", build / "drawn.json"
        drawn = json.loads((tree / "drawn.json").read_text(encoding="utf-8"))
        self.seed, self.mutants = drawn["seed"], drawn["mutants"]
        self.state = json.loads(self.file.read_text()) if self.file.exists() else {"reach": {}, "result": {}}

    def save(self):
        self.file.with_suffix(".new").write_text(json.dumps(self.state, indent=0))
        self.file.with_suffix(".new").rename(self.file)

    def reach(self, programs, workers):
        for program in programs:
            known = self.state["reach"].setdefault(program, {})
            names = [name for name in tests_of(self.bin / program) if name not in known]
            with concurrent.futures.ThreadPoolExecutor(workers) as pool:
                for name, found in zip(names, pool.map(lambda one: self.reached_by(program, one), names)):
                    known[name] = found
            self.save()
            failed = [name for name, one in known.items() if one["failed"]]
            print(f"{program}: {len(known)} tests, {sum(one['took'] for one in known.values()):.0f} s, "
                  f"{len({number for one in known.values() for number in one['mutants']})} mutants reached"
                  + (f"; FAILS WITHOUT A MUTANT: {failed}" if failed else ""), flush=True)

    def reached_by(self, program, name):
        with tempfile.NamedTemporaryFile() as shared:
            shared.truncate(MOST)
            for _ in range(2):  # a test in real time may fail once on a busy machine
                failed, took = run_tests(self.tree, self.bin / program, [name], -1, LONGEST, shared.name)
                if not failed:
                    break
            flags = pathlib.Path(shared.name).read_bytes()
        return {"failed": failed, "took": took, "mutants": [number for number in range(MOST) if flags[number]]}

    def verdict_of(self, number):
        seen = 0
        for program in PROGRAMS + REAL_TIME:
            own = {name: one["took"] for name, one in self.state["reach"].get(program, {}).items()
                   if number in one["mutants"] and not one["failed"] and one["took"] <= self.longest}
            if not own:
                continue
            seen += len(own)
            failed = self.killed_by(program, own, number)
            if failed:
                return {"killed": failed, "with": program}
        return {"survived": seen}

    def killed_by(self, program, own, number):
        """The first of these tests that fails with the mutant, and fails again when it runs alone."""
        while own:
            longest = max(4 * sum(own.values()), min(LONGEST, 10 + 10 * sum(own.values())))
            failed, _ = run_tests(self.tree, self.bin / program, sorted(own, key=own.get), number, longest)
            if not failed or failed.endswith(")"):  # too long, or a crash: nothing that a busy machine does
                return failed
            if run_tests(self.tree, self.bin / program, [failed], number, longest)[0]:
                return failed
            own = {name: took for name, took in own.items() if name != failed}
        return None

    def run(self, numbers, workers):
        with concurrent.futures.ThreadPoolExecutor(workers) as pool:
            waiting = {pool.submit(self.verdict_of, number): number for number in numbers}
            for done in concurrent.futures.as_completed(waiting):
                number, result = waiting[done], done.result()
                self.state["result"][str(number)] = result
                self.save()
                if "survived" in result:
                    one = self.mutants[number]
                    print(f'SURVIVED {number} {one["file"]}:{one["line"]} {one["function"]}: {one["kind"]}: {one["what"]} '
                          f'({result["survived"]} tests)', flush=True)
        counts = collections.Counter(next(iter(one)) for one in self.state["result"].values())
        print(dict(counts))


def judged(seed):
    """{(file, function, what): row} of the survivors of this seed that somebody has read."""
    rows = tomllib.loads((HERE / "drawn_judged.toml").read_text(encoding="utf-8")).get("judged", [])
    return {(row["file"], row["function"], row["what"]): row for row in rows if row.get("seed", seed) == seed}


def outcome(result, row):
    if "killed" in result:
        return "killed", f'{result["killed"]} ({result["with"]})'
    if row and "killed" in row:
        return "killed", f'{row["killed"]}, by hand'
    if row and "equivalent" in row:
        return "equivalent", row["equivalent"]
    if row and "covered" in row:
        return "covered", row["covered"]
    return "**survived**", (row or {}).get("open", "no test reaches it" if not result["survived"] else
                                           f'{result["survived"]} tests reach it')


def cell(text):
    return text.replace("|", "\\|").replace("*", "\\*") if not text.startswith("`") else text.replace("|", "\\|")


def table(campaign):
    known = judged(campaign.seed)
    rows, counts = [], collections.defaultdict(collections.Counter)
    for one in campaign.mutants:
        result = campaign.state["result"].get(str(one["number"]))
        if result is None:
            continue
        state, why = outcome(result, known.get((one["file"], one["function"], one["what"])))
        folder = "/".join(one["file"].split("/")[:2])
        counts[folder][state.strip("*")] += 1
        rows.append(f'| {one["number"]} | {one["file"]} | {one["function"]} | {one["kind"]}: {cell(one["what"])} | '
                    f"{state} | {cell(why)} |")
    states = ["killed", "equivalent", "covered", "survived"]
    head = ["| folder | drawn | " + " | ".join(states) + " |", "| --- |" + " --- |" * (len(states) + 1)]
    head += [f"| {folder} | {sum(own.values())} | " + " | ".join(str(own[state]) for state in states) + " |"
             for folder, own in counts.items()]
    total = sum(counts.values(), collections.Counter())
    head.append(f"| all | {sum(total.values())} | " + " | ".join(str(total[state]) for state in states) + " |")
    text = DOCUMENT.read_text(encoding="utf-8")
    body = "\n".join([f"Seed {campaign.seed}.", "", *head, "", "| | file | function | change | | by, or why |",
                      "| --- | --- | --- | --- | --- | --- |", *rows])
    mark = "<!-- written by run_drawn.py table -->\n"
    DOCUMENT.write_text(text[:text.index(mark)] + mark + "\n" + body + "\n", encoding="utf-8")
    print("\n".join(head))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tree", type=pathlib.Path, required=True)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--again", action="store_true", help="those that survived too")
    parser.add_argument("what", choices=["reach", "run", "table"])
    parser.add_argument("which", nargs="*", help="programs or numbers of mutants")
    parser.add_argument("--longest", type=float, default=float("inf"), metavar="S", help="no tests that take longer")
    asked = parser.parse_args()
    signal.signal(signal.SIGTERM, end)
    signal.signal(signal.SIGINT, end)
    campaign = Campaign(asked.tree.resolve(), asked.build.resolve(), asked.longest)
    if asked.what == "reach":
        campaign.reach(asked.which or PROGRAMS, asked.jobs)
    elif asked.what == "run":
        results = campaign.state["result"]
        open_ones = [number for number in range(len(campaign.mutants)) if str(number) not in results
                     or (asked.again and "survived" in results[str(number)])]
        campaign.run([int(number) for number in asked.which] or open_ones, asked.jobs)
    else:
        table(campaign)


if __name__ == "__main__":
    sys.exit(main())
