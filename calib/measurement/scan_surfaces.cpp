#include "calib/measurement/scan_surfaces.hpp"

#include "calib/ingest/even_stamps.hpp"
#include "calib/measurement/sweep_motion.hpp"

namespace odomcalib::calib::measurement {

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
  return model_.track().covers(times_[from], times_[to]) ? nullptr : "no ticks";
}

}  // namespace odomcalib::calib::measurement
