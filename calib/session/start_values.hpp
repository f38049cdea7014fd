// Where the nonlinear fit starts: nominal values, the closed form, and a search for the delay between the
// clocks.
#pragma once

#include "calib/session/session.hpp"

namespace odomcalib::calib {

/// Delay of the sensor against the encoders that makes the measured rotation follow the wheels best, s;
/// searched from -0.6 to 0.6 s. Only rotation is compared, which needs neither the sensor's pose nor correct
/// diameters.
double search_delay(std::span<const FitData> data);

/// Nominal values where they exist; the closed form supplies what the recording does not state.
BaseParameters start_values(const Session& session, double delay);

}  // namespace odomcalib::calib
