#!/usr/bin/env python3
"""Checks that includes point one way: proto <- calib, proto <- drivers, {calib, drivers} <- daemon, all <- tests, and
inside these folders from a layer only to those above it in LAYERS. With that no two folders can include each other.
A namespace of settings is one file, so that no constant of it can have two values.

Usage: check_includes.py [PROJECT_ROOT]      lists violations, exit status 1 if there are any
       check_includes.py --self-test         shows that each rule accepts what is right and rejects what is wrong
"""

import pathlib
import re
import sys
import tempfile

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')

SETTINGS = re.compile(r"^namespace ([\w:]+::settings) \{", re.MULTILINE)

# Folder -> folders of this project whose headers it may include.
MAY_INCLUDE = {
    "proto": {"proto"},
    "calib": {"proto", "calib"},
    "drivers": {"proto", "drivers"},
    "daemon": {"proto", "calib", "drivers", "daemon"},
    "tests": {"proto", "calib", "drivers", "daemon", "tests"},
}

# Folder -> its layers, the lowest first: a layer includes only itself and those before it. Layers in one tuple are
# beside each other: neither includes the other. "." is what lies in the folder itself.
LAYERS = {
    "proto": [".", "wire", "recording", "calibration", "control"],
    "calib": ["math", "wheels", "vehicle", "terms", "matching", "ingest", "measurement", "classical", "estimation",
              "validation", "selection", "stages", "odometry", ("report", "slam", "comparison", "library"), "."],
    "drivers": [".", ("serial", "tcp"), "can", ("base", "lidar"), "decode"],
    "daemon": ["routines", "safety", "writeback", "config", ("service", "cli")],
}

# The simulator shares no code with what it tests; the programs that write recordings use the file format alone.
SIM = "tests/sim/"
SIM_MAY_INCLUDE = {"proto/measurements.hpp", "proto/recording/recording.hpp", "proto/result.hpp", "proto/file_bytes.hpp"}

# Made by CMake in the build folder.
GENERATED = {"odomcalib_paths.hpp", "odomcalib_version.hpp"}

# calib is numbers only: no sockets, no LCM, no logging, no clocks, no JSON: proto has that of the calibration file. Bytes and
# numbers never log.
SYSTEM_BANNED = {
    "calib": ("lcm/", "spdlog/", "systemd/", "sys/socket.h", "netinet/", "linux/", "chrono", "ctime", "time.h",
              "nlohmann/"),
    "drivers": ("lcm/", "spdlog/", "systemd/", "ceres/"),
    "proto": ("spdlog/", "systemd/", "ceres/", "sys/socket.h"),
}


def includes(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        found = INCLUDE.match(line)
        if found:
            yield number, found.group(1) == '"', found.group(2)


def layer_of(path, layers):
    """(height, folder) of a file in its folder's layers; None where they do not list it."""
    parts = path.split("/")
    folder = parts[1] if len(parts) > 2 else "."
    for height, beside in enumerate(layers):
        if folder == beside or (isinstance(beside, tuple) and folder in beside):
            return height, folder
    return None


def layer_problem(name, header):
    """Why the layer of `name` may not include `header` of the same top folder, or None."""
    folder = name.split("/")[0]
    if folder not in LAYERS or header.split("/")[0] != folder:
        return None
    own, other = layer_of(name, LAYERS[folder]), layer_of(header, LAYERS[folder])
    if own is None or other is None:
        return f"{name if own is None else header} lies in no layer of {folder} (LAYERS in tests/check_includes.py)"
    if own[1] == other[1] or other[0] < own[0]:
        return None
    return f'layer {folder}/{own[1]} must not include "{header}"'


def problem(name, quoted, header):
    """Why the file `name` (relative to the root) may not include `header`, or None."""
    folder = name.split("/")[0]
    if not quoted:
        banned = [b for b in SYSTEM_BANNED.get(folder, ()) if header == b or (b.endswith("/") and header.startswith(b))]
        return f"{folder} must not use <{header}>" if banned else None
    if header in GENERATED:
        return None
    target = header.split("/")[0]
    if target not in MAY_INCLUDE:
        return f'"{header}" is not written from the project root'
    if target not in MAY_INCLUDE[folder]:
        return f'{folder} must not include "{header}"'
    if name.startswith(SIM) and not header.startswith(SIM) and header not in SIM_MAY_INCLUDE:
        return f'the simulator must not share code: "{header}"'
    return layer_problem(name, header)


def violations(root):
    for folder in MAY_INCLUDE:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".hpp", ".cpp", ".in", ".h", ".cc"):
                continue
            name = path.relative_to(root).as_posix()
            for number, quoted, header in includes(path):
                reason = problem(name, quoted, header)
                if reason:
                    yield f"{name}:{number}: {reason}"


def split_settings(root):
    """Files that define constants of a namespace of settings beside another file."""
    known = {}
    for path in sorted(path for folder in MAY_INCLUDE for path in (root / folder).rglob("*.hpp")):
        for namespace in SETTINGS.findall(path.read_text(encoding="utf-8")):
            name = path.relative_to(root).as_posix()
            if known.setdefault(namespace, name) != name:
                yield f"{name}: {namespace} stands in {known[namespace]} already"


def settings_are_judged_rightly():
    with tempfile.TemporaryDirectory() as folder:
        calib = pathlib.Path(folder) / "calib"
        calib.mkdir()
        for name, layer in (("a.hpp", "a"), ("b.hpp", "b")):
            (calib / name).write_text(f"namespace {layer}::settings {{\n}}\n", encoding="utf-8")
        apart = list(split_settings(pathlib.Path(folder)))
        (calib / "c.hpp").write_text("namespace b::settings {\n}\n", encoding="utf-8")
        return not apart and len(list(split_settings(pathlib.Path(folder)))) == 1


def self_test():
    good = [
        ("proto/a.hpp", "proto/b.hpp"), ("calib/a.cpp", "proto/b.hpp"), ("calib/a.cpp", "calib/terms/b.hpp"),
        ("drivers/base/vesc/a.cpp", "drivers/can/b.hpp"), ("daemon/cli/a.cpp", "calib/b.hpp"), ("daemon/cli/a.cpp", "drivers/b.hpp"),
        ("tests/unit/a.cpp", "daemon/b.hpp"), ("tests/sim/a.cpp", "tests/sim/b.hpp"),
        ("tests/sim/a.cpp", "proto/measurements.hpp"),
        ("calib/terms/effects/a.cpp", "calib/terms/b.hpp"), ("calib/selection/a.cpp", "calib/math/b.hpp"),
        ("calib/slam/a.cpp", "calib/matching/b.hpp"), ("calib/solve.cpp", "calib/report/b.hpp"),
        ("proto/recording/a.cpp", "proto/wire/b.hpp"), ("daemon/service/a.cpp", "daemon/writeback/b.hpp"),
    ]
    bad = [
        ("proto/a.hpp", "calib/b.hpp"), ("proto/a.hpp", "drivers/b.hpp"), ("calib/a.cpp", "drivers/b.hpp"),
        ("drivers/a.cpp", "calib/b.hpp"), ("calib/a.cpp", "daemon/b.hpp"), ("daemon/a.cpp", "tests/b.hpp"),
        ("tests/sim/a.cpp", "calib/b.hpp"), ("tests/sim/a.cpp", "proto/messages.hpp"), ("proto/a.hpp", "b.hpp"),
        ("calib/math/a.hpp", "calib/terms/b.hpp"), ("calib/measurement/a.cpp", "calib/selection/b.hpp"),
        ("calib/report/a.cpp", "calib/solve.hpp"), ("calib/report/a.cpp", "calib/slam/b.hpp"),
        ("calib/nowhere/a.cpp", "calib/math/b.hpp"), ("proto/wire/a.hpp", "proto/recording/b.hpp"),
        ("proto/a.hpp", "proto/wire/b.hpp"), ("daemon/service/a.cpp", "daemon/cli/b.hpp"),
        ("daemon/routines/a.cpp", "daemon/safety/b.hpp"),
        ("drivers/can/a.cpp", "drivers/base/vesc/b.hpp"), ("drivers/lidar/scip/a.cpp", "drivers/base/b.hpp"),
    ]
    for case, expected in [(c, 0) for c in good] + [(c, 1) for c in bad]:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / case[0]
            path.parent.mkdir(parents=True)
            path.write_text(f'// comment\n#include "{case[1]}"\n', encoding="utf-8")
            found = list(violations(pathlib.Path(folder)))
            if len(found) != expected:
                print(f"self-test failed: {case} gave {found}")
                return 1
    if problem("calib/a.cpp", False, "chrono") is None or problem("daemon/a.cpp", False, "chrono") is not None:
        print("self-test failed: system headers")
        return 1
    json = "nlohmann/json_fwd.hpp"
    if problem("calib/a.cpp", False, json) is None or problem("proto/a.cpp", False, json) is not None:
        print("self-test failed: JSON")
        return 1
    if not settings_are_judged_rightly():
        print("self-test failed: settings in two files")
        return 1
    print(f"{len(good) + len(bad) + 6} cases judged rightly")
    return 0


def main():
    if "--self-test" in sys.argv:
        return self_test()
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = list(violations(root)) + list(split_settings(root))
    for line in found:
        print(line)
    print(f"{len(found)} violations of the include direction and of one settings file a layer")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
