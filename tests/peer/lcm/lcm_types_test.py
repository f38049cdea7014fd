"""Our LCM types in another language: Python classes that lcm-gen makes from the installed .lcm files.

usage: lcm_types_test.py BINDINGS LCM_MESSAGES ODOMCALIBCTL SIM_RECORD

What we encode is decoded by them with the same fields and fingerprint, what they encode is decoded by us, and an event log
that is written with them is a recording. Needs no LCM library: encoding and decoding are in the generated files.
"""

import gzip
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

bindings, messages_program, ctl, sim_record = sys.argv[1:5]
sys.path.insert(0, bindings)
import odomcalib  # noqa: E402  (the generated package)

STAMP = {"utime": 1_700_000_000_123_456, "mono_ns": 987_654_321_012}

# The messages that lcm_messages_main.cpp writes, stated again.
OURS = {
    "robot_t": {"utime": STAMP["utime"], "robot_id": "robot-1", "controller": "sim", "left_wheel_diameter": 0.147,
                "right_wheel_diameter": 0.146, "track_width": 0.411, "ticks_per_rev": 16384.0, "has_lidar_pose": 1,
                "lidar_pose": (0.1, -0.02, 0.75)},
    "ticks_t": {**STAMP, "seq": 7, "segment": 3, "left": -5_000_000_000, "right": 70000, "time_source": 4,
                "time_uncertainty_us": 200},
    "scan_t": {**STAMP, "seq": 42, "sensor": "front", "angle_min": -1.5, "angle_increment": 0.25,
               "time_increment": 0.0078125, "range_min": 0.125, "range_max": 12.0, "nranges": 3,
               "ranges": (1.5, 0.0, 2.25), "nangles": 3, "angles": (-1.5, -1.25, -0.75), "ntimes": 3,
               "times": (0.0, 0.5, 0.625), "nintensities": 3, "intensities": (10.0, 0.0, 255.0), "complete": 0,
               "time_source": 2, "time_uncertainty_us": 150},
    "pose_t": {**STAMP, "x": 1.5, "y": -2.25, "yaw": 3.125},
    "gyro_t": {**STAMP, "yaw_rate": -0.625},
    "path_t": {"utime": STAMP["utime"], "name": "odometry", "n": 2, "x": (1.0, 3.0), "y": (2.0, 4.0),
               "yaw": (0.5, -0.5)},
    "event_t": {**STAMP, "severity": 2, "code": "lease", "text": "not renewed: \u00b5"},
    "json_t": {"utime": STAMP["utime"], "format": "odomcalib-calibration/1", "json": '{"a":[1,2]}'},
}

# The fingerprints that the protocol text and the fuzzers hold us to.
FINGERPRINTS = {
    "robot_t": 0xE7B341C5F97392EE, "ticks_t": 0x1E7FFC7532290EB9, "scan_t": 0x179F2043430ED99C,
    "pose_t": 0x28E47EBEB05766E2, "gyro_t": 0xC722C864341443F5, "path_t": 0xF74C516DCC36F819,
    "event_t": 0x96FCEB71AE149523, "json_t": 0xE560D2700A250FF9,
}


def message(kind, fields):
    out = getattr(odomcalib, kind)()
    for name, value in fields.items():
        if name not in out.__slots__:
            raise KeyError(f"{kind} has no field {name}")
        setattr(out, name, value)
    return out


def fields(decoded):
    def plain(value):
        return tuple(value) if isinstance(value, (list, tuple)) else value
    return {name: plain(getattr(decoded, name)) for name in decoded.__slots__}


def told(*arguments, text=None):
    done = subprocess.run(arguments, input=text, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{arguments}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def decoded_by_us(kind, bytes_):
    return json.loads(told(messages_program, "decode", text=f"{kind} {bytes_.hex()}\n"))


def log_event(number, time_us, channel, data):
    return (struct.pack(">IqqII", 0xEDA1DA01, number, time_us, len(channel), len(data)) + channel.encode() + data)


class LcmTypes(unittest.TestCase):
    def test_the_fingerprints_are_those_of_the_protocol(self):
        for kind, fingerprint in FINGERPRINTS.items():
            self.assertEqual(getattr(odomcalib, kind)._get_packed_fingerprint(), struct.pack(">Q", fingerprint), kind)

    def test_what_we_encode_is_decoded_there(self):
        lines = dict(line.split() for line in told(messages_program, "encode").splitlines())
        self.assertEqual(set(lines), set(OURS))
        for kind, hexadecimal in lines.items():
            decoded = getattr(odomcalib, kind).decode(bytes.fromhex(hexadecimal))
            self.assertEqual(fields(decoded), OURS[kind], kind)
            self.assertEqual(decoded.encode().hex(), hexadecimal, f"{kind}: encoded again")

    def test_what_is_encoded_there_is_decoded_by_us(self):
        for kind in sorted(set(OURS) - {"path_t"}):  # a path is for viewers: we only write it
            ours = decoded_by_us(kind, message(kind, OURS[kind]).encode())
            self.assertIsNotNone(ours, kind)
            for name, value in ours.items():
                expected = OURS[kind][name]
                self.assertEqual(tuple(value) if isinstance(value, list) else value, expected, f"{kind}.{name}")

    def test_another_fingerprint_is_not_decoded(self):
        for kind in sorted(set(OURS) - {"path_t"}):
            bytes_ = bytearray(message(kind, OURS[kind]).encode())
            bytes_[7] ^= 1
            self.assertIsNone(decoded_by_us(kind, bytes(bytes_)), kind)
            with self.assertRaises(ValueError):
                getattr(odomcalib, kind).decode(bytes(bytes_))

    def test_an_event_log_that_is_written_there_is_a_recording(self):
        with tempfile.TemporaryDirectory() as folder:
            drive = pathlib.Path(folder) / "drive.jsonl.gz"
            told(sim_record, "--seed", "7", "--drive", "random", "--duration", "15", "--out", str(drive))
            lines = [json.loads(line) for line in gzip.open(drive, "rt")]
            log = pathlib.Path(folder) / "drive.lcmlog"
            log.write_bytes(b"".join(self.events(lines)))
            ends = []
            for recording in (drive, log):
                path = recording.with_suffix(".tum")
                told(ctl, "predict", str(recording), "--calibration", "nominal", "--trajectory", str(path))
                ends.append([float(word) for word in path.read_text().splitlines()[-1].split()])
                ends.append(len(path.read_text().splitlines()))
            self.assertEqual(ends[1], ends[3], "samples")
            self.assertGreater(math.hypot(ends[0][1], ends[0][2]), 0.01, "the robot moved")
            for ours, theirs in zip(ends[0][1:], ends[2][1:]):
                self.assertAlmostEqual(ours, theirs, places=9)

    @staticmethod
    def events(lines):
        """The lines of a JSON Lines recording as the events of an LCM log."""
        number = 0
        for line in lines:
            mono_ns = round(1e9 * line.get("t", lines[1]["t"]))
            stamp = {"utime": mono_ns // 1000, "mono_ns": mono_ns}
            if line["type"] == "robot":
                both = line.get("wheel_diameter", 0.0)
                channel, out = "ODOMCALIB_ROBOT", message("robot_t", {
                    "utime": stamp["utime"], "left_wheel_diameter": line.get("left_wheel_diameter", both),
                    "right_wheel_diameter": line.get("right_wheel_diameter", both), "track_width": line["track_width"],
                    "ticks_per_rev": line["ticks_per_rev"], "has_lidar_pose": 1, "lidar_pose": line["lidar_pose"]})
            elif line["type"] == "ticks":
                channel, out = "ODOMCALIB_TICKS", message("ticks_t", {
                    **stamp, "seq": number, "left": line["left"], "right": line["right"]})
            elif line["type"] == "scan":
                ranges = [value or 0.0 for value in line["ranges"]]
                channel, out = "ODOMCALIB_SCAN", message("scan_t", {
                    **stamp, "seq": number, "angle_min": line["angle_min"], "angle_increment": line["angle_increment"],
                    "time_increment": line.get("time_increment", 0.0), "range_min": line["range_min"],
                    "range_max": line["range_max"], "nranges": len(ranges), "ranges": ranges, "complete": 1})
            else:
                continue
            yield log_event(number, stamp["utime"], channel, out.encode())
            number += 1


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
