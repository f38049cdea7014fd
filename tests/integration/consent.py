#!/usr/bin/env python3
"""Consent on a terminal (rules M11, B6), against the simulated robot: who is asked, what is shown, and what an answer does.

usage: tests/integration/consent.py PROGRAMS PROFILE"""

import json
import os
import pty
import pwd
import select
import sys
import time

from simulated_robot import SimulatedRobot

CANCELLED = 4
QUESTION = "Type yes to go on: "
PATIENCE = 20.0  # s
CALIBRATION = {"format": "odomcalib-calibration/1", "verdict": "accepted", "robot": {"robot_id": "robot-B"},
               "parameters": {"track_width": {"value": 0.4033, "std": 1e-4, "unit": "m"}}}


def on_terminal(robot, words, answer, until):
    """What a person sees until one of the texts has come, and the exit status after the answer; None: it was stopped by us."""
    child, terminal = pty.fork()
    if child == 0:
        program = os.path.join(robot.programs, "odomcalibctl")
        os.execv(program, [program, "--socket", robot.path("control"), *words])
    seen, end = "", time.monotonic() + PATIENCE
    while not any(text in seen for text in until) and time.monotonic() < end:
        if not select.select([terminal], [], [], 0.1)[0]:
            continue
        try:
            seen += os.read(terminal, 65536).decode()
        except OSError:
            break
    os.write(terminal, (answer + "\n").encode() if QUESTION in seen else b"\x03")
    while True:
        try:
            if not os.read(terminal, 65536):
                break
        except OSError:
            break
    _, status = os.waitpid(child, 0)
    os.close(terminal)
    return seen, os.waitstatus_to_exitcode(status)


def main(programs, profile):
    faults, move = [], ["straight", "--one-way", "--distance", "0.2"]

    def expect(holds, otherwise):
        if not holds:
            faults.append(otherwise)

    with SimulatedRobot(programs, profile, seed=3, hurry=True) as robot:
        seen, status = on_terminal(robot, [*move, "--yes"], "no", [QUESTION])
        expect(QUESTION in seen, "--yes was enough for a first motion:\n" + seen)
        expect("first motion of this robot" in seen, "the question does not say that it is the first:\n" + seen)
        expect("RRRRR" in seen and "required, m" in seen, "no drawing of the space:\n" + seen)
        expect(status == CANCELLED, "status %d after no" % status)
        robot.wait_until(robot.ready, "the robot is not at rest")
        plan = robot.ctl(*move, "--dry-run")
        expect("first motion of this robot" in plan.stdout, "it moved after no")

        # A script has nobody to ask; its --yes is somebody's who gave it.
        done = robot.ctl(*move, "--yes")
        expect("first motion of this robot" in done.stderr, "a script is not told: " + done.stderr)
        expect("odomcalibctl: this is the first" not in done.stderr, "it looks like an error: " + done.stderr)
        robot.wait_until(robot.ready, "the robot does not come to rest")
        seen, _ = on_terminal(robot, [*move, "--yes"], "no", [QUESTION, "Ctrl-C stops the robot"])
        expect(QUESTION not in seen, "asked again after the first motion:\n" + seen)
        robot.wait_until(robot.ready, "the robot does not come to rest")
        seen, status = on_terminal(robot, move, "no", [QUESTION, "Ctrl-C stops the robot"])
        expect(QUESTION in seen and status == CANCELLED, "no question without --yes:\n" + seen)

        # Before values are written: where a rollback goes, and whose calibration it is.
        robot.wait_until(robot.ready, "the robot does not come to rest")
        done = robot.ctl("params", "set", "--yes", "track_width=0.4003")
        expect(done.returncode == 0, "track width not set: " + done.stderr)
        seen, status = on_terminal(robot, ["rollback"], "no", [QUESTION])
        expect("the values before entry 0001" in seen and "track_width 400.000 mm" in seen, "where does it go:\n" + seen)
        expect(status == CANCELLED, "status %d after no" % status)
        with open(robot.path("cal.json"), "w", encoding="utf-8") as file:
            json.dump(CALIBRATION, file)
        seen, status = on_terminal(robot, ["apply", robot.path("cal.json")], "no", [QUESTION])
        expect("Nothing moves" in seen and "area clear" not in seen, "a write is asked about as a motion:\n" + seen)
        expect('"robot-B"' in seen and "Is it of this robot?" in seen, "whose robot is not asked:\n" + seen)
        expect(status == CANCELLED, "status %d after no" % status)
        done = robot.ctl("apply", robot.path("cal.json"), "--yes")
        expect(done.returncode == 0 and "robot-B" in done.stderr, "a script is not told whose it is: " + done.stderr)
        newest = json.loads(robot.ctl("history", "--json").stdout)["entries"][0]
        expect(newest["user"] == os.getuid() and newest["proven"] is False, "history: %s" % newest)
        expect(newest.get("user_name") == pwd.getpwuid(os.getuid()).pw_name, "no name in history: %s" % newest)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
