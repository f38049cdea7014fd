#!/usr/bin/env python3
"""The installed library: what it needs and shows, and programs outside of the tree that use it.

Usage: library_test.py WHAT SOURCE BUILD PREFIX WORK
WHAT: needs (libraries and symbols), abi (types and functions that programs were compiled for), consumer (a CMake project in C and C++, pkg-config), python, step (odometry as source),
docs (the script of the page for users), ros (the node for ROS 1), lcm
"""

import contextlib
import gzip
import json
import math
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import time

SOURCE, BUILD, PREFIX, WORK = (pathlib.Path(part) for part in sys.argv[2:6])
CTL, RECORD = BUILD / "bin/odomcalibctl", BUILD / "bin/odomcalib-sim-record"
# The C++ runtime, and the C library with its loader.
RUNTIME = re.compile(r"^(libstdc\+\+|libm|libgcc_s|libc|ld-linux[\w-]*)\.so\.\d+$")


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def check(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


def installed():
    """The folder that stands for the prefix, freshly filled."""
    stage = WORK / "stage"
    shutil.rmtree(stage, ignore_errors=True)
    for component in ("library", "development", "python"):
        run("cmake", "--install", BUILD, "--component", component, env={**os.environ, "DESTDIR": str(stage)})
    return stage / PREFIX.relative_to("/")


def library_in(root):
    found = sorted(root.glob("lib/**/libodomcalib.so.0"))
    check(len(found) == 1, f"one libodomcalib.so.0 below {root}")
    return found[0]


def drive():
    """A simulated recording, its counts, and a calibration with an effect."""
    recording, calibration = WORK / "drive.jsonl.gz", WORK / "cal.json"
    run(RECORD, "--room", "furnished", "--drive", "lazy", "--seed", "7", "--out", recording)
    robot, ticks = None, []
    with gzip.open(recording, "rt") as lines:
        for line in map(json.loads, lines):
            if line["type"] == "robot":
                robot = line
            if line["type"] == "ticks":
                ticks.append((line["t"], line["left"], line["right"]))
    names = ["left_wheel_diameter", "right_wheel_diameter", "track_width", "lidar_x", "lidar_y", "lidar_yaw"]
    diameter = robot.get("wheel_diameter") or robot["left_wheel_diameter"]
    values = [1.003 * diameter, 0.998 * diameter, 1.01 * robot["track_width"], 0.1, 0.0, 0.02]
    parameters = {name: {"value": value, "std": 1e-4, "unit": "rad" if name == "lidar_yaw" else "m"}
                  for name, value in zip(names, values)}
    matrix = [[1e-8 if row == column else 0.0 for column in range(6)] for row in range(6)]
    backlash = {name: {"value": value, "std": 1e-4, "unit": "rad"}
                for name, value in (("left_play", 0.02), ("right_play", 0.03), ("spread", 0.0))}
    noise = {axis: {"value": 0.002, "unit": "m/sqrt(m)"} for axis in ("forward", "sideways", "yaw")}
    calibration.write_text(json.dumps({
        "format": "odomcalib-calibration/1", "verdict": "accepted", "reasons": [],
        "robot": {"left_wheel_diameter": diameter, "right_wheel_diameter": diameter, "track_width": robot["track_width"],
                  "ticks_per_rev": robot["ticks_per_rev"]},
        "parameters": parameters, "covariance": {"order": names, "matrix": matrix}, "contact_noise": noise,
        "effects": [{"name": "backlash", "parameters": backlash, "aliases": [], "stored_in": "host",
                     "evidence": {"p_value": 0.001, "held_out_before": 0.01, "held_out_after": 0.005}}]}))
    return recording, ticks, calibration


def predicted(recording, calibration, *options):
    """(t, x, y, sine, cosine of half the yaw) as the program has them."""
    trajectory = WORK / "predicted.tum"
    run(CTL, "predict", recording, "--calibration", calibration, "--trajectory", trajectory, *options)
    rows = [[float(word) for word in line.split()] for line in trajectory.read_text().splitlines()]
    return [(row[0], row[1], row[2]) for row in rows]


def check_path(path, expected, what):
    """The trajectory file has nine decimals."""
    check(len(path) == len(expected) > 100, f"{what}: {len(path)} poses of {len(expected)}")
    worst = max(max(abs(a[1] - b[1]), abs(a[2] - b[2])) for a, b in zip(path, expected))
    check(worst < 6e-10, f"{what}: off by {worst} m")
    check(max(abs(pose[1]) for pose in path) > 0.1, f"{what}: the robot moves")


def as_lines(ticks):
    return "".join(f"{t!r} {left} {right}\n" for t, left, right in ticks)


def test_needs():
    library = library_in(installed())
    dynamic = run("readelf", "--dynamic", "--wide", library)
    needed = re.findall(r"\(NEEDED\).*\[(.+)\]", dynamic)
    others = [name for name in needed if not RUNTIME.match(name)]
    check(needed and not others, f"it needs nothing but the C++ runtime: {others or needed}")
    check("[libodomcalib.so.0]" in dynamic, "its soname has the version of its interface")
    shown = {line.split()[-1].split("@")[0] for line in run("nm", "--dynamic", "--defined-only", library).splitlines()}
    header = (SOURCE / "calib/library/include/odomcalib/odometry.h").read_text()
    declared = set(re.findall(r"\b(odomcalib_\w+)\(", header.split("typedef struct odomcalib_odometry", 1)[1]))
    symbols = (SOURCE / "debian/libodomcalib0.symbols").read_text()
    listed = set(re.findall(r"^ (odomcalib_\w+)@", symbols, re.M))
    check(listed == declared, f"the package's symbols are those: {listed ^ declared}")
    check(shown - {"ODOMCALIB_0"} == declared, f"it shows what the header declares: {shown ^ declared}")


def abi_of(library):
    """What programs see of a library, as text: functions and types of the C interface, without places in the source."""
    text = run("abidw", "--no-corpus-path", "--no-comp-dir-path", "--exported-interfaces-only", "--drop-private-types",
               "--headers-dir", SOURCE / "calib/library/include", library)
    return re.sub(r" (filepath|path|line|column)='[^']*'", "", text)


def abi_changes(before, after):
    """What abidiff has against a library in place of another, but for functions that are new; empty where it has nothing."""
    done = subprocess.run(["abidiff", "--no-added-syms", before, after], capture_output=True, text=True, check=False)
    return done.stdout + done.stderr if done.returncode != 0 else ""


def test_abi():
    """Programs that were linked with a library of this soname run with this one."""
    library, baseline = library_in(installed()), SOURCE / "debian/libodomcalib0.abi"
    now = WORK / "now.abi"
    now.write_text(abi_of(library))
    check(not abi_changes(baseline, now), "programs that were built before still run; a change that they do not survive needs a new soname, "
          f"a new function a new {baseline.name} (a copy of {now}):\n{abi_changes(baseline, now)}")
    # The comparison sees what it is there for.
    text = now.read_text()
    for what, pattern, other in (("a member that moves", "layout-offset-in-bits='64'", "layout-offset-in-bits='32'"),
                                 ("a structure of another size", "size-in-bits='192' is-struct", "size-in-bits='256' is-struct"),
                                 ("a function that goes", "odomcalib_odometry_stamp", "odomcalib_odometry_time")):
        check(pattern in text, f"{what} is looked for in what is there")
        changed = WORK / "changed.abi"
        changed.write_text(text.replace(pattern, other))
        check(abi_changes(now, changed), f"{what} is noticed")


def test_consumer():
    root = installed()
    recording, ticks, calibration = drive()
    build = WORK / "consumer"
    shutil.rmtree(build, ignore_errors=True)
    run("cmake", "-S", SOURCE / "tests/library/consumer", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={root}",
        f"-DEXAMPLES={SOURCE / 'examples'}", f"-DLCM_TYPES={BUILD / 'proto/lcm'}")
    run("cmake", "--build", build, "--parallel", "1")
    lines, expected = as_lines(ticks), predicted(recording, calibration, "--live")
    path = [tuple(map(float, line.split())) for line in run(build / "control_loop", calibration, input=lines).splitlines()]
    check_path(path, expected, "the loop in C")
    x, y, _ = map(float, run(build / "in_cpp", calibration, input=lines).split())
    check_path(path[:-1] + [(0.0, x, y)], expected, "the program in C++")
    wrong = subprocess.run([build / "control_loop", WORK / "absent.json"], capture_output=True, text=True, check=False)
    check(wrong.returncode == 1 and "cannot be read" in wrong.stderr, "a file that is missing is said")

    environment = {**os.environ, "PKG_CONFIG_PATH": str(next(root.glob("lib/**/pkgconfig"))),
                   "PKG_CONFIG_SYSROOT_DIR": str(WORK / "stage")}
    flags = run("pkg-config", "--cflags", "--libs", "odomcalib", env=environment).split()
    program = WORK / "by_pkg_config"
    run("cc", "-std=c11", SOURCE / "examples/control_loop.c", *flags, "-o", program)
    by_pkg_config = run(program, calibration, input=lines, env={**os.environ, "LD_LIBRARY_PATH": str(library_in(root).parent)})
    check(by_pkg_config.count("\n") == len(ticks), "pkg-config's flags make a program")


def test_python():
    root = installed()
    recording, ticks, calibration = drive()
    os.environ["ODOMCALIB_LIBRARY"] = str(library_in(root).parent)
    sys.path.insert(0, str(next(root.glob("lib/python3*/dist-packages"))))
    import odomcalib  # pylint: disable=import-outside-toplevel

    with odomcalib.Odometry(calibration) as odometry:
        path, variances = [], set()
        for stamp, left, right in ticks:
            odometry.update_counts(stamp, left, right)
            path.append((stamp, *odometry.pose))
            variances.add(odometry.velocity_covariance[8])
        check_path(path, predicted(recording, calibration, "--live"), "sample by sample")
        at_once = odometry.path(*zip(*ticks))
        check_path([(0.0, x, y) for x, y, _ in at_once], predicted(recording, calibration), "at once")
        check(odometry.covariance[0] > 0.0 and max(variances) > 0.0, "covariances")
        check(odometry.lidar_pose == (0.1, 0.0, 0.02), "the lidar pose")
        check([effect.place for effect in odometry.effects] == ["pose"] * 3, "the effects")
        check(odometry.corrected_beams([0.5], [2.0]) == ([0.5], [2.0]), "a lidar without errors")
        with contextlib.suppress(odomcalib.OdometryError):
            odometry.update_counts(ticks[-1][0], 0, 0)
            check(False, "a stamp that is not later raises")
        check(odometry.stamp == ticks[-1][0], "the stamp")
        odometry.pose = (1.0, 2.0, 0.5)
        check(math.dist(odometry.pose, (1.0, 2.0, 0.5)) < 1e-12 and odometry.covariance == (0.0,) * 9, "a pose that is set")
    try:
        odomcalib.Odometry("/nowhere.json")
        check(False, "a file that is missing raises")
    except odomcalib.OdometryError as error:
        check(error.status == "CANNOT_READ" and "/nowhere.json" in str(error), "and says which")
    check(re.match(r"\d+\.\d+\.\d+$", odomcalib.version()), "the version")


EFFECTS = [
    ("time_offset", {"offset": 0.02, "smoothing": 0.001}), ("encoder_lag", {"left_less_right": 0.005}),
    ("wheel_eccentricity", {"left_cos": 0.004, "left_sin": -0.003}),
    ("wheel_eccentricity", {"right_cos": 0.002, "right_sin": 0.005}),
    ("tick_loss", {"left_kappa": 0.01, "right_kappa": -0.01, "threshold": 0.2, "width": 0.03}),
    ("backlash", {"left_play": 0.05, "right_play": -0.06, "spread": 0.0}),
    ("backlash", {"left_play": 0.05, "right_play": 0.06, "spread": 0.05}),
    ("direction_dependent_diameter", {"left_kappa": 0.005, "right_kappa": -0.004}),
    ("speed_dependent_radius", {"kappa": 0.01, "half_speed": 0.0}), ("speed_dependent_radius", {"kappa": 0.02, "half_speed": 0.2}),
    ("acceleration_slip", {"k": 0.02, "side": 0.0}), ("acceleration_slip", {"k": 0.02, "side": -1.0}),
    ("lateral_slip", {"k": 0.01, "k_tyre": 0.05, "relaxation": 0.0}), ("lateral_slip", {"k": 0.01, "k_tyre": 0.05, "relaxation": 0.07}),
    ("speed_dependent_track", {"kappa": 0.01}), ("track_depends_on_motion", {"kappa": 0.02, "arm": 0.5}),
    ("turn_direction_asymmetry", {"kappa": 0.01}),
    ("caster_kick", {"kappa": 0.02, "kappa_turn": 0.01, "kappa_side": 0.01, "length": 0.08, "order": 1.0, "lean": 0.0}),
    ("caster_kick", {"kappa": 0.02, "kappa_turn": 0.0, "kappa_side": 0.0, "length": 0.057, "order": 0.0, "lean": 0.002}),
    ("stop_settling", {"turn": 0.005, "way": 0.005, "lasting": 0.0, "speed": 0.0}),
    ("stop_settling", {"turn": 0.005, "way": 0.005, "lasting": 1.0, "speed": 0.3}),
    ("drift_with_time", {"common": 0.001, "differential": 0.002, "time_constant": 40.0}),
    ("carpet", {"p_x": 0.01, "p_y": 0.01}),
]

PROGRAM = r"""
#include "step.h"
#include <inttypes.h>
#include <stdio.h>
int main(void) {
  odomcalib_state state;
  odomcalib_begin(&state);
  double stamp, motion[3];
  int64_t left, right;
  int anew;
  while (scanf("%lf %" SCNd64 " %" SCNd64 " %d", &stamp, &left, &right, &anew) == 4) {
    if (anew) odomcalib_restart(&state);
    odomcalib_step(&state, stamp, left, right, motion);
    printf("%.17g %.17g %.17g\n", motion[0], motion[1], motion[2]);
  }
  return 0;
}
"""


def between(before, after):
    c, s = math.cos(before[2]), math.sin(before[2])
    dx, dy = after[0] - before[0], after[1] - before[1]
    return c * dx + s * dy, c * dy - s * dx, math.remainder(after[2] - before[2], 2.0 * math.pi)


def motions_of_library(odomcalib, calibration, samples):
    motions, pose = [], (0.0, 0.0, 0.0)
    with odomcalib.Odometry(calibration) as odometry:
        for stamp, left, right, anew in samples:
            if anew:
                odometry.restart()
            with contextlib.suppress(odomcalib.OdometryError):
                odometry.update_counts(stamp, left, right)
            motions.append(between(pose, odometry.pose))
            pose = odometry.pose
    return motions


def motions_in_c(calibration, samples):
    run(CTL, "export", calibration, "--what", "c_header", "--out", WORK / "step.h")
    (WORK / "step.c").write_text(PROGRAM)
    program = WORK / "step"
    run("cc", "-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", WORK / "step.c",
        "-lm", "-o", program)
    lines = "".join(f"{t!r} {left} {right} {int(anew)}\n" for t, left, right, anew in samples)
    return [tuple(map(float, line.split())) for line in run(program, input=lines).splitlines()]


def motions_in_python(calibration, samples):
    run(CTL, "export", calibration, "--what", "python", "--out", WORK / "step.py")
    source = {}
    exec(compile((WORK / "step.py").read_text(), "step.py", "exec"), source)  # pylint: disable=exec-used
    drive_, motions = source["Drive"](), []
    for stamp, left, right, anew in samples:
        if anew:
            drive_.restart()
        motions.append(drive_.step(stamp, left, right) or (0.0, 0.0, 0.0))
    return motions


def test_step():
    """Odometry as one file of source moves as the library does, with each effect and with all."""
    root = installed()
    os.environ["ODOMCALIB_LIBRARY"] = str(library_in(root).parent)
    sys.path.insert(0, str(next(root.glob("lib/python3*/dist-packages"))))
    import odomcalib  # pylint: disable=import-outside-toplevel

    _, ticks, calibration = drive()
    # A counter that was reset, and a stamp that comes twice.
    samples = [(t, left - (90000 if k >= 1500 else 0), right, k == 1500) for k, (t, left, right) in enumerate(ticks)]
    samples.insert(800, samples[799])
    plain = json.loads(calibration.read_text())
    plain["data"] = [{"file": "drive", "begin": ticks[0][0] - 20.0, "duration": 60.0}]
    evidence = {"p_value": 0.001, "held_out_before": 0.01, "held_out_after": 0.005}
    named = [{"name": name, "aliases": [], "stored_in": "host", "evidence": evidence,
              "parameters": {key: {"value": value, "std": None, "unit": "1"} for key, value in values.items()}}
             for name, values in EFFECTS]
    nothing = motions_of_library(odomcalib, calibration, samples[:1])
    check(nothing == [(0.0, 0.0, 0.0)], "the first sample is no motion")
    # One of a name, but for the two wheels.
    all_together = list({(one["name"], *one["parameters"])[:2]: one for one in named}.values())
    for effects in [[]] + [[one] for one in named] + [all_together]:
        calibration.write_text(json.dumps({**plain, "effects": effects}))
        expected = motions_of_library(odomcalib, calibration, samples)
        for motions, language in ((motions_in_c(calibration, samples), "C"), (motions_in_python(calibration, samples), "Python")):
            check(len(motions) == len(expected), f"as many motions in {language}")
            worst = max(abs(a - b) for one, other in zip(motions, expected) for a, b in zip(one, other))
            check(worst < 1e-12, f"{language} with {[one['name'] for one in effects]}: off by {worst}")
    held = run(CTL, "export", calibration, "--what", "c_header").split("#ifndef")[0]
    check("not held here" not in held, "nothing that moves the base is missing")
    curve = {"variable": "speed", "carrier": "both_travel", "low": -1.0, "high": 1.0, "coefficients": [0.001] * 6}
    bounds = {name: {"value": value, "interval": [0.0, 1.0]} for name, value in (("geometry", 0.06), ("after", 0.001))}
    turn = {"name": "full_turn_heading", "unit": "rad", "stretches": 9, "before": None, "noise_floor": None, **bounds}
    calibration.write_text(json.dumps({**plain, "curves": [curve], "drive_errors": [turn], "effects": named[5:6]}))
    for what, expected in (("python", "libodomcalib applies them"), ("diff_drive", "the exports c_header and python")):
        said = run(CTL, "export", calibration, "--what", what)
        check("errs by 3.4 degrees a turn, with them by 0.057 degrees a turn" in said and expected in said, f"{what} says what remains")


def test_docs():
    """The script of the page for users draws two paths."""
    root = installed()
    recording, _, calibration = drive()
    page = (SOURCE / "docs/user/library.md").read_text()
    (WORK / "paths.py").write_text(page.split("```python\n")[1].split("```")[0])
    environment = {**os.environ, "ODOMCALIB_LIBRARY": str(library_in(root).parent),
                   "PYTHONPATH": str(next(root.glob("lib/python3*/dist-packages")))}
    run(sys.executable, "paths.py", recording.name, calibration.name, cwd=WORK, env=environment)
    drawn = [line.split() for line in re.findall(r'points="([^"]+)"', (WORK / "paths.svg").read_text())]
    check(len(drawn) == 2 and len(drawn[0]) == len(drawn[1]) > 100 and drawn[0] != drawn[1], "two paths that differ")


def in_own_network():
    """Goes on in a network of its own, with multicast."""
    if os.environ.get("ODOMCALIB_OWN_NETWORK") is None:
        os.execvpe("unshare", ["unshare", "--net", "--map-root-user", sys.executable, *sys.argv],
                   {**os.environ, "ODOMCALIB_OWN_NETWORK": "1"})
    for command in ("link set lo up", "link set lo multicast on", "route add 224.0.0.0/4 dev lo"):
        run("ip", *command.split())


def test_ros():
    """The node for ROS 1 with a real master, and a bag that rosbag plays and another that it records."""
    packages = "roscpp nav_msgs sensor_msgs tf2_ros".split()
    if shutil.which("roscore") is None or subprocess.run(["pkg-config", "--exists", *packages], check=False).returncode != 0:
        print("ROS 1 IS ABSENT: install ros-core, python3-rosbag, libroscpp-dev, libnav-msgs-dev, libsensor-msgs-dev, libtf2-ros-dev")
        sys.exit(77)
    in_own_network()
    library = library_in(installed())
    recording, ticks, calibration = drive()
    with gzip.open(recording, "rt") as lines:
        counts_per_turn = json.loads(next(lines))["ticks_per_rev"]
    node, flags = WORK / "odometry_node", run("pkg-config", "--cflags", "--libs", *packages).split()
    run("c++", "-std=c++17", "-Wall", "-Wextra", "-Werror", SOURCE / "examples/ros/odometry_node_ros1.cpp",
        f"-I{SOURCE / 'calib/library/include'}", *flags, f"-L{library.parent}", f"-Wl,-rpath,{library.parent}", "-lodomcalib", "-o", node)
    joints, heard = WORK / "joints.bag", WORK / "heard.bag"
    heard.unlink(missing_ok=True)
    bags = [shutil.which("python3", path="/usr/bin"), SOURCE / "tests/library/ros_bags.py"]
    run(*bags, "write", joints, input=json.dumps({"counts_per_turn": counts_per_turn, "ticks": ticks[:2000]}))
    environment = {**os.environ, "ROS_MASTER_URI": "http://127.0.0.1:11311", "ROS_IP": "127.0.0.1", "ROS_HOME": str(WORK / "ros")}
    started = []

    def start(*command, log):
        started.append(subprocess.Popen([str(part) for part in command], env=environment, stdout=open(WORK / log, "w"),
                                        stderr=subprocess.STDOUT))

    try:
        start("roscore", log="roscore.log")
        wait_for(lambda: subprocess.run(["rostopic", "list"], env=environment, capture_output=True, check=False).returncode == 0)
        start(node, f"_calibration:={calibration}", "_left_joint:=left", "_right_joint:=right", log="node.log")
        start("rosbag", "record", "-O", heard, "/odom", "/tf", "__name:=recorder", log="record.log")
        wait_for(lambda: "/odom" in run("rostopic", "list", env=environment))
        time.sleep(3.0)
        run("rosbag", "play", "--quiet", "--rate=5", "--delay=1", joints, env=environment)
        time.sleep(1.0)
    finally:
        for process in reversed(started):
            process.send_signal(signal.SIGINT)
            process.wait(timeout=30)
    poses = json.loads(run(*bags, "read", heard))
    expected = {round(t, 6): (x, y) for t, x, y in predicted(recording, calibration, "--live")}
    check(len(poses) > 1900, f"{len(poses)} of 2000 poses were heard")
    worst = max(max(abs(x - expected[round(t, 6)][0]), abs(y - expected[round(t, 6)][1])) for t, x, y, _ in poses)
    check(worst < 2e-9, f"they are those of the program: off by {worst} m")
    check(all(variance > 0.0 for *_, variance in poses[100:]), "they have covariances")


def wait_for(holds, patience=60.0):
    end = time.monotonic() + patience
    while not holds():
        check(time.monotonic() < end, "what was waited for came in time")
        time.sleep(0.5)


def write_log(path, ticks):
    """An LCM event log of what the daemon publishes."""
    run("lcm-gen", "--python", "--ppath", WORK / "types", *sorted((SOURCE / "proto/wire/lcm").glob("*.lcm")))
    sys.path.insert(0, str(WORK / "types"))
    from odomcalib.ticks_t import ticks_t  # pylint: disable=import-outside-toplevel,import-error,no-name-in-module

    with open(path, "wb") as log:
        for number, (stamp, left, right) in enumerate(ticks):
            message = ticks_t()
            message.utime, message.left, message.right = round(1e6 * stamp), left, right
            data = message.encode()
            log.write(struct.pack(">IqqII", 0xEDA1DA01, number, message.utime, 5, len(data)) + b"TICKS" + data)


def test_lcm():
    """What the example hears and what it sends, as the logger hears it."""
    in_own_network()
    program = WORK.parent / "consumer/consumer/lcm_odometry"
    check(program.exists(), "the consumer project was built before")
    recording, ticks, calibration = drive()
    played, log = WORK / "drive.lcmlog", WORK / "heard.lcmlog"
    write_log(played, ticks[:2000])
    log.unlink(missing_ok=True)
    environment = {**os.environ, "LD_LIBRARY_PATH": str(library_in(installed()).parent)}
    node = subprocess.Popen([program, calibration], env=environment)
    logger = subprocess.Popen(["lcm-logger", "--quiet", "--channel=CORRECTED_POSE", log])
    try:
        time.sleep(1.0)
        run("lcm-logplayer", "--speed=8", played)
        time.sleep(1.0)
    finally:
        node.terminate()
        logger.terminate()
        logger.wait()
    expected = predicted(recording, calibration, "--live")[:2000]
    bytes_heard, channel = log.read_bytes(), b"CORRECTED_POSE"
    heard = bytes_heard.count(channel)
    # A busy machine loses datagrams; counts go on, and only the play of the gears misses its steps.
    check(heard > 0.95 * len(expected), f"{heard} poses of {len(expected)} counts")
    _, _, x, y, _ = struct.unpack_from(">8xqqddd", bytes_heard, bytes_heard.rfind(channel) + len(channel))
    bound = 2e-9 if heard == len(expected) else 0.01
    check(math.dist((x, y), expected[-1][1:]) < bound, "the last one is that of the program")


def main():
    tests = {"needs": test_needs, "abi": test_abi, "consumer": test_consumer, "python": test_python, "step": test_step,
             "docs": test_docs, "ros": test_ros, "lcm": test_lcm}
    WORK.mkdir(parents=True, exist_ok=True)
    tests[sys.argv[1]]()
    print(f"{sys.argv[1]}: as it should be")


if __name__ == "__main__":
    main()
