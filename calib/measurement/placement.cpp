#include "calib/measurement/placement.hpp"

#include <utility>

#include "calib/measurement/placed_scan.hpp"

namespace odomcalib::calib::measurement {
namespace {

ScanPath path_of_poses(const Recording& recording, const vehicle::DriveModel& drive,
                       const vehicle::VehicleModel& model) {
  const vehicle::Trajectory trajectory = drive.trajectory(vehicle::as_span(model.parameters), model.effects);
  ScanPath path;
  path.scans = placed_poses(recording.poses, path_of_wheels(trajectory));
  return path;
}

ScanPath path_of(const Dataset& dataset, std::size_t recording, const vehicle::VehicleModel& model,
                 const RangeTracer& trace_ranges, const ScanPath& known) {
  const Recording& given = dataset.recordings[recording];
  const vehicle::DriveModel& drive = *dataset.models[recording];
  if (dataset.reference_is_base()) return path_of_poses(given, drive, model);
  const PathOptions options{dataset.pair_sets[recording].range_noise, trace_ranges};
  return place_scans(given, drive, vehicle::as_span(model.parameters), model.effects, options, known);
}

}  // namespace

Placement place_all(const Dataset& dataset, const vehicle::VehicleModel& model,
                    const RangeTracer& trace_ranges, const std::vector<ScanPath>& known) {
  Placement placement{{}, model.parameters, dataset.recordings};
  if (!dataset.reference_is_scans() && !dataset.reference_is_base()) return placement;
  for (std::size_t i = 0; i < dataset.recordings.size(); ++i) {
    ScanPath path = path_of(dataset, i, model, trace_ranges, known.empty() ? ScanPath{} : known[i]);
    if (!path.is_usable()) return {{}, model.parameters, dataset.recordings};
    placement.paths.push_back(std::move(path));
  }
  return placement;
}

}  // namespace odomcalib::calib::measurement
