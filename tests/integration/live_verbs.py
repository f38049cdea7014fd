#!/usr/bin/env python3
"""The verbs that need the daemon, against the simulated robot: exit status, and the published schema of their JSON,
or with --text whether their text fits a terminal.

usage: tests/integration/live_verbs.py PROGRAMS SCHEMAS PROFILE [--text]"""

import json
import os
import subprocess
import sys

from schemas import Schemas
from simulated_robot import SimulatedRobot
from text_width import too_wide

DONE, USAGE = 0, 2
STOPPED = {4, 5, 6}  # protective stops: on a busy machine the simulated robot itself may be late
TRIES = 4

# verb, arguments, exit status, schema; in this order, each with what the calls before it left.
TABLE = [
    ("status", "", DONE, "status"),
    ("wait", "", DONE, "wait"),
    ("wait", "--until idle --timeout 1", DONE, "wait"),
    ("check", "", DONE, "checks"),
    ("check", "--nudge --dry-run", DONE, "plan"),
    ("check", "--nudge --yes", DONE, "checks"),
    ("params get", "", DONE, "parameters"),
    ("history", "", DONE, "history"),
    ("rollback", "--yes", USAGE, "error"),
    ("calibrate", "--dry-run", DONE, "plan"),
    ("straight", "--one-way --yes --distance 0.3 --out lengths.json", DONE, "moves"),
    ("spin", "--dry-run", DONE, "plan"),
    ("spin", "--turns 0.3 --direction cw --yes", DONE, "moves"),
    ("record", "--duration 0.3", DONE, "record"),
    ("apply", "lengths.json --dry-run", DONE, "write-back"),
    ("params set", "--yes track_width=0.4003", DONE, "write-back"),
    ("apply", "lengths.json --yes", DONE, "write-back"),
    ("params diff", "", DONE, "parameters"),
    ("rollback", "--yes", DONE, "write-back"),
    ("history", "", DONE, "history"),
    ("monitor", "--duration 0.6", DONE, "event"),
    ("view", "--port 0 --duration 0.6", DONE, "view"),
    ("stop", "", DONE, "stop"),
]
FILES = [("lengths.json", "calibration")]
# Next command that the text of a verb leads to.
SAYS = {"history": "odomcalibctl compare"}


def call_until_it_goes(robot, words, *options):
    for _ in range(TRIES):
        robot.wait_until(robot.ready, "the controller does not come to rest")
        done = robot.ctl(*options, *words)
        if done.returncode not in STOPPED:
            break
        print("once more, after exit status %d: %s" % (done.returncode, done.stderr.strip()))
    return done


def check_call(robot, schemas, verb, arguments, status, schema):
    call = (verb + " " + arguments).strip()
    done = call_until_it_goes(robot, call.split(), "--json=short")
    found = [] if done.returncode == status else ["status %d, not %d: %s" % (done.returncode, status, done.stderr.strip())]
    documents = [json.loads(line) for line in done.stdout.splitlines()]
    found += ["no document"] if not documents else []
    for document in documents:
        found += schemas.faults(document, schema if done.returncode == status else "error")
    return [call + ": " + fault for fault in found]


def check_text(robot, verb, arguments, *_):
    """Statuses are the business of check_call()."""
    call = (verb + " " + arguments).strip()
    done = call_until_it_goes(robot, call.split())
    faults = ["%s: %d columns: %s" % (call, len(line), line) for line in too_wide(done.stdout)]
    if SAYS.get(verb, "") not in done.stdout:
        faults.append('%s does not say "%s": %s' % (call, SAYS[verb], done.stdout))
    return faults


def check_report(robot):
    """What was written and taken back, on page and terminal: by the service that answers, by what history printed, and by the state
    folder. Where nobody answers, nothing is said."""
    with open(robot.path("history.json"), "w", encoding="utf-8") as file:
        file.write(robot.ctl("history", "--json").stdout)
    faults, program = [], os.path.join(robot.programs, "odomcalibctl")
    for source in (["--socket", "control"], ["--history", "history.json"], ["--history", "state"], ["--socket", "nobody"]):
        done = subprocess.run([program, "report", "lengths.json", "--verbose", "--html", "page.html", *source], cwd=robot.folder,
                              check=False, text=True, timeout=60, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        if done.returncode != DONE or done.stderr:
            faults.append("report %s: status %d: %s" % (source, done.returncode, done.stderr))
        with open(robot.path("page.html"), encoding="utf-8") as file:
            shown = {"page": file.read(), "terminal": done.stdout}
        for where, text in shown.items():
            found = [said in " ".join(text.split()) for said in ("Written to the controller", "This calibration was written on",
                                                                 "Other values were written since: 0003.")]
            if found != [source[1] != "nobody"] * 3:
                faults.append("report %s, %s: %s" % (source, where, found))
    return faults


def main(programs, schema_folder, profile, text):
    schemas, faults = Schemas(schema_folder), []
    with SimulatedRobot(programs, profile, seed=3, hurry=True) as robot:
        for row in TABLE:
            faults += check_text(robot, *row) if text else check_call(robot, schemas, *row)
        faults += check_report(robot) if text else []
        for name, schema in FILES if not text else []:
            with open(robot.path(name), encoding="utf-8") as file:
                faults += schemas.faults(json.load(file), schema)
    for fault in faults:
        print(fault)
    print("%d calls, %d faults" % (len(TABLE), len(faults)))
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5) or sys.argv[4:] not in ([], ["--text"]):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:4], text=len(sys.argv) == 5))
