// Numbers that decide about clocks and streams, for every driver.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>

namespace odomcalib::drivers {

// SampleClock.
/// s late that is a hole in the stream. Derived: longer than a USB adapter's bursts (16 ms) and a busy host's
/// delays.
inline constexpr double kHole_s = 0.1;
/// s of a window of the lower envelope. Derived: some bursts of a USB adapter, so that each has a prompt
/// packet.
inline constexpr double kWindow_s = 0.25;
/// Gain, of what a window is off. Chosen: three windows, 1 s, to follow a change of the rate.
inline constexpr double kRateGain = 0.3;
/// Factor between the nominal and a believable sample rate. Chosen: sample rates that one model
/// can be set to differ by two.
inline constexpr double kMostRate = 2.0;

// DeviceClock.
/// s a second by which the envelope may rise. Derived: crystals of lidars differ by up to 100 ppm and a
/// little more when warm; twice that.
inline constexpr double kDrift = 200e-6;
/// s off the envelope that is a device that was restarted. Derived: more than any transport's delay.
inline constexpr double kRestarted_s = 0.5;

// Streams.
/// Bytes of one read, so that a fast device cannot hold the event loop. Derived: 0.06 s of 10 Mbit/s.
inline constexpr std::size_t kReadAtMost = std::size_t{64} * 1024;

}  // namespace odomcalib::drivers
