#include "calib/report/scan_overlay.hpp"

#include <algorithm>
#include <cmath>

#include "calib/report/settings.hpp"
#include "calib/validation/drive_error.hpp"
#include "calib/validation/folds.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::report {
namespace {

/// Pairs of one fold one after the other.
struct Block {
  std::size_t recording = 0, fold = 0;
  vehicle::Interval interval;
  double motion = 0.0;  ///< m, turns by the lever that they act with
};

std::vector<Block> blocks_of(std::span<const measurement::FitData> data,
                             const std::vector<std::size_t>& folds) {
  std::vector<Block> blocks;
  std::size_t k = 0;
  for (std::size_t d = 0; d < data.size(); ++d)
    for (const measurement::SensorPair& pair : data[d].pairs) {
      const std::size_t fold = folds[k++];
      if (blocks.empty() || blocks.back().recording != d || blocks.back().fold != fold)
        blocks.push_back({d, fold, pair.interval, 0.0});
      blocks.back().interval.end = pair.interval.end;
      blocks.back().motion += std::hypot(pair.motion.x, pair.motion.y) +
                              validation::settings::kHeadingLever_m * std::abs(pair.motion.yaw);
    }
  return blocks;
}

/// Evenly spread; of the sensor that begins.
std::vector<const Scan*> scans_within(const Recording& recording, const vehicle::Interval& interval) {
  std::vector<const Scan*> all;
  for (const Scan& scan : recording.scans)
    if (scan.t >= interval.begin && scan.t <= interval.end && scan.sensor == recording.scans.front().sensor)
      all.push_back(&scan);
  std::vector<const Scan*> some;
  const std::size_t most = std::min(settings::kOverlaidScans, all.size());
  for (std::size_t k = 0; k < most; ++k)
    some.push_back(all[k * (all.size() - 1) / std::max<std::size_t>(most - 1, 1)]);
  return some;
}

/// s after the scan's stamp; zero where nobody knows.
double time_of(const Scan& scan, std::size_t beam) {
  if (!scan.times.empty()) return static_cast<double>(scan.times[beam]);
  return scan.time_increment.value_or(0.0) * static_cast<double>(beam);
}

/// Points that the beams hit, in the frame of the base at the scan's stamp, for a base that moves as this
/// says.
std::vector<std::array<double, 2>> points_of(const Scan& scan, const vehicle::Trajectory& moves,
                                             const math::Pose& mount) {
  std::vector<std::array<double, 2>> points;
  const math::Pose origin = moves.at(scan.t);
  const std::size_t step = 1 + scan.ranges.size() / settings::kOverlaidBeams;
  for (std::size_t beam = 0; beam < scan.ranges.size(); beam += step) {
    const double range = static_cast<double>(scan.ranges[beam]);
    if (!(range > scan.range_min) || !(range < scan.range_max)) continue;
    const math::Pose sensor = compose(between(origin, moves.at(scan.t + time_of(scan, beam))), mount);
    const double angle = sensor.yaw + scan.angle(beam);
    points.push_back({sensor.x + range * std::cos(angle), sensor.y + range * std::sin(angle)});
  }
  return points;
}

std::array<double, 3> numbers_of(const math::Pose& pose) {
  return {pose.x, pose.y, math::wrap_angle(pose.yaw)};
}

}  // namespace

std::vector<ScanTrace> scan_overlay(const measurement::Dataset& dataset, const vehicle::EffectList& effects,
                                    const estimation::FitResult& fit, const std::vector<bool>& fixed) {
  const wheels::BaseParameters& nominal = dataset.nominal;
  const bool stated = nominal.left_radius > 0.0 && nominal.right_radius > 0.0 && nominal.track_width > 0.0;
  const auto folds = validation::folds_of(dataset.data);
  if (dataset.has_motions_alone() || !dataset.reference_is_scans() || !stated || !validation::hold_out(folds))
    return {};
  const auto blocks = blocks_of(dataset.data, folds);
  const Block& block = *std::max_element(blocks.begin(), blocks.end(),
                                         [](const Block& a, const Block& b) { return a.motion < b.motion; });
  const Eigen::VectorXd found = validation::without_fold(fit, folds, block.fold, fixed);
  const Eigen::VectorXd stated_wheels = validation::with_wheels(found, effects, nominal);
  const vehicle::DriveModel& model = *dataset.data[block.recording].model;
  const vehicle::Trajectory after = model.trajectory(vehicle::as_span(found), effects),
                            before = model.trajectory(vehicle::as_span(stated_wheels), effects);
  const math::Pose mount = vehicle::to_base(vehicle::as_span(found)).mount;
  std::vector<ScanTrace> overlay;
  for (const Scan* scan : scans_within(dataset.recordings.view()[block.recording], block.interval))
    overlay.push_back({points_of(*scan, after, mount),
                       numbers_of(between(before.at(block.interval.begin), before.at(scan->t))),
                       numbers_of(between(after.at(block.interval.begin), after.at(scan->t)))});
  return overlay;
}

}  // namespace odomcalib::calib::report
