#!/usr/bin/env python3
"""Every verb of odomcalibctl in one table: what --help says, which exit status a call has, which published schema its JSON
keeps to, and whether its text fits a terminal. A verb that the program lists and the table lacks is a failure, and so is one that the program lacks, and a schema
that no call shows.

usage: tests/integration/verbs_table.py ODOMCALIBCTL SCHEMAS SAMPLE"""

import gzip
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile

import live_verbs
from schemas import Schemas
from text_width import COLUMNS, too_wide

DONE, FAILURE, USAGE, REFUSED, NO_DAEMON = 0, 1, 2, 3, 9
ABSENT = "/nonexistent/file"
# The summary of a calibration fits a screen; --verbose has the rest.
SUMMARIES, SCREEN = {"solve", "report"}, 40

# verb, arguments, exit status, schema of its JSON: one document, or lines where LINES has the schema.
# A straight drive alone does not determine the track width: it is refused.
LINES = {"decoded", "match"}
TABLE = [
    ("solve", "drive.jsonl --out cal.json", REFUSED, "calibration"),
    ("solve", "sample.jsonl.gz --out good.json", DONE, "calibration"),
    ("solve", "drive.jsonl --rounds 2 --cut 0.02 --pairs motions.csv", REFUSED, "calibration"),
    ("solve", ABSENT, FAILURE, "error"),
    ("solve", "good.json", FAILURE, "error"),
    ("solve", "drive.jsonl --effects backlsh", USAGE, "error"),
    ("predict", "drive.jsonl --calibration nominal --trajectory path.tum", DONE, "prediction"),
    ("predict", "drive.jsonl --calibration nominal --trajectory path.tum --noise 0.01,0.001,0.01", DONE, "prediction"),
    ("predict", "drive.jsonl --trajectory path.tum --calibration " + ABSENT, FAILURE, "error"),
    ("inspect", "drive.jsonl", DONE, "inspection"),
    ("inspect", "sample.jsonl.gz", DONE, "inspection"),
    ("inspect", "map.g2o", FAILURE, "error"),
    ("inspect", ABSENT, FAILURE, "error"),
    ("convert", "drive.jsonl --out copy.jsonl", DONE, "conversion"),
    ("convert", ABSENT + " --out copy.jsonl", FAILURE, "error"),
    ("convert", "drive.jsonl --out copy.bag", USAGE, "error"),
    ("decode", "ld06 lidar.bin", DONE, "decoded"),
    ("decode", "ld06 drive.jsonl", FAILURE, "error"),
    ("decode", "no_such_driver lidar.bin", USAGE, "error"),
    ("match", "pairs.jsonl", DONE, "match"),
    ("match", "pairs.jsonl --matcher brute", DONE, "match"),
    ("match", ABSENT, FAILURE, "error"),
    ("match", "drive.jsonl", FAILURE, "error"),
    ("report", "cal.json", DONE, "calibration"),
    ("report", "good.json", DONE, "calibration"),
    ("report", "drive.jsonl", FAILURE, "error"),
    ("report", "before.json --html page.html --history history.json", DONE, "calibration"),
    ("report", "before.json --html page.html --history drive.jsonl", FAILURE, "error"),
    ("report", "before.json --html page.html --history " + ABSENT, FAILURE, "error"),
    ("report", "before.json --html history.json --history history.json", USAGE, "error"),
    ("report", "before.json --history history.json", USAGE, "error"),
    ("compare", "before.json after.json", DONE, "comparison"),
    ("compare", "before.json after.json --until 5mm/m --csv values.csv --html values.html", DONE, "comparison"),
    ("compare", "before.json after.json other.json --by robot", DONE, "comparison"),
    ("compare", "before.json other.json", USAGE, "error"),
    ("compare", "before.json after.json --until soon", USAGE, "error"),
    ("compare", "before.json cal.json", REFUSED, "error"),
    ("compare", "before.json " + ABSENT, FAILURE, "error"),
    ("export", "cal.json --what parameters", DONE, "export"),
    ("export", "cal.json --what toml", REFUSED, "error"),
    ("export", "cal.json --what fax", USAGE, "error"),
    ("export", "good.json --what diff_drive --into controllers.yaml --yes", DONE, "export"),
    ("export", "good.json --what diff_drive --into controllers.yaml --yes", DONE, "export"),
    ("export", "before.json --what diff_drive --into controllers.yaml", USAGE, "error"),
    ("export", "good.json --what diff_drive --into robot.toml --yes", FAILURE, "error"),
    ("export", "good.json --what toml --into robot.toml --yes", USAGE, "error"),
    ("graph info", "map.g2o", DONE, "graph-info"),
    ("graph info", ABSENT, FAILURE, "error"),
    ("graph optimize", "map.g2o --out better.g2o", DONE, "graph-optimize"),
    ("graph optimize", ABSENT + " --out better.g2o", FAILURE, "error"),
    ("graph build", "sample.jsonl.gz --out built.g2o", DONE, "graph-build"),
    ("graph build", "drive.jsonl --out built.g2o", FAILURE, "error"),
    ("status", "", NO_DAEMON, "error"),
    ("stop", "", NO_DAEMON, "error"),
    ("wait", "--timeout 0.2", NO_DAEMON, "error"),
    ("wait", "--until never", USAGE, "error"),
    ("history", "", NO_DAEMON, "error"),
    ("params get", "", NO_DAEMON, "error"),
    ("params diff", "", NO_DAEMON, "error"),
    ("params set", "--yes track_width=0.4", NO_DAEMON, "error"),
    ("monitor", "", NO_DAEMON, "error"),
    ("view", "--port 0", NO_DAEMON, "error"),
    ("record", "--duration 1", NO_DAEMON, "error"),
    ("check", "", NO_DAEMON, "error"),
    ("straight", "--yes", NO_DAEMON, "error"),
    ("spin", "--yes", NO_DAEMON, "error"),
    ("calibrate", "--yes --out drawn.json", NO_DAEMON, "error"),
    ("apply", "cal.json --yes", NO_DAEMON, "error"),
    ("rollback", "--yes", NO_DAEMON, "error"),
]
# Files that the calls above read and write, and the schema of each or of its lines.
FILES = [("history.json", "history"), ("cal.json", "calibration"), ("good.json", "calibration"), ("drive.jsonl", "recording"),
         ("copy.jsonl", "recording"), ("pairs.jsonl", "pair")]


# Verbs whose output is a file for other programs: JSON Lines, configurations.
FOR_PROGRAMS = {"decode", "match", "export"}


class Program:
    def __init__(self, path, folder, schemas):
        self.path, self.folder, self.schemas, self.faults = os.path.abspath(path), folder, schemas, []
        self.environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"}

    def run(self, *words):
        return subprocess.run([self.path, *words], cwd=self.folder, env=self.environment, check=False, text=True, timeout=60,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def demand(self, holds, what):
        if not holds:
            self.faults.append(what)

    def subcommands(self, *words):
        """Names that --help lists."""
        text = self.run(*words, "--help").stdout
        listed = re.search(r"^Subcommands:\n((?:  \S.*\n| {3,}.*\n)*)", text, re.MULTILINE)
        return re.findall(r"^  (\w+)", listed.group(1), re.MULTILINE) if listed else []

    def verbs(self):
        return {" ".join([verb, *([below] if below else [])])
                for verb in self.subcommands() for below in self.subcommands(verb) or [None]}


def room(x):
    """What a lidar sees in a room of 6 m by 4 m from x m beside its middle."""
    ranges = []
    for k in range(180):
        c, s = math.cos(math.radians(2 * k)), math.sin(math.radians(2 * k))
        ranges.append(round(min(((3.0 if c > 0 else -3.0) - x) / c if c else 99.0, (2.0 if s > 0 else -2.0) / s if s else 99.0), 4))
    return {"angle_min": 0.0, "angle_increment": math.radians(2), "range_min": 0.1, "range_max": 12.0, "ranges": ranges}


def calibration(robot, day, diameter):
    """Of one drive; the track width is not measured so well."""
    names = {"left_wheel_diameter": (diameter, 3e-5), "right_wheel_diameter": (diameter, 3e-5), "track_width": (0.4, 2e-4)}
    return {"format": "odomcalib-calibration/1", "verdict": "accepted", "reasons": [], "robot": {"robot_id": robot},
            "driven": {"begin": day + "T10:00:00Z", "end": day + "T10:05:00Z"},
            "parameters": {name: {"value": value, "std": std, "unit": "m"} for name, (value, std) in names.items()},
            "scale": {"value": 1.0, "std": 0.01, "source": "lidar data sheet"}}


def prepare(folder, sample):
    """Two metres straight with poses that agree, a graph of two poses, two scans of one room, and calibrations of two robots."""
    for name, made in (("before", calibration("a", "2026-01-05", 0.15)), ("after", calibration("a", "2026-06-05", 0.149)),
                       ("other", calibration("b", "2026-06-05", 0.15))):
        with open(os.path.join(folder, name + ".json"), "w", encoding="utf-8") as file:
            json.dump(made, file)
    with open(os.path.join(folder, "drive.jsonl"), "w", encoding="utf-8") as file:
        lines = [{"type": "robot", "wheel_diameter": 0.15, "track_width": 0.4, "ticks_per_rev": 4096}]
        for i in range(101):
            lines.append({"type": "ticks", "t": 0.1 * i, "left": 174 * i, "right": 174 * i})
            lines.append({"type": "pose", "t": 0.1 * i, "x": 0.02 * i, "y": 0.0, "yaw": 0.0})
        file.writelines(json.dumps(line) + "\n" for line in lines)
    with open(os.path.join(folder, "history.json"), "w", encoding="utf-8") as file:
        json.dump({"format": "odomcalib-history/1", "calibrations": "", "entries": [
            {"id": "0001", "time": 1795953600000000, "action": "apply", "outcome": "committed", "robot_id": "a", "device": "",
             "before": {"track_width": 0.4}, "after": {"track_width": 0.41}}]}, file)
    with open(os.path.join(folder, "map.g2o"), "w", encoding="utf-8") as file:
        file.write("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n")
    with open(os.path.join(folder, "pairs.jsonl"), "w", encoding="utf-8") as file:
        file.write(json.dumps({"reference": room(0.0), "scan": room(0.1), "guess": [0.0, 0.0, 0.0]}) + "\n")
    with open(os.path.join(folder, "controllers.yaml"), "w", encoding="utf-8") as file:
        file.write("diff_drive_controller:\n  ros__parameters:\n    wheel_separation: 0.4\n    wheel_radius: 0.07\n")
    with open(os.path.join(folder, "lidar.bin"), "wb") as file:
        file.write(bytes(range(256)))
    with gzip.open(sample, "rt", encoding="utf-8") as file:
        robot = json.loads(file.readline())
    with open(os.path.join(folder, "robot.toml"), "w", encoding="utf-8") as file:
        file.writelines("%s = %r\n" % (key, robot[key]) for key in ("wheel_diameter", "track_width", "ticks_per_rev"))
    shutil.copy(sample, os.path.join(folder, "sample.jsonl.gz"))


def check_help(program, verb):
    done = program.run(*verb.split(), "--help")
    program.demand(done.returncode == DONE and not done.stderr, "%s --help: status %d" % (verb, done.returncode))
    for said in ("Usage: odomcalibctl " + verb, "Examples:", "Exit statuses:"):
        program.demand(said in done.stdout, '%s --help does not say "%s"' % (verb, said))
    for line in done.stdout.splitlines():
        program.demand(len(line) <= COLUMNS, "%s --help: %d columns: %s" % (verb, len(line), line))
    wrong = program.run(*verb.split(), "--no-such-option", "--json=short")
    program.demand(wrong.returncode == USAGE, "%s --no-such-option: status %d" % (verb, wrong.returncode))
    check_json(program, verb + " --no-such-option", wrong.stdout, "error")


def examples(program, verb):
    """Calls that --help shows."""
    text = program.run(*verb.split(), "--help").stdout.partition("Examples:\n")[2]
    return [line.split() for line in text.splitlines() if line.startswith("  odomcalibctl ")]


def check_examples(program, verb):
    """They run as they stand, here without a daemon: a robot is asked for, not a better command line."""
    shown = examples(program, verb)
    program.demand(len(shown) == 2, "%s --help: %d examples" % (verb, len(shown)))
    for _, *words in shown:
        done = program.run("--socket", "/nonexistent/control", *words)
        if done.returncode == USAGE and "consent" in done.stderr:  # on a terminal it asks
            done = program.run("--socket", "/nonexistent/control", *words, "--yes")
        program.demand(done.returncode in (DONE, NO_DAEMON), "%s: status %d: %s" % (" ".join(words), done.returncode, done.stderr))


def check_json(program, call, text, schema):
    try:
        documents = [json.loads(line) for line in text.splitlines()]
    except ValueError as error:
        program.demand(False, "%s: no JSON: %s: %s" % (call, error, text[:200]))
        return
    program.demand(documents and (len(documents) == 1 or schema in LINES), "%s: %d documents" % (call, len(documents)))
    for document in documents:
        for fault in program.schemas.faults(document, schema):
            program.demand(False, call + ": " + fault)


def check_call(program, verb, arguments, status, schema):
    call = " ".join([verb, arguments]).strip()
    done = program.run("--socket", "/nonexistent/control", *call.split(), "--json=short")
    program.demand(done.returncode == status, "%s: status %d, not %d: %s" % (call, done.returncode, status, done.stderr))
    check_json(program, call, done.stdout, schema)
    program.demand(schema != "error" or done.stderr.strip(), call + ": nothing for people on standard error")


def check_text(program, verb, arguments, status, _):
    call = " ".join([verb, arguments]).strip()
    done = program.run("--socket", "/nonexistent/control", *call.split())
    program.demand(done.returncode == status, "%s: status %d, not %d: %s" % (call, done.returncode, status, done.stderr))
    if verb in SUMMARIES:
        lines = len(done.stdout.splitlines())
        program.demand(lines <= SCREEN, "%s: %d lines" % (call, lines))
    if verb not in FOR_PROGRAMS:
        for line in too_wide(done.stdout):
            program.demand(False, "%s: %d columns: %s" % (call, len(line), line))


def check_file(program, name, schema):
    with open(os.path.join(program.folder, name), encoding="utf-8") as file:
        text = file.read()
    documents = [json.loads(text)] if name.endswith(".json") else [json.loads(line) for line in text.splitlines()]
    for document in documents:
        for fault in program.schemas.faults(document, schema):
            program.demand(False, "%s: %s" % (name, fault))


def main(path, schema_folder, sample):
    schemas = Schemas(schema_folder)
    with tempfile.TemporaryDirectory() as folder:
        prepare(folder, sample)
        program = Program(path, folder, schemas)
        listed, known = program.verbs(), {row[0] for row in TABLE}
        program.demand(listed == known, "not in both table and program: %s" % sorted(listed ^ known))
        for verb in sorted(listed & known):
            check_help(program, verb)
        shutil.copy(os.path.join(folder, "sample.jsonl.gz"), os.path.join(folder, "drive.jsonl.gz"))
        for verb in ("solve", "graph build"):  # what others read
            check_examples(program, verb)
        with open(os.path.join(folder, "cal.json"), encoding="utf-8") as file:
            later = json.load(file)
        later["data"][0]["sha256"] = "of another drive"
        with open(os.path.join(folder, "later.json"), "w", encoding="utf-8") as file:
            json.dump(later, file)
        for verb in sorted(listed & known - {"solve", "graph build"}):
            check_examples(program, verb)
        for row in TABLE:
            check_call(program, *row)
            check_text(program, *row)
        for row in FILES:
            check_file(program, *row)
    shown = {row[-1] for row in TABLE + FILES + live_verbs.TABLE}
    program.demand(shown == schemas.names(), "not in both tables and %s: %s" % (schema_folder, sorted(shown ^ schemas.names())))
    live = {row[0] for row in live_verbs.TABLE if row[-1] != "error"}
    shows_result = live | {row[0] for row in TABLE if row[-1] != "error"}
    program.demand(shows_result >= listed, "only ever fails: %s" % sorted(listed - shows_result))
    for fault in program.faults:
        print(fault)
    print("%d verbs, %d calls, %d files, %d faults" % (len(listed), len(TABLE), len(FILES), len(program.faults)))
    return 1 if program.faults or not listed else 0


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
