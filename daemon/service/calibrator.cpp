#include "daemon/service/calibrator.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "calib/match.hpp"
#include "calib/odometry/odometry.hpp"
#include "calib/report/next_test.hpp"
#include "calib/solve.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/request.hpp"
#include "daemon/service/dead_reckoning.hpp"
#include "daemon/service/settings.hpp"
#include "odomcalib_version.hpp"

namespace odomcalib {
namespace {

using routines::Pose;

Pose inverse(const Pose& pose) {
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  return {-c * pose.x - s * pose.y, s * pose.x - c * pose.y, -pose.yaw};
}

// After a full turn an uncalibrated odometry may be wrong by ten degrees: the match starts from several
// headings, and the one with the most inliers counts.
std::optional<Pose> match(const Scan& from, const Scan& to, const Pose& guess,
                          const std::array<double, 3>& mount) {
  const Pose lidar{mount[0], mount[1], mount[2]};
  const Pose start = composed(composed(inverse(lidar), guess), lidar);
  const std::size_t tries = std::abs(guess.yaw) < service::settings::kSmallTurn_rad
                                ? 1
                                : service::settings::kTriedHeadings_rad.size();
  calib::ScanMatch best;
  for (std::size_t i = 0; i < tries; ++i) {
    const auto found = calib::match_scans(
        from, to, {start.x, start.y, start.yaw + service::settings::kTriedHeadings_rad.at(i)});
    if (found.ok() && (!best.ok() || found.inliers > best.inliers)) best = found;
  }
  if (!best.ok()) return std::nullopt;
  return composed(composed(lidar, {best.pose[0], best.pose[1], best.pose[2]}), inverse(lidar));
}

Result<Calibration> read_and_solve(const std::vector<std::filesystem::path>& paths,
                                   const std::vector<std::string>& effects,
                                   const Calibrator::Progress& progress) {
  std::vector<Recording> recordings;
  for (const auto& path : paths) {
    auto recording = read_recording(path, nullptr, {}, {}, Intensities::left_out);
    if (!recording) return recording.error();
    recordings.push_back(std::move(recording).value());
  }
  Calibration calibration = calib::solve(recordings, {.effects = effects}, progress);
  SolveSettings& settings = calibration.settings.emplace();
  settings.version = kVersion;
  settings.effects = effects;
  return calibration;
}

std::string applied_in(calib::odometry::Place place) {
  if (place == calib::odometry::Place::odometry) return "corrected odometry on the host";
  if (place == calib::odometry::Place::reference)
    return "comparison with the lidar on the host; odometry does not need it";
  return "nowhere: it belongs to the place or the day";
}

std::vector<HostValue> host_values(const Calibration& calibration) {
  std::vector<HostValue> values;
  for (const auto& placement : calib::odometry::effect_placements(calibration))
    values.push_back({placement.effect + (placement.parameter.empty() ? "" : "." + placement.parameter),
                      placement.quantity, applied_in(placement.place)});
  return values;
}

std::optional<NextManoeuvre> next_manoeuvre(const Calibration& calibration) {
  const auto next = calib::report::next_test(calibration);
  return next ? std::optional(NextManoeuvre{next->manoeuvre, next->why}) : std::nullopt;
}

}  // namespace

Calibrator make_calibrator() {
  Calibrator calibrator;
  calibrator.solve = read_and_solve;
  calibrator.wrong_effects = calib::terms::wrong_effects;
  calibrator.odometry = [](const Calibration& calibration) {
    auto state = std::make_shared<calib::odometry::Odometry>(calibration);
    return [state](const TickSample& sample) { return state->update(sample); };
  };
  calibrator.unit_of_effect = calib::terms::unit_of_effect;
  calibrator.host_values = host_values;
  calibrator.next_manoeuvre = next_manoeuvre;
  calibrator.match = match;
  return calibrator;
}

}  // namespace odomcalib
