#include "calib/measurement/scan_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/ingest/even_stamps.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

/// Poses at equal steps of time.
struct Knots {
  std::vector<math::Pose> poses;
  double step = 0.0;  ///< s

  [[nodiscard]] math::Pose at(double seconds) const {
    const double place = std::clamp(seconds / step, 0.0, static_cast<double>(poses.size() - 1));
    const auto k = std::min(static_cast<std::size_t>(place), poses.size() - 2);
    const double share = place - static_cast<double>(k);
    const math::Pose &a = poses[k], &b = poses[k + 1];
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.yaw + share * (b.yaw - a.yaw)};
  }
};

}  // namespace

std::vector<math::Pose> poses_at(const vehicle::Trajectory& odometry, const std::vector<double>& times) {
  std::vector<math::Pose> poses;
  poses.reserve(times.size());
  for (const double t : times) poses.push_back(odometry.at(t));
  return poses;
}

ScanSurfaces::ScanSurfaces(const Recording& recording, const vehicle::DriveModel& model,
                           std::span<const double> parameters, const vehicle::EffectList& effects,
                           double range_noise)
    : recording_(recording),
      model_(model),
      mount_(vehicle::to_base(parameters).mount),
      range_noise_(range_noise),
      trajectory_(model.trajectory(parameters, effects)) {
  for (const Scan& scan : recording.scans) times_.push_back(scan.t + matching::reference_time(scan));
  odometry_ = poses_at(trajectory_, times_);
}

matching::Surface ScanSurfaces::surface(std::size_t index) const {
  const Scan& scan = recording_.scans[index];
  return matching::make_surface(scan, motion_in_sweep(trajectory_, mount_, scan), range_noise_);
}

math::Pose ScanSurfaces::guess(std::size_t from, std::size_t to) const {
  return conjugate(between(odometry_[from], odometry_[to]), mount_);
}

const char* ScanSurfaces::gap_between(std::size_t from, std::size_t to) const {
  if (ingest::has_gap(times_, from, to)) return "reference interrupted";
  return model_.track().covers(times_[from], times_[to]) ? nullptr : "no counts at that time";
}

matching::BeamMotion motion_in_sweep(const vehicle::Trajectory& trajectory, const math::Pose& mount,
                                     const Scan& scan) {
  const double middle = matching::reference_time(scan);
  if (!(middle > 0.0)) return [](double) { return math::Pose{}; };
  const auto sensor_at = [&](double seconds) { return compose(trajectory.at(scan.t + seconds), mount); };
  const math::Pose origin = sensor_at(middle);
  const double steps = std::ceil(2.0 * middle / settings::kSweepSpacing_s);
  Knots knots;
  knots.step = 2.0 * middle / steps;
  for (double k = 0.0; k <= steps; ++k) knots.poses.push_back(between(origin, sensor_at(k * knots.step)));
  return [knots = std::move(knots)](double seconds) { return knots.at(seconds); };
}

}  // namespace odomcalib::calib::measurement
