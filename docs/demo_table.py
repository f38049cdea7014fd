#!/usr/bin/env python3
"""Prints what demo.sh found beside the truth, and the errors before and after.

usage: demo_table.py FOLDER    with the files that demo.sh leaves in build/demo
Exit status 0: accepted, kept by the drive, and every error smaller than before.
"""
import json
import math
import pathlib
import sys


def load(folder, name):
    return json.loads((folder / name).read_text())


def worst(folder, name, key):
    """Largest error of the moves of a drive: m or rad."""
    return max(abs(move["error"][key]) for move in load(folder, name)["moves"])


def print_parameters(calibration, truth, kept):
    print(f"{'':<22}{'papers':>10}{'found':>10}{'+-2 sigma':>11}{'true':>10}{'in the drive':>14}")
    for name, label in (("left_wheel_diameter", "left wheel diameter"),
                        ("right_wheel_diameter", "right wheel diameter"), ("track_width", "track width")):
        found = calibration["parameters"][name]
        print(f"{label:<22}{1e3 * truth['nominal'][name]:10.3f}{1e3 * found['value']:10.3f}{2e3 * found['std']:11.3f}"
              f"{1e3 * truth['true'][name]:10.3f}{1e3 * kept[name]:14.3f}  mm")
    for name, label, factor, unit in (("lidar_x", "lidar x", 1e3, "mm"), ("lidar_y", "lidar y", 1e3, "mm"),
                                      ("lidar_yaw", "lidar yaw", 180.0 / math.pi, "deg")):
        found = calibration["parameters"][name]
        print(f"{label:<22}{factor * truth['nominal'][name]:10.3f}{factor * found['value']:10.3f}"
              f"{2 * factor * found['std']:11.3f}{factor * truth['true'][name]:10.3f}{'':14}  {unit}")


def print_errors(folder):
    """@return whether every error went down"""
    rows = (("a metre: length", "straight", "distance", 1e3, "mm"),
            ("a metre: heading", "straight", "yaw", 180.0 / math.pi, "deg"),
            ("a full turn: heading", "spin", "yaw", 180.0 / math.pi, "deg"))
    better = []
    print(f"\n{'odometry against lidar':<26}{'before':>10}{'after':>10}")
    for label, drive, key, factor, unit in rows:
        before = factor * worst(folder, f"{drive}-before.json", key)
        after = factor * worst(folder, f"{drive}-after.json", key)
        better.append(after < before)
        print(f"{label:<26}{before:10.2f}{after:10.2f}  {unit}")
    return all(better)


def main():
    folder = pathlib.Path(sys.argv[1])
    calibration, truth = load(folder, "calibration.json"), load(folder, "truth.json")
    kept = {p["name"]: p["value"] for p in load(folder, "params-after.json")}
    print_parameters(calibration, truth, kept)
    better = print_errors(folder)
    stored = all(abs(value - calibration["parameters"][name]["value"]) < 1e-6 for name, value in kept.items())
    print(f"\ncalibration {calibration['verdict'].replace('_', ' ')}; the drive {'kept' if stored else 'LOST'} the values; "
          f"odometry is {'better' if better else 'NOT better'} than before")
    return 0 if calibration["verdict"] != "refused" and stored and better else 1


if __name__ == "__main__":
    sys.exit(main())
