// A model fitted to a dataset, as a value: a stage that may be rejected makes another beside it.
#pragma once

#include <functional>
#include <optional>

#include "calib/estimation/joint.hpp"
#include "calib/measurement/dataset.hpp"
#include "calib/measurement/progress.hpp"
#include "calib/terms/request.hpp"
#include "calib/vehicle/vehicle_model.hpp"

namespace odomcalib::calib::estimation {

struct Fit {
  measurement::Dataset dataset;
  vehicle::VehicleModel model;  ///< as fitted; of a fit that failed, where it began
  FitResult result = {};        ///< of `model`; empty where the fit failed
  std::optional<Error> failure = {};
};

/// One joint fit to the pairs as they are. Failures: those of fit_joint.
Fit fit_once(measurement::Dataset dataset, const vehicle::VehicleModel& start);

/// Options of a fit that goes on until it has settled.
struct Settling {
  double negligible_delay = 0.0;  ///< s, of the clocks: a delay that moves by no more has settled
  /// The model without what it turns out not to need.
  std::function<vehicle::VehicleModel(const Fit&)> pruned;
  measurement::Progress progress;
};

/// Fits, matches again with the fitted parameters (guess and de-skew), and fits again. Noise of a match made
/// with wrong parameters must not reach the result; a clock far off takes a few more passes.
/// @param dataset measured
Fit settle(measurement::Dataset dataset, vehicle::VehicleModel start, const Settling& how);

/// The same, with all pairs measured with the start first.
Fit measure_and_settle(measurement::Dataset dataset, vehicle::VehicleModel start, const Settling& how);

/// From nominal values: for scans that differ so much that what was fitted to others is no start.
/// Failures: those of start_model, too.
Fit fit_anew(measurement::Dataset dataset, const terms::Request& request, const Settling& how);

}  // namespace odomcalib::calib::estimation
