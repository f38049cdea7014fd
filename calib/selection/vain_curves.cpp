#include "calib/selection/vain_curves.hpp"

#include <algorithm>
#include <optional>

#include "calib/selection/drive_error.hpp"

namespace odomcalib::calib::selection {
namespace {

/// Of odometry over ten seconds with the model's effects; nullopt where the drive is too short to tell.
std::optional<DriveError> open_loop_error(const FitTask& task, const FittedModel& model) {
  const JudgedModel judged{&model.fit, task.fixed(model.effects), model.effects};
  const auto errors = drive_errors(task.data, {}, nullptr, judged);
  const auto found = std::find_if(errors.begin(), errors.end(),
                                  [](const DriveError& e) { return e.name == "open_loop_10s_position"; });
  return found == errors.end() || !found->after || !found->noise_floor ? std::nullopt : std::optional(*found);
}

}  // namespace

bool explain_too_little(const FitTask& task, const FittedModel& with, const FittedModel& without) {
  constexpr double kLeast = 0.5;  // of the square
  const auto after = open_loop_error(task, with), before = open_loop_error(task, without);
  if (!after || !before) return false;
  const auto square = [](double x) { return x * x; };
  const double all = square(before->after->value) - square(*after->noise_floor);
  return square(before->after->value) - square(after->after->value) < kLeast * all;
}

}  // namespace odomcalib::calib::selection
