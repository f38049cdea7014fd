#include "calib/ingest/odometry_frame.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

#include "calib/ingest/settings.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/number_text.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::ingest {
namespace {

struct Step {
  double ahead = 0.0, aside = 0.0;  ///< m, against the heading in its middle
  double turn = 0.0;                ///< rad
};

/// Long enough that rounded numbers hardly bend it, short enough to be an arc.
std::vector<Step> steps_of(const std::vector<PoseSample>& poses) {
  std::vector<Step> steps;
  PoseSample from = poses.front();
  for (const PoseSample& to : poses) {
    const double x = to.x - from.x, y = to.y - from.y, turn = math::wrap_angle(to.yaw - from.yaw);
    if (std::hypot(x, y) < settings::kOdometryStep_m && std::abs(turn) < settings::kOdometryStep_rad)
      continue;
    const double heading = from.yaw + 0.5 * turn;
    steps.push_back(
        {std::cos(heading) * x + std::sin(heading) * y, std::cos(heading) * y - std::sin(heading) * x, turn});
    from = to;
  }
  return steps;
}

struct Sideways {
  double share = 0.0;  ///< of the way, as it is
  double slope = 0.0;  ///< of the way, to the left
  double slope_deviation = 0.0;
  double unexplained = 0.0;  ///< share of the way that no frame explains
};

std::optional<Sideways> sideways_of(const std::vector<Step>& steps) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  const auto terms = [](const Step& step) {
    return Eigen::Vector3d(step.ahead, step.turn, step.ahead * step.turn);
  };
  double way = 0.0, aside = 0.0;
  for (const Step& step : steps) {
    normal += terms(step) * terms(step).transpose();
    right_side += step.aside * terms(step);
    way += std::hypot(step.ahead, step.aside);
    aside += std::abs(step.aside);
  }
  if (!(way > settings::kOdometryStep_m)) return std::nullopt;
  normal += 1e-12 * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d fit = math::solve_symmetric(normal, right_side);
  double left = 0.0, squares = 0.0;
  for (const Step& step : steps) {
    const double misfit = step.aside - fit.dot(terms(step));
    left += std::abs(misfit);
    squares += misfit * misfit;
  }
  const double variance = squares / (static_cast<double>(steps.size()) - 3.0);
  const Eigen::Vector3d column = math::solve_symmetric(normal, Eigen::Vector3d(1.0, 0.0, 0.0));
  return Sideways{aside / way, fit(0), std::sqrt(variance * std::max(column(0), 0.0)), left / way};
}

Error wrong(const Recording& recording, double share, const std::string& what, const std::string& remedy) {
  return {ErrorCode::format,
          "the odometry goes sideways over " + math::significant(100.0 * share, 2) + " % of its way: " + what,
          recording.name, remedy};
}

}  // namespace

std::optional<Error> wrong_odometry_frame(const Recording& recording) {
  if (recording.motion != MotionSource::odometry || recording.odometry.empty()) return std::nullopt;
  const std::vector<Step> steps = steps_of(recording.odometry);
  if (steps.size() < settings::kFewestPoseSteps) return std::nullopt;
  const auto sideways = sideways_of(steps);
  if (!sideways) return std::nullopt;
  if (sideways->unexplained > settings::kAsideUnexplained)
    return wrong(
        recording, sideways->share,
        "yaw and place do not belong together, as where yaw is that of a filter or a gyro and the place "
        "is that of the wheels",
        "record the odometry that the wheels alone make, or joint states");
  const double slope = sideways->slope;
  if (std::abs(slope) < settings::kTurnedFrame ||
      std::abs(slope) < settings::kPlainlyTurned * sideways->slope_deviation)
    return std::nullopt;
  const std::string degrees = math::fixed(std::abs(std::atan(slope)) * 180.0 / math::kPi, 1);
  return wrong(recording, sideways->share,
               "its frame is turned " + degrees + " degrees to the " + (slope > 0.0 ? "right" : "left") +
                   " of where the wheels drive",
               "record the frame whose x axis points ahead (base_link), or turn its yaw " + degrees +
                   " degrees to the " + (slope > 0.0 ? "left" : "right"));
}

}  // namespace odomcalib::calib::ingest
