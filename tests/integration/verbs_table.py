#!/usr/bin/env python3
"""Every verb of odomcalibctl in one table: what --help says, which exit status a call has, and which members its JSON.
A verb that the program lists and the table lacks is a failure, and so is one that the program lacks.

usage: tests/integration/verbs_table.py ODOMCALIBCTL"""

import json
import os
import re
import subprocess
import sys
import tempfile

DONE, FAILURE, USAGE, REFUSED, NO_DAEMON = 0, 1, 2, 3, 9
ABSENT = "/nonexistent/file"
ERROR = {"error"}
MEMBERS_OF_ERROR = {"code", "what", "where", "remedy"}
CALIBRATION = {"format", "verdict", "reasons", "robot", "parameters", "covariance", "residual", "data"}

# verb, arguments, exit status, members that its JSON has at least (None: JSON Lines, each line an object).
# A straight drive alone does not determine the track width: it is refused.
TABLE = [
    ("solve", "drive.jsonl --out cal.json", REFUSED, CALIBRATION),
    ("solve", ABSENT, FAILURE, ERROR),
    ("predict", "drive.jsonl --calibration nominal --trajectory path.tum", DONE, {"poses", "end"}),
    ("predict", "drive.jsonl --trajectory path.tum --calibration " + ABSENT, FAILURE, ERROR),
    ("convert", "drive.jsonl --out copy.jsonl", DONE, {"motion", "samples", "scans", "poses", "gyro"}),
    ("convert", ABSENT + " --out copy.jsonl", FAILURE, ERROR),
    ("decode", "ld06 drive.jsonl", DONE, {"type", "bytes_in", "good", "skipped", "buffered", "rejected"}),
    ("decode", "no_such_driver drive.jsonl", USAGE, ERROR),
    ("match", "pairs.jsonl", DONE, None),
    ("match", ABSENT, FAILURE, ERROR),
    ("report", "cal.json", DONE, CALIBRATION),
    ("report", "drive.jsonl", FAILURE, ERROR),
    ("export", "cal.json --what parameters", DONE, {"what", "text"}),
    ("export", "cal.json --what toml", REFUSED, ERROR),
    ("export", "cal.json --what fax", USAGE, ERROR),
    ("graph info", "map.g2o", DONE, {"poses", "pose_edges", "chi2", "notes"}),
    ("graph info", ABSENT, FAILURE, ERROR),
    ("graph optimize", "map.g2o --out better.g2o", DONE, {"state", "chi2_before", "chi2_after", "vertices", "edges"}),
    ("graph optimize", ABSENT + " --out better.g2o", FAILURE, ERROR),
    ("graph build", "drive.jsonl --out built.g2o", FAILURE, ERROR),
    ("status", "", NO_DAEMON, ERROR),
    ("stop", "", NO_DAEMON, ERROR),
    ("history", "", NO_DAEMON, ERROR),
    ("params get", "", NO_DAEMON, ERROR),
    ("params diff", "", NO_DAEMON, ERROR),
    ("params set", "--yes track_width=0.4", NO_DAEMON, ERROR),
    ("monitor", "", NO_DAEMON, ERROR),
    ("record", "--duration 1", NO_DAEMON, ERROR),
    ("check", "", NO_DAEMON, ERROR),
    ("straight", "--yes", NO_DAEMON, ERROR),
    ("spin", "--yes", NO_DAEMON, ERROR),
    ("calibrate", "--yes --out drawn.json", NO_DAEMON, ERROR),
    ("apply", "cal.json --yes", NO_DAEMON, ERROR),
    ("rollback", "--yes", NO_DAEMON, ERROR),
]


class Program:
    def __init__(self, path, folder):
        self.path, self.folder, self.faults = os.path.abspath(path), folder, []

    def run(self, *words):
        return subprocess.run([self.path, *words], cwd=self.folder, check=False, text=True, timeout=60,
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


def prepare(folder):
    """Two metres straight with poses that agree, a graph of two poses, and a pair that is none."""
    with open(os.path.join(folder, "drive.jsonl"), "w", encoding="utf-8") as file:
        lines = [{"type": "robot", "wheel_diameter": 0.15, "track_width": 0.4, "ticks_per_rev": 4096}]
        for i in range(101):
            lines.append({"type": "ticks", "t": 0.1 * i, "left": 174 * i, "right": 174 * i})
            lines.append({"type": "pose", "t": 0.1 * i, "x": 0.02 * i, "y": 0.0, "yaw": 0.0})
        file.writelines(json.dumps(line) + "\n" for line in lines)
    with open(os.path.join(folder, "map.g2o"), "w", encoding="utf-8") as file:
        file.write("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n")
    with open(os.path.join(folder, "pairs.jsonl"), "w", encoding="utf-8") as file:
        file.write("{}\n")


def check_help(program, verb):
    done = program.run(*verb.split(), "--help")
    program.demand(done.returncode == DONE and not done.stderr, "%s --help: status %d" % (verb, done.returncode))
    for said in ("Usage: odomcalibctl " + verb, "Exit status:"):
        program.demand(said in done.stdout, '%s --help does not say "%s"' % (verb, said))
    wrong = program.run(*verb.split(), "--no-such-option", "--json=short")
    program.demand(wrong.returncode == USAGE, "%s --no-such-option: status %d" % (verb, wrong.returncode))
    check_json(program, verb + " --no-such-option", wrong.stdout, ERROR)


def check_json(program, call, text, members):
    try:
        documents = [json.loads(line) for line in text.splitlines()]
    except ValueError as error:
        program.demand(False, "%s: no JSON: %s: %s" % (call, error, text[:200]))
        return
    program.demand(all(isinstance(document, dict) for document in documents), call + ": an object a line")
    if members is None:
        program.demand(len(documents) > 0, call + ": prints nothing")
        return
    program.demand(len(documents) == 1, "%s: %d documents" % (call, len(documents)))
    for document in documents[:1]:
        program.demand(members <= document.keys(), "%s: lacks %s" % (call, sorted(members - document.keys())))
        program.demand(("error" in document) == (members == ERROR), call + ": an error or none")
        if members == ERROR and "error" in document:
            program.demand(document["error"].keys() == MEMBERS_OF_ERROR, "%s: %s" % (call, document["error"]))


def check_call(program, verb, arguments, status, members):
    call = " ".join([verb, arguments]).strip()
    done = program.run("--socket", "/nonexistent/control", *call.split(), "--json=short")
    program.demand(done.returncode == status, "%s: status %d, not %d: %s" % (call, done.returncode, status, done.stderr))
    check_json(program, call, done.stdout, members)
    program.demand(members != ERROR or done.stderr.strip(), call + ": nothing for people on standard error")


def main(path):
    with tempfile.TemporaryDirectory() as folder:
        prepare(folder)
        program = Program(path, folder)
        listed, known = program.verbs(), {row[0] for row in TABLE}
        program.demand(listed == known, "not in both table and program: %s" % sorted(listed ^ known))
        for verb in sorted(listed & known):
            check_help(program, verb)
        for row in TABLE:
            check_call(program, *row)
    for fault in program.faults:
        print(fault)
    print("%d verbs, %d calls, %d faults" % (len(listed), len(TABLE), len(program.faults)))
    return 1 if program.faults or not listed else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
