#include "calib/reference/scan_surfaces.hpp"

#include "calib/reference/sweep_motion.hpp"

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
  return make_surface(scan, motion_in_sweep(trajectory_, mount_, scan), range_noise_);
}

Pose ScanSurfaces::guess(std::size_t from, std::size_t to) const {
  return conjugate(between(odometry_[from], odometry_[to]), mount_);
}

const char* ScanSurfaces::gap_between(std::size_t from, std::size_t to) const {
  if (has_gap(times_, from, to)) return "reference interrupted";
  return model_.track().covers(times_[from], times_[to]) ? nullptr : "no ticks";
}

}  // namespace odomcalib::calib
