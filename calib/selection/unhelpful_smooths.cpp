#include "calib/selection/unhelpful_smooths.hpp"

#include <optional>

#include "calib/selection/drive_error.hpp"
#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

/// Of odometry over ten seconds with the model's effects; nullopt where the drive is too short for it.
std::optional<DriveError> open_loop_error(const FitTask& task, const FittedModel& model) {
  const JudgedModel judged{&model.fit, task.fixed(model.effects), model.effects};
  const auto errors = drive_errors(task.data, {}, nullptr, judged);
  const DriveError* found = open_loop_position(errors);
  return found == nullptr || !found->after || !found->noise_floor ? std::nullopt : std::optional(*found);
}

}  // namespace

bool explain_too_little(const FitTask& task, const FittedModel& with, const FittedModel& without) {
  const auto after = open_loop_error(task, with), before = open_loop_error(task, without);
  if (!after || !before) return false;
  const auto square = [](double x) { return x * x; };
  const double all = square(before->after->value) - square(*after->noise_floor);
  return square(before->after->value) - square(after->after->value) < settings::kLeastExplained * all;
}

}  // namespace odomcalib::calib::selection
