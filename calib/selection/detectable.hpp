// Effects that a recording would have shown.
#pragma once

#include <vector>

#include "calib/selection/fitted_model.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::calib::selection {

/// The smallest size at which each effect of the catalogue that is not in the model would have been found in
/// nine of ten recordings like this: its deviation 1 / sqrt(x' x), x the effect's whitened signature beyond
/// what the fitted parameters absorb (Cramer 1946, section 32.3), times the quantiles of the test and of its
/// power; none is reported that does not matter (kNegligibleShare). Of an effect with several sizes, and of
/// its textbook shape, that which shows best.
std::vector<Detectable> smallest_detectable(const FitTask& task, const FittedModel& model);

}  // namespace odomcalib::calib::selection
