// Numbers that decide about RPLIDAR.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>

#include "drivers/lidar/common/sweep.hpp"

namespace odomcalib::drivers::rplidar {

// Dialogue.
/// s after a stop, until what was under way has arrived. Published (protocol manual): 20 ms to be safe.
inline constexpr double kQuiet_s = 0.02;
/// s after a reset. Published (protocol manual): 0.5 to 2 s.
inline constexpr double kReboot_s = 2.0;
/// s for an answer. Chosen: at 115200 baud the longest takes 10 ms; a USB adapter adds 16.
inline constexpr double kPatience_s = 0.25;
/// s for the first measurement; s without measurements. Chosen: a motor spins up in 1 s.
inline constexpr double kSpinUp_s = 2.0, kSilence_s = 1.0;
/// Motor: pulse width of 1023, turns a minute. Published (SDK): 660; 600 rpm are 10 Hz.
inline constexpr unsigned kPwm = 660, kRpm = 600;
/// Bytes of an answer. Chosen: texts of modes stay below 100.
inline constexpr std::size_t kMostAnswerBytes = 1024;

// Capsules.
/// m. Published (data sheets): from 0.15 m (A1) or 0.05 m (S, C series) on; newer models tell the far end.
inline constexpr Sweep::Limits kLimits{0.05, 40.0, true};
/// Hz. Chosen: no model turns so fast.
inline constexpr double kFastest_hz = 100.0;
/// Degrees that a capsule may span. Chosen.
inline constexpr double kMostSpan_deg = 180.0;
/// s, of a time between samples that is told. Chosen.
inline constexpr double kLeastSample_s = 1e-6, kMostSample_s = 1e-2;
/// Times the usual span: a capsule is missing. Derived: half-way between one and two.
inline constexpr double kLostFactor = 1.5;
/// Gain of the filter for the usual span. Chosen: the motor's speed drifts over some ten capsules.
inline constexpr double kSpanGain = 0.1;
/// Degrees that a standard point may lie behind the one before, or ahead of it. Chosen: neighbours swap by a
/// little; 30 degrees without a point are a hole.
inline constexpr double kMostBackwards_deg = 2.0, kMostStep_deg = 30.0;
/// Samples from measurement to output. Published (SDK): half a sample, and one of filtering in the device.
inline constexpr double kFilterDelay = 1.5;

// Layout of a stream that does not say it.
/// Sound packets in a row. Derived: sync and checksum of a capsule fit one place in 65536, and one in 256
/// behind the sync of a longer kind; two are one in 2^24. Standard packets have four bits each: eight.
inline constexpr std::size_t kCapsuleRun = 2, kStandardRun = 8;
/// Capsules looked at before the layout counts as unknowable. Chosen: more than a turn.
inline constexpr std::size_t kMostCapsules = 32;
/// Pairs of neighbours with readings; share of smooth ones; the other layout's, relative to it. Chosen: most
/// neighbours see one wall; in the wrong layout, corrections are read as ranges.
inline constexpr unsigned kFewestPairs = 20;
inline constexpr double kSmooth = 0.5, kRough = 0.5;
/// Part of the range, and mm, within which neighbours see about the same. Chosen.
inline constexpr double kSmoothPart = 0.05, kSmooth_mm = 20.0;

}  // namespace odomcalib::drivers::rplidar
