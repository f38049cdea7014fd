#!/usr/bin/env python3
"""What people see of an error: on a terminal of 80 columns no line is wider, in a pipe each message is one line, and both say
the same words.

usage: tests/integration/errors_on_terminal.py PROGRAM SAMPLE_RECORDING"""

import os
import subprocess
import sys
import tempfile

from text_width import COLUMNS, shown_on_terminal, too_wide

ROBOT = '{"type":"robot","wheel_diameter":0.15,"track_width":0.4,"ticks_per_rev":4096,"lidar_pose":[0,0,0]}\n'
FILES = {
    "empty.jsonl": "",
    "words.txt": "this is no recording at all\n",
    "robot.jsonl": ROBOT,
    "ticks.jsonl": ROBOT + "".join(f'{{"type":"ticks","t":{0.02 * i:.2f},"left":{9 * i},"right":{9 * i}}}\n' for i in range(900)),
    "milliseconds.jsonl": ROBOT + "".join(f'{{"type":"ticks","t":{20 * i},"left":{9 * i},"right":{9 * i}}}\n'
                                          f'{{"type":"pose","t":{20 * i},"x":{0.001 * i},"y":0,"yaw":0}}\n' for i in range(900)),
    "broken.json": '{"format":"odomcalib-calibration/1","verdict":',
    "refused.json": '{"format":"odomcalib-calibration/1","verdict":"refused","reasons":["no scan was seen"]}\n',
    "robot.toml": "wheel_diameter = 150\ntrack_width = 0.4\n",
    "graph.g2o": "VERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0\n",
}
CALLS = [
    ["solve", "absent.jsonl"], ["solve", "empty.jsonl"], ["solve", "words.txt"], ["solve", "robot.jsonl"],
    ["solve", "ticks.jsonl"], ["solve", "milliseconds.jsonl"], ["solve", "refused.json"], ["solve", "ticks.jsonl", "--topic", "odd"],
    ["solve", "ticks.jsonl", "--topic", "scan=/x"], ["solve", "ticks.jsonl", "--scale", "1.0.0"], ["solve", "SAMPLE", "--effects", "bcklash"],
    ["solve", "ticks.jsonl", "--robot", "robot.toml"], ["solve", "ticks.jsonl", "--out", "ticks.jsonl"], ["solve", "graph.g2o"],
    ["predict", "words.txt"], ["convert", "ticks.jsonl", "--out", "ticks.bag"], ["report", "broken.json"], ["report", "ticks.jsonl"],
    ["export", "--what", "urdf", "refused.json"], ["export", "--what", "nothing", "refused.json"], ["compare", "refused.json", "broken.json"],
    ["decode", "ticks.jsonl"], ["match", "ticks.jsonl"], ["graph", "optimize", "graph.g2o"], ["inspect", "absent.jsonl"], ["sovle", "ticks.jsonl"],
    ["status", "--socket", "/absent/control"], ["solve", "SAMPLE", "--sensor", "front"],
]


def in_pipe(command, folder):
    return subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)


def words(text):
    return [word for word in text.split() if word != "\\"]


def spoken(text):
    """Without the marks that join sentences: on a terminal the next one begins a line."""
    return [word.rstrip(";") for word in words(text)]


def faults_of(program, arguments, folder):
    command = [program, *arguments]
    piped, seen = in_pipe(command, folder), shown_on_terminal(command, folder)
    name = "odomcalibctl " + " ".join(arguments)
    if piped.returncode == 0:
        yield f"{name}: is no error"
    if not piped.stderr:
        return  # a refusal is a result, on standard output
    for line in too_wide(seen):
        yield f"{name}: wider than {COLUMNS}: {line}"
    for line in piped.stderr.splitlines():
        if line.startswith(" "):
            yield f"{name}: a message of more than one line in a pipe: {line}"
    if spoken(seen) != spoken(piped.stderr):
        yield f"{name}: other words on a terminal:\n{seen}\nthan in a pipe:\n{piped.stderr}"


def main(program, sample):
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        for name, text in FILES.items():
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        for call in CALLS:
            arguments = [sample if word == "SAMPLE" else word for word in call]
            faults += faults_of(program, arguments, folder)
            if os.environ.get("SHOW"):
                print("$ odomcalibctl", *call)
                print(shown_on_terminal([program, *arguments], folder))
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])))
