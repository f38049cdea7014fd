#!/usr/bin/env python3
"""Draws what a terminal of 80 columns shows, as pictures: a drive that is accepted, one with a warning, one that is refused, and
no daemon.

usage: terminal_pictures.py ODOMCALIBCTL DRIVE FOLDER           draws FOLDER/terminal-*.svg
       terminal_pictures.py --check ODOMCALIBCTL DRIVE FOLDER   whether they still show what the program prints, numbers aside
DRIVE is build/release/docs/examples/drive.jsonl.gz.
"""
import gzip
import html
import os
import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/integration"))
from text_width import COLUMNS, shown_on_terminal  # noqa: E402

LINE, CHARACTER, MARGIN = 17, 8.0, 14  # px
# What is wrong with the drive that is shown: its robot line, and what takes the place of what.
SHOWN = {
    "accepted": (["solve", "drive.jsonl"], ("", "")),
    "warnings": (["solve", "drive.jsonl"], ('"lidar_pose":[0.1,0,0]', '"lidar_pose":[0.1,0,1.5708]')),
    "refused": (["solve", "drive.jsonl"], ('"ticks_per_rev":16384', '"ticks_per_rev":4096')),
    "no-daemon": (["status"], ("", "")),
}


def screen(program, drive, name):
    arguments, (old, new) = SHOWN[name]
    with tempfile.TemporaryDirectory() as folder:
        robot, rest = gzip.decompress(pathlib.Path(drive).read_bytes()).decode().split("\n", 1)
        if old not in robot:
            sys.exit(f"{drive}: its first line has no {old}")
        pathlib.Path(folder, "drive.jsonl").write_text(robot.replace(old, new) + "\n" + rest)
        lines = shown_on_terminal([os.path.abspath(program), *arguments], folder, with_results=True).split("\n")
    while lines and not lines[-1].strip():
        lines.pop()
    return ["$ odomcalibctl " + " ".join(arguments), *lines]


def picture(lines):
    width, height = COLUMNS * CHARACTER + 2 * MARGIN, len(lines) * LINE + 2 * MARGIN
    rows = "\n".join(f'<text x="{MARGIN}" y="{MARGIN + LINE * (k + 0.75):.0f}" xml:space="preserve">{html.escape(line)}</text>'
                     for k, line in enumerate(lines))
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height}" width="{width:.0f}" height="{height}">\n'
            f'<rect width="100%" height="100%" rx="6" fill="#1d2430"/>\n'
            f'<g fill="#e6e9ee" font-family="\'DejaVu Sans Mono\', Menlo, Consolas, monospace" font-size="13.3">\n{rows}\n</g>\n</svg>\n')


def words(text):
    """The words of a picture: values differ in their last digits from machine to machine."""
    return re.findall(r"[^\W\d_]+", html.unescape(re.sub(r"<[^>]*>", " ", text)))


def main(arguments):
    check = arguments[:1] == ["--check"]
    if len(arguments) - check != 3:
        sys.exit(__doc__)
    program, drive, folder = arguments[check:]
    differs = []
    for name in SHOWN:
        path, drawn = pathlib.Path(folder, f"terminal-{name}.svg"), picture(screen(program, drive, name))
        if not check:
            path.write_text(drawn)
        elif not path.exists() or words(path.read_text()) != words(drawn):
            differs.append(f"{path}: is not what the program prints today")
    print("\n".join(differs))
    return 1 if differs else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
