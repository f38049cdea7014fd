// Where the nonlinear fit starts: nominal values, the closed form, and a search for the delay between the
// clocks.
#pragma once

#include "calib/measurement/dataset.hpp"
#include "calib/terms/request.hpp"
#include "calib/vehicle/vehicle_model.hpp"

namespace odomcalib::calib::estimation {

/// Delay of the sensor against the encoders: delay + rate (t - middle of the recording), s and s/s.
struct ClockStart {
  double delay = 0.0;
  double rate =
      0.0;  ///< zero but for clocks that run apart by more than the nonlinear fit finds its way from
};

/// The one that makes the measured rotation follow the wheels best; delays are searched from -0.6 to 0.6 s,
/// in the whole and in its halves. Only rotation is compared, which needs neither the sensor's pose nor
/// correct diameters.
ClockStart search_clock(std::span<const measurement::FitData> data);

/// Nominal values where they exist; the closed form supplies what the recording does not state.
wheels::BaseParameters start_values(const measurement::Dataset& dataset, double delay);

/// Where the fit begins: what was requested and, where that is automatic and times are known, a delay between
/// the clocks. Errors: those of check_signs, which runs before anything is fitted.
/// @param rough measured roughly
Result<vehicle::VehicleModel> start_model(const measurement::Dataset& rough, const terms::Request& request);

}  // namespace odomcalib::calib::estimation
