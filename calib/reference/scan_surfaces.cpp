#include "calib/reference/scan_surfaces.hpp"

#include <cmath>

namespace odomcalib::calib {

std::vector<Pose> poses_at(const Trajectory& odometry, const std::vector<double>& times) {
  std::vector<Pose> poses;
  poses.reserve(times.size());
  for (const double t : times) poses.push_back(odometry.at(t));
  return poses;
}

bool has_gap(const std::vector<double>& times, std::size_t from, std::size_t to) {
  for (std::size_t k = from; k < to; ++k)
    if (times[k + 1] - times[k] > kMaxGap) return true;
  return false;
}

ScanSurfaces::ScanSurfaces(const Recording& recording, const DriveModel& model,
                           std::span<const double> parameters, const EffectList& effects, double range_noise)
    : recording_(recording),
      model_(model),
      mount_(to_base(parameters).mount),
      range_noise_(range_noise),
      trajectory_(model.trajectory(parameters, effects)) {
  for (const Scan& scan : recording.scans) times_.push_back(scan.t + reference_time(scan));
  odometry_ = poses_at(trajectory_, times_);
}

Surface ScanSurfaces::surface(std::size_t index) const {
  const Scan& scan = recording_.scans[index];
  return make_surface(scan, beam_motion(scan), range_noise_);
}

Pose ScanSurfaces::guess(std::size_t from, std::size_t to) const {
  return conjugate(between(odometry_[from], odometry_[to]), mount_);
}

const char* ScanSurfaces::gap_between(std::size_t from, std::size_t to) const {
  if (has_gap(times_, from, to)) return "reference interrupted";
  return model_.track().covers(times_[from], times_[to]) ? nullptr : "no ticks";
}

/// Sensor motion inside the sweep from its middle, interpolated between three odometry poses.
BeamMotion ScanSurfaces::beam_motion(const Scan& scan) const {
  const double middle = reference_time(scan);
  if (!(middle > 0.0)) return [](double) { return Pose{}; };
  const Pose base = trajectory_.at(scan.t + middle);
  const Pose before = log_se2(conjugate(between(base, trajectory_.at(scan.t)), mount_));
  const Pose after = log_se2(conjugate(between(base, trajectory_.at(scan.t + 2.0 * middle)), mount_));
  return [=](double seconds) {
    const double share = (seconds - middle) / middle;
    const Pose& w = share < 0.0 ? before : after;
    const double f = std::abs(share);
    return exp_se2(f * w.x, f * w.y, f * w.yaw);
  };
}

}  // namespace odomcalib::calib
