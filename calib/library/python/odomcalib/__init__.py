"""Corrected odometry with a calibration of odomcalib.

    from odomcalib import Odometry
    odometry = Odometry("cal.json")
    odometry.update_counts(stamp, left, right)
    x, y, yaw = odometry.pose

Units: m, rad, s. A sample that cannot be used raises OdometryError; the pose then is what it was, and the next good sample
goes on. The code is that of libodomcalib.so.0, through its C interface (odomcalib_odometry(3)); a folder that holds it
may be named by ODOMCALIB_LIBRARY.
"""

import ctypes
import os
import pkgutil

__all__ = ["Effect", "Odometry", "OdometryError", "version"]

# The classes that lcm-gen makes of the messages lie in a package of this name, too.
__path__ = pkgutil.extend_path(__path__, __name__)

_SONAME = "libodomcalib.so.0"
_PLACES = ("pose", "scans", "stamps", "left out")
_NOT_KNOWN = 10


class OdometryError(Exception):
    """What is wrong, in words; `status` is its name in odomcalib/odometry.h without the prefix, "JUMP"."""

    def __init__(self, status, text):
        super().__init__(f"{text or 'failed'} ({status})")
        self.status = status


class Effect:
    """One value of an effect: name, value, unit, place ("pose", "scans", "stamps" or "left out") and why it is left out."""

    def __init__(self, name, value, unit, place, why):
        self.name, self.value, self.unit, self.place, self.why = name, value, unit, place, why

    def __repr__(self):
        return f"Effect({self.name}={self.value:g} {self.unit}, {self.place})"


class _Options(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("counts_per_turn", ctypes.c_double), ("counter_bits", ctypes.c_int),
                ("use_refused", ctypes.c_int)]


class _Effect(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("name", ctypes.c_char_p), ("value", ctypes.c_double), ("unit", ctypes.c_char_p),
                ("place", ctypes.c_int), ("why", ctypes.c_char_p)]


def _load():
    library = ctypes.CDLL(os.path.join(os.environ.get("ODOMCALIB_LIBRARY", ""), _SONAME))
    handle, size, real, count = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_double, ctypes.c_int64
    numbers, reals, floats = ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_float)
    declared = {
        "version": (ctypes.c_char_p, []),
        "status_name": (ctypes.c_char_p, [ctypes.c_int]),
        "odometry_open": (ctypes.c_int, [ctypes.c_char_p, ctypes.POINTER(_Options), ctypes.POINTER(handle), ctypes.c_char_p, size]),
        "odometry_close": (None, [handle]),
        "odometry_update_counts": (ctypes.c_int, [handle, real, count, count]),
        "odometry_update_angles": (ctypes.c_int, [handle, real, real, real]),
        "odometry_update_speeds": (ctypes.c_int, [handle, real, real, real]),
        "odometry_restart": (ctypes.c_int, [handle]),
        "odometry_set_pose": (ctypes.c_int, [handle, numbers]),
        "odometry_stamp": (real, [handle]),
        "odometry_pose": (ctypes.c_int, [handle, numbers]),
        "odometry_velocity": (ctypes.c_int, [handle, numbers]),
        "odometry_covariance": (ctypes.c_int, [handle, numbers]),
        "odometry_velocity_covariance": (ctypes.c_int, [handle, numbers]),
        "odometry_lidar_pose": (ctypes.c_int, [handle, numbers]),
        "odometry_clock_offset": (real, [handle]),
        "odometry_correct_beams": (ctypes.c_int, [handle, size, floats, floats, floats, floats]),
        "odometry_effect_count": (size, [handle]),
        "odometry_effect": (ctypes.c_int, [handle, size, ctypes.POINTER(_Effect)]),
        "odometry_problem": (ctypes.c_char_p, [handle]),
        "odometry_path": (ctypes.c_int, [handle, size, reals, ctypes.POINTER(count), ctypes.POINTER(count), reals]),
    }
    for name, (result, arguments) in declared.items():
        function = getattr(library, "odomcalib_" + name)
        function.restype, function.argtypes = result, arguments
    return library


_library = _load()


def version():
    """Version of the library, "0.2.0"."""
    return _library.odomcalib_version().decode()


def _check(status, text):
    if status != 0:
        raise OdometryError(_library.odomcalib_status_name(status).decode(), text)


class Odometry:
    """A running drive with a calibration file. `counter_bits`: 8 to 32 where counts wrap."""

    def __init__(self, path, counts_per_turn=0.0, counter_bits=0, use_refused=False):
        self._handle = ctypes.c_void_p()
        options = _Options(ctypes.sizeof(_Options), counts_per_turn, counter_bits, int(use_refused))
        problem = ctypes.create_string_buffer(512)
        _check(_library.odomcalib_odometry_open(os.fsencode(path), options, self._handle, problem, len(problem)),
               problem.value.decode(errors="replace"))

    def close(self):
        _library.odomcalib_odometry_close(self._handle)
        self._handle = ctypes.c_void_p()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        if getattr(self, "_handle", None):
            self.close()

    def _problem(self):
        return _library.odomcalib_odometry_problem(self._handle).decode()

    def update_counts(self, stamp, left, right):
        """Cumulative counts of both wheels at a time in s."""
        _check(_library.odomcalib_odometry_update_counts(self._handle, stamp, left, right), self._problem())

    def update_angles(self, stamp, left, right):
        """Cumulative angles of both wheels, rad."""
        _check(_library.odomcalib_odometry_update_angles(self._handle, stamp, left, right), self._problem())

    def update_speeds(self, stamp, left, right):
        """Speeds of both wheels, rad/s, each held until the next sample."""
        _check(_library.odomcalib_odometry_update_speeds(self._handle, stamp, left, right), self._problem())

    def restart(self):
        """Counters or clock are about to start anew."""
        _check(_library.odomcalib_odometry_restart(self._handle), self._problem())

    def _values(self, name, count, may_miss=False):
        values = (ctypes.c_double * count)()
        status = getattr(_library, "odomcalib_odometry_" + name)(self._handle, values)
        if not (may_miss and status == _NOT_KNOWN):
            _check(status, "not in the calibration" if status == _NOT_KNOWN else "")
        return tuple(values)

    @property
    def pose(self):
        """x, y, yaw of the base."""
        return self._values("pose", 3)

    @pose.setter
    def pose(self, value):
        _check(_library.odomcalib_odometry_set_pose(self._handle, (ctypes.c_double * 3)(*value)), self._problem())

    @property
    def stamp(self):
        """s, of the last sample that was taken in."""
        return _library.odomcalib_odometry_stamp(self._handle)

    @property
    def velocity(self):
        """Forward, to the left (m/s), yaw rate (rad/s)."""
        return self._values("velocity", 3)

    @property
    def covariance(self):
        """Of the pose, nine values row by row: the part that the calibration knows."""
        return self._values("covariance", 9, may_miss=True)

    @property
    def velocity_covariance(self):
        """Of the velocity, nine values row by row: the part that the calibration knows."""
        return self._values("velocity_covariance", 9, may_miss=True)

    @property
    def lidar_pose(self):
        """x, y, yaw of the lidar on the base."""
        return self._values("lidar_pose", 3)

    @property
    def clock_offset(self):
        """s: a scan stamped t was taken at t - offset by the encoders' clock."""
        return _library.odomcalib_odometry_clock_offset(self._handle)

    def corrected_beams(self, bearings, ranges):
        """Bearings (rad) and ranges (m) of a scan without the errors of the lidar that can be corrected."""
        count = len(ranges)
        if len(bearings) != count:
            raise ValueError("as many bearings as ranges")
        beams, lengths = (ctypes.c_float * count)(*bearings), (ctypes.c_float * count)(*ranges)
        _check(_library.odomcalib_odometry_correct_beams(self._handle, count, beams, lengths, beams, lengths), "")
        return list(beams), list(lengths)

    @property
    def effects(self):
        """What the calibration holds beside lengths, and where it is applied."""
        effects = []
        for index in range(_library.odomcalib_odometry_effect_count(self._handle)):
            one = _Effect(size=ctypes.sizeof(_Effect))
            _check(_library.odomcalib_odometry_effect(self._handle, index, one), "")
            effects.append(Effect(one.name.decode(), one.value, one.unit.decode(), _PLACES[one.place], one.why.decode()))
        return effects

    def path(self, stamps, left, right):
        """Poses (x, y, yaw) of a whole recording at once, as `odomcalibctl predict` has them; counts."""
        count = len(stamps)
        if len(left) != count or len(right) != count:
            raise ValueError("as many counts as stamps")
        poses = (ctypes.c_double * (3 * count))()
        _check(_library.odomcalib_odometry_path(self._handle, count, (ctypes.c_double * count)(*stamps),
                                                (ctypes.c_int64 * count)(*left), (ctypes.c_int64 * count)(*right), poses), "")
        return [tuple(poses[3 * k:3 * k + 3]) for k in range(count)]
