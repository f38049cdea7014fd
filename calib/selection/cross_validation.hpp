// Cross-validation of an addition to the model.
#pragma once

#include <optional>
#include <string>

#include "calib/selection/fitted_model.hpp"
#include "calib/validation/window_errors.hpp"

namespace odomcalib::calib::selection {

/// Evidence for an addition to the model.
struct CrossValidation {
  double family_p_value = 1.0;
  double before = 0.0;  ///< held-out position error over ten seconds, m
  double after = 0.0;
  validation::Improvement improvement;
};

/// Change of held-out drives by another model.
struct DriveChange {
  std::optional<double> ratio;  ///< of the error over ten seconds; none where there are too few windows
  bool is_spoilt = false;       ///< full turns, straight metres or ten seconds grow worse by more than a
                                ///< twentieth, beyond the 95 % interval
};

/// From one model to the other; each may have its own noise model.
DriveChange change_of_drives(const FitTask& task, const FittedModel& before, const FittedModel& after);

/// On one noise model: error over ten seconds, or else whitened residual per block.
/// @param selected the choice itself is held out: a fold counts only if the others point to the candidate
/// @return empty if it holds, otherwise what is missing
std::string objection(const FitTask& task, const FittedModel& before, const FittedModel& after,
                      const validation::FoldFlags& selected, CrossValidation& validation);

/// Each model's own weights spare what it explains badly: both are compared with the larger ones.
validation::HeldOutGain compared_on_held_out(const FitTask& task, const FittedModel& before,
                                             const FittedModel& after, const validation::FoldFlags& selected);

}  // namespace odomcalib::calib::selection
