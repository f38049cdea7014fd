#!/usr/bin/env python3
"""Prints the estimates of demo.sh beside the truth, and the errors before and after.

usage: demo_table.py --self-test
       demo_table.py FOLDER                             with the files that demo.sh leaves in build/demo
       demo_table.py --without-effects IN.json OUT.json  a calibration file stripped of its effects
Exit status 0: accepted, kept by the drive, and odometry better in more figures than worse.
"""
import json
import math
import pathlib
import sys

DEGREES = 180.0 / math.pi
# A difference below this is none: the noise floor of the figures in the report of this robot, rounded up.
NO_MATTER = {"mm": 0.5, "deg": 0.1}


def load(folder, name):
    return json.loads((folder / name).read_text())


def spread(value):
    """Two standard deviations; empty for a shape parameter that was selected from a few values instead of fitted."""
    return f" +- {2 * value['std']:.2g}" if value["std"] else ""


def print_parameters(calibration, truth, kept):
    print(f"{'':<22}{'nominal':>10}{'estimate':>10}{'+-2 sigma':>11}{'true':>10}{'in drive':>12}")
    for name, label in (("left_wheel_diameter", "left wheel diameter"),
                        ("right_wheel_diameter", "right wheel diameter"), ("track_width", "track width")):
        found = calibration["parameters"][name]
        print(f"{label:<22}{1e3 * truth['nominal'][name]:10.3f}{1e3 * found['value']:10.3f}{2e3 * found['std']:11.3f}"
              f"{1e3 * truth['true'][name]:10.3f}{1e3 * kept[name]:12.3f}  mm")
    for name, label, factor, unit in (("lidar_x", "lidar x", 1e3, "mm"), ("lidar_y", "lidar y", 1e3, "mm"),
                                      ("lidar_yaw", "lidar yaw", DEGREES, "deg")):
        found = calibration["parameters"][name]
        print(f"{label:<22}{factor * truth['nominal'][name]:10.3f}{factor * found['value']:10.3f}"
              f"{2 * factor * found['std']:11.3f}{factor * truth['true'][name]:10.3f}{'':12}  {unit}")


def print_defect(calibration, truth):
    true = truth.get("effect")
    print("\neffects beyond two round wheels")
    if true:
        name = f"in the catalogue: {true['catalogue_name']}" if true["catalogue_name"] else "in no catalogue"
        print(f"  true       {true['name']} ({name}), {true['size']:.4g} {true['unit']}, "
              f"depends on {', '.join(true['depends_on'])}")
    else:
        print("  true       none")
    found = 0
    for effect in calibration["effects"]:
        values = ", ".join(f"{name} {value['value']:.4g}{spread(value)} {value['unit']}"
                           for name, value in effect["parameters"].items() if value["value"] or value["std"])
        others = f"; cannot be separated from {', '.join(effect['aliases'])}" if effect["aliases"] else ""
        print(f"  estimated  {effect['name']}: {values}{others}")
        found += 1
    rest = calibration["unexplained"]
    if rest:
        print(f"  estimated  a defect without a name: the residual depends on {', '.join(rest['depends_on'])}")
        found += 1
    if not found:
        print("  estimated  none")


def relative(a, b):
    """Pose b seen from a; both [x, y, yaw]."""
    c, s = math.cos(a[2]), math.sin(a[2])
    dx, dy = b[0] - a[0], b[1] - a[1]
    return [c * dx + s * dy, -s * dx + c * dy, b[2] - a[2]]


def end_of(folder, drive, kind):
    fields = [float(f) for f in (folder / f"fresh-{drive}.{kind}.tum").read_text().split("\n")[-2].split()]
    return [fields[1], fields[2], 2.0 * math.atan2(fields[6], fields[7])]


def fresh_errors(folder, drive):
    """Position (m) and heading (rad) error at the end of a drive, by model."""
    begin, end = load(folder, f"fresh-{drive}.begin"), load(folder, f"fresh-{drive}.end")
    true = relative(begin, end)
    errors = {}
    for kind in ("nominal", "geometry", "calibration"):
        told = end_of(folder, drive, kind)
        errors[kind] = (math.hypot(told[0] - true[0], told[1] - true[1]),
                        abs(math.remainder(told[2] - true[2], 2.0 * math.pi)))
    return errors


def worst(folder, name, key):
    """Largest error of the moves of a drive against the lidar: m or rad."""
    return max(abs(move["error"][key]) for move in load(folder, name)["moves"])


def against_lidar(folder):
    """Rows of the table: label, unit, before, after."""
    rows = (("a metre: length", "straight", "distance", 1e3, "mm"),
            ("a metre: heading", "straight", "yaw", DEGREES, "deg"),
            ("a full turn: heading", "spin", "yaw", DEGREES, "deg"))
    return [(label, unit, factor * worst(folder, f"{drive}-before.json", key), factor * worst(folder, f"fresh-{drive}.json", key))
            for label, drive, key, factor, unit in rows]


def against_truth(folder):
    """Rows of the table: label, unit, nominal, without effects, corrected."""
    rows = []
    for drive, label in (("straight", "a metre out and back"), ("turns", "two turns left")):
        errors = fresh_errors(folder, drive)
        for index, factor, unit, what in ((0, 1e3, "mm", "position"), (1, DEGREES, "deg", "heading")):
            rows.append((f"{label}: {what}", unit, *(factor * errors[kind][index]
                                                     for kind in ("nominal", "geometry", "calibration"))))
    return rows


def print_errors(folder):
    """@return (label, unit, before, after) of every row"""
    lidar, truth = against_lidar(folder), against_truth(folder)
    print(f"\n{'odometry against lidar':<34}{'before':>10}{'after':>10}")
    for label, unit, before, after in lidar:
        print(f"{label:<34}{before:10.2f}{after:10.2f}  {unit}")
    print(f"\n{'end of a fresh drive, truth':<34}{'nominal':>10}{'no effects':>12}{'corrected':>11}")
    for label, unit, nominal, geometry, corrected in truth:
        print(f"{label:<34}{nominal:10.2f}{geometry:12.2f}{corrected:11.2f}  {unit}")
    return lidar + [(label, unit, nominal, corrected) for label, unit, nominal, _, corrected in truth]


def odometry_verdict(rows):
    """In words, and whether more figures are better than worse. A drive out and back hides a wrong scale by itself: what comes out
    right before, for that reason alone, may come out worse, and that is said."""
    better = [row for row in rows if row[3] < row[2] - NO_MATTER[row[1]]]
    worse = [row for row in rows if row[3] > row[2] + NO_MATTER[row[1]]]
    text = f"odometry is better than before in {len(better)} of {len(rows)} figures"
    if worse:
        text += ", worse in " + ", ".join(f"{label} ({before:.2f} -> {after:.2f} {unit})" for label, unit, before, after in worse)
    return text, len(better) > len(worse)


def strip_effects(source, target):
    calibration = json.loads(pathlib.Path(source).read_text())
    calibration["effects"], calibration["unexplained"] = [], None
    calibration.pop("unexplained_model", None)
    pathlib.Path(target).write_text(json.dumps(calibration))


def self_test():
    """The last line speaks of all figures."""
    turn, back = ("a full turn", "deg", 17.79, 1.34), ("out and back", "mm", 0.18, 4.58)
    cases = (([turn, back], "better than before in 1 of 2 figures, worse in out and back (0.18 -> 4.58 mm)", False),
             ([turn, turn, back], "better than before in 2 of 3 figures, worse in out and back (0.18 -> 4.58 mm)", True),
             ([turn, ("out and back", "mm", 0.18, 0.60)], "better than before in 1 of 2 figures", True),
             ([("a full turn", "deg", 0.01, 0.02)], "better than before in 0 of 1 figures", False))
    wrong = [(rows, odometry_verdict(rows)) for rows, said, better in cases
             if odometry_verdict(rows) != ("odometry is " + said, better)]
    for case in wrong:
        print(*case)
    return 1 if wrong else 0


def main():
    if sys.argv[1] == "--self-test":
        return self_test()
    if sys.argv[1] == "--without-effects":
        strip_effects(sys.argv[2], sys.argv[3])
        return 0
    folder = pathlib.Path(sys.argv[1])
    calibration, truth = load(folder, "calibration.json"), load(folder, "truth.json")
    names = ("left_wheel_diameter", "right_wheel_diameter", "track_width")
    kept = {p["name"]: p["value"] for p in load(folder, "params-after.json")["parameters"] if p["name"] in names}
    print_parameters(calibration, truth, kept)
    print_defect(calibration, truth)
    said, better = odometry_verdict(print_errors(folder))
    stored = all(abs(value - calibration["parameters"][name]["value"]) < 1e-6 for name, value in kept.items())
    print(f"\nseed {truth['seed']}: calibration {calibration['verdict'].replace('_', ' ')}; "
          f"the drive {'kept' if stored else 'LOST'} the values; {said}")
    return 0 if calibration["verdict"] != "refused" and stored and better else 1


if __name__ == "__main__":
    sys.exit(main())
