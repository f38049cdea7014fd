"""The recordings that vary.py tries other numbers on, each with the command of odomcalibctl that reads it.

They are small, since each is read some hundred times, and of every kind that leads to other numbers: drives with and
without an effect, other references and forms of the wheels' motion, and the mistakes that tests/integration/mistakes_test.cpp
has. Real recordings are those of $ODOMCALIB_SHARED/data (default ../shared).
"""

import dataclasses
import gzip
import json
import math
import os
import pathlib
import random
import subprocess
import typing

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ.get("ODOMCALIB_SHARED", ROOT / ".." / "shared")).resolve() / "data"
SOLVE = "solve {file} --out result"
PAGE = SOLVE + " --report page.html"


@dataclasses.dataclass(frozen=True)
class Trial:
    """A recording, and the command that reads it."""

    made: str  # arguments of odomcalib-sim-record, or a file of the real recordings
    change: typing.Callable = None  # of its lines and the true poses (t, x, y, yaw) to other lines
    command: str = SOLVE  # {file}, {calibration}: of this recording; {file of NAME}, {calibration of NAME}: of another trial's

    def is_simulated(self):
        return self.made.startswith("--")


def file_of(name, bins, folder):
    """The recording of a trial, made in `folder`; None where it would be a real one that is not there."""
    trial = TRIALS[name]
    if trial.is_simulated():
        source, truth = folder / f"{name}.made.jsonl.gz", folder / f"{name}.tum"
        subprocess.run([bins / "odomcalib-sim-record", *trial.made.split(), "--out", source, "--path", truth], check=True, stdout=subprocess.DEVNULL)
    else:
        source, truth = DATA / trial.made, None
        if not source.exists():
            return None
    if trial.change is None:
        return source
    with gzip.open(source, "rt", encoding="utf-8") as text:
        lines = [json.loads(line) for line in text]
    path = [] if truth is None else [true_pose(line) for line in truth.read_text(encoding="utf-8").splitlines()]
    file = folder / f"{name}.jsonl"
    file.write_text("".join(json.dumps(line) + "\n" for line in trial.change(lines, path)), encoding="utf-8")
    return file


def true_pose(line):
    t, x, y, *_, sine, cosine = map(float, line.split())
    return t, x, y, 2.0 * math.atan2(sine, cosine)


# --- What is changed -------------------------------------------------------------------------------------------


def each(kind, change):
    """A change of every line of a type."""
    def changed(lines, _):
        for line in lines:
            if line["type"] == kind:
                change(line)
        return lines

    return changed


def scaled(kind, **factors):
    def change(line):
        for name, factor in factors.items():
            value = line[name]
            line[name] = [each_one and factor * each_one for each_one in value] if isinstance(value, list) else factor * value

    return each(kind, change)


def without(kind, keeps=lambda line: False):
    return lambda lines, _: [line for line in lines if line["type"] != kind or keeps(line)]


def both(first, second):
    return lambda lines, path: second(first(lines, path), path)


def until(seconds):
    return lambda lines, _: [line for line in lines if line.get("t", 0.0) < seconds]


def counted(change):
    """Counts in each interval as they would have been counted."""
    def changed(lines, _):
        left = right = 0
        before = None
        for line in lines:
            if line["type"] == "ticks":
                given = line["left"], line["right"]
                if before:
                    more = change(given[0] - before[0], given[1] - before[1])
                    left, right = left + more[0], right + more[1]
                before = given
                line["left"], line["right"] = left, right
        return lines

    return changed


def per_sample(lines, _):
    before = 0, 0
    for line in lines:
        if line["type"] == "ticks":
            given = line["left"], line["right"]
            line["left"], line["right"] = given[0] - before[0], given[1] - before[1]
            before = given
    return lines


def gyro(scale, noise=0.002):
    """With a gyro that reads `scale` times the true turn; rad/s."""
    def changed(lines, path):
        drawn = random.Random(1)
        for before, after in zip(path, path[1:]):
            rate = math.remainder(after[3] - before[3], 2.0 * math.pi) / (after[0] - before[0])
            lines.append({"type": "gyro", "t": 0.5 * (before[0] + after[0]), "yaw_rate": scale * rate + drawn.gauss(0.0, noise)})
        return lines

    return changed


def poses(every=1, noise=5e-4):
    """The true poses as reference instead of scans."""
    def changed(lines, path):
        drawn = random.Random(3)
        return [line for line in lines if line["type"] != "scan"] + [
            {"type": "pose", "t": t, "x": x + drawn.gauss(0.0, noise), "y": y + drawn.gauss(0.0, noise), "yaw": yaw + drawn.gauss(0.0, noise)}
            for t, x, y, yaw in path[::every]]

    return changed


def odometry(unit=1.0, turned=0.0):
    """The pose that nominal values make of the counts instead of the counts; its frame is turned by so many rad."""
    def changed(lines, _):
        robot = lines[0]
        by_count = math.pi * robot["wheel_diameter"] / robot["ticks_per_rev"]
        x = y = yaw = 0.0
        before = None
        for line in lines:
            if line["type"] != "ticks":
                continue
            left, right = line.pop("left"), line.pop("right")
            if before:
                ways = by_count * (left - before[0]), by_count * (right - before[1])
                turn = (ways[1] - ways[0]) / robot["track_width"]
                way = 0.5 * (ways[0] + ways[1])
                x, y, yaw = x + way * math.cos(yaw + 0.5 * turn), y + way * math.sin(yaw + 0.5 * turn), yaw + turn
            before = left, right
            line.update(type="odometry", x=unit * x, y=unit * y, yaw=math.remainder(yaw + turned, 2.0 * math.pi))
        return lines

    return changed


def late_stamps(lines, _):
    """Counts that were read evenly, and stamped when their message came."""
    drawn = random.Random(7)
    last = 0.0
    for line in lines:
        if line["type"] == "ticks":
            last = line["t"] = max(last + 1e-4, line["t"] + abs(drawn.gauss(0.0, 0.01)) + (0.06 if drawn.random() < 0.01 else 0.0))
    return lines


def in_parts(parts):
    """Turns of the lidar that come in several messages."""
    def changed(lines, _):
        for line in lines:
            if line["type"] != "scan":
                yield line
                continue
            count = len(line["ranges"]) // parts
            for part in range(parts):
                yield {"type": "scan", "t": line["t"] + part * count * line["time_increment"],
                       "angle_min": line["angle_min"] + part * count * line["angle_increment"],
                       **{name: line[name] for name in ("angle_increment", "time_increment", "range_min", "range_max")},
                       "ranges": line["ranges"][part * count:(part + 1) * count]}

    return changed


def no_return_is(metres):
    """A lidar that sees no farther, and writes a number where nothing came back."""
    return each("scan", lambda scan: scan.update(ranges=[metres if not r or r > metres else r for r in scan["ranges"]]))


def short_sighted(metres):
    return each("scan", lambda scan: scan.update(ranges=[r if r and r < metres else None for r in scan["ranges"]]))


def fading(share, seconds):
    """A lidar whose metre is too long by a share that fades with this time constant."""
    def change(scan):
        factor = 1.0 + share * math.exp(-scan["t"] / seconds)
        scan["ranges"] = [r and factor * r for r in scan["ranges"]]

    return each("scan", change)


def slips(begin, end, count):
    """The left wheel slips in some tenths of a second: by 400 counts each."""
    def changed(lines, _):
        drawn = random.Random(9)
        slipping = {int(10.0 * drawn.uniform(begin, end)) for _ in range(count)}
        more = 0
        for line in lines:
            if line["type"] == "ticks":
                if int(10.0 * line["t"]) in slipping:
                    slipping.discard(int(10.0 * line["t"]))
                    more += 400
                line["left"] += more
        return lines

    return changed


def pair_of_scans(first, second, guess):
    """Two scans as a pair to match, by their numbers."""
    def changed(lines, _):
        scans = [line for line in lines if line.pop("type") == "scan"]
        return [{"reference": scans[first], "scan": scans[second], "guess": guess}]

    return changed


# --- The trials ------------------------------------------------------------------------------------------------

GUIDED = "--room furnished --drive guided --seed 5100 --beams 120"
SHORT = "--room furnished --drive random --duration 60 --seed 5110 --beams 90"
TRIALS = {
    # Drives with and without an effect, named, flagged and of the lidar.
    "furnished": Trial(GUIDED),
    "gear_play": Trial("--effect gear_play --seed 5104 --beams 120"),
    "count_queue": Trial("--effect count_queue --seed 5107 --beams 120"),
    "cover_glass": Trial("--effect cover_glass --seed 5106 --beams 120"),
    "random": Trial("--room random --drive random --seed 5102 --beams 120"),
    "loose_wheel": Trial("--effect loose_wheel --seed 5105 --beams 120"),
    "corridor": Trial("--room corridor --drive guided --seed 5101 --beams 120"),
    "rest": Trial("--room furnished --drive rest --seed 5103 --beams 120"),
    "rug": Trial("--effect rug --drive random --duration 120 --seed 5142 --beams 90"),
    "mast_flex": Trial("--effect mast_flex --room furnished --drive random --duration 120 --seed 5144 --beams 90"),
    "short_gear_play": Trial("--effect gear_play --room furnished --drive random --duration 60 --seed 5131 --beams 90"),
    "short_traction_slip": Trial("--effect traction_slip --room furnished --drive random --duration 60 --seed 5134 --beams 90"),
    "fading_metre": Trial("--room furnished --drive random --duration 120 --seed 5142 --beams 90", fading(0.05, 30.0)),
    "slips": Trial(SHORT, slips(10.0, 50.0, 25), PAGE),
    "two_robots": Trial("--room furnished --drive random --duration 120 --seed 5118 --beams 90",
                        command="solve {file of short} {file} --same-robot --out result"),
    # Other references and other forms of the wheels' motion.
    "short": Trial(SHORT, command=PAGE),
    "gyro": Trial(SHORT, both(short_sighted(4.0), gyro(1.02))),
    "gyro_reversed": Trial(SHORT, gyro(-1.02)),
    "gyro_tripled": Trial(SHORT, gyro(3.0)),
    "gyro_over_gaps": Trial(SHORT, both(without("scan", lambda line: line["t"] % 20.0 < 14.0), gyro(1.02))),
    "poses": Trial(SHORT, poses()),
    "few_poses": Trial(SHORT, both(poses(every=100), until(5.0))),
    "straight": Trial(GUIDED, until(8.0)),
    "odometry": Trial(SHORT, odometry()),
    "odometry_in_mm": Trial(SHORT, odometry(unit=1e3)),
    "odometry_in_feet": Trial(SHORT, odometry(unit=1.0 / 0.3048)),
    "odometry_turned": Trial(SHORT, odometry(turned=0.2)),
    "late_stamps": Trial(SHORT, late_stamps),
    "in_parts": Trial(SHORT, in_parts(3)),
    "khepera": Trial("khepera-censi/l90.tuple"),
    "optiodom": Trial("optiodom/jun2020-square-230620202042-01.jsonl.gz"),
    # Mistakes.
    "no_return_is_4_m": Trial(SHORT, no_return_is(4.0)),
    "ranges_in_mm": Trial(SHORT, scaled("scan", range_min=1e3, range_max=1e3, ranges=1e3)),
    "angles_in_degrees": Trial(SHORT, scaled("scan", angle_min=57.3, angle_increment=57.3)),
    "angles_half_as_wide": Trial(SHORT, scaled("scan", angle_min=0.5, angle_increment=0.5)),
    "scan_clock_too_fast": Trial(SHORT, scaled("scan", t=0.8, time_increment=0.8)),
    "counts_of_the_motor": Trial(SHORT, scaled("robot", ticks_per_rev=1.0 / 20.0)),
    "left_counts_twice": Trial(SHORT, counted(lambda left, right: (2 * left, right))),
    "left_counts_backwards": Trial(SHORT, counted(lambda left, right: (-left, right))),
    "counts_without_direction": Trial(SHORT, counted(lambda left, right: (abs(left), abs(right)))),
    "one_encoder_twice": Trial(SHORT, counted(lambda left, right: (left, left))),
    "counts_per_sample": Trial(SHORT, per_sample),
    # Other commands.
    "predict": Trial(SHORT, command="predict {file} --robot-id simulated-5104 --calibration {calibration of gear_play} --trajectory result"),
    "predict_live": Trial(SHORT, command="predict {file} --robot-id simulated-5104 --calibration {calibration of gear_play} --live --trajectory result"),
    "compare": Trial("--room furnished --drive random --seed 5100 --beams 120", command="compare {calibration of furnished} {calibration} --csv result"),
    "match": Trial(SHORT, pair_of_scans(0, 60, [0.3, 0.2, 0.3]), "match {file}"),
    "match_near": Trial(SHORT, pair_of_scans(0, 1, [0.0, 0.0, 0.0]), "match {file}"),
    "match_brute": Trial(SHORT, pair_of_scans(0, 20, [0.0, 0.0, 0.0]), "match {file} --matcher brute"),
    "match_fast": Trial(SHORT, pair_of_scans(0, 20, [0.0, 0.0, 0.0]), "match {file} --matcher fast"),
    "graph_build": Trial("--room furnished --drive guided --duration 140 --seed 5150 --beams 180", command="graph build {file} --out result"),
    "graph_build_far": Trial("--room workshop --drive random --duration 140 --seed 5152 --beams 360", command="graph build {file} --out result"),
    "graph_of_killian": Trial("posegraph/killian.g2o.gz", command="graph optimize {file} --out result"),
    "graph_from_far": Trial("posegraph/killian.g2o.gz", command="graph optimize {file} --start file --iterations 30 --out result"),
    "graph_of_intel": Trial("posegraph/intel.g2o.gz", command="graph optimize {file} --method levenberg-marquardt --out result"),
    "graph_info": Trial("posegraph/intel.g2o.gz", command="graph info {file}"),
}
