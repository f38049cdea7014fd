// Where every scan (or reference pose) of all recordings was taken.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/measurement/dataset.hpp"
#include "calib/measurement/scan_path.hpp"
#include "calib/vehicle/vehicle_model.hpp"

namespace odomcalib::calib::measurement {

struct Placement {
  std::vector<ScanPath> paths;         ///< one per recording, or none
  Eigen::VectorXd parameters;          ///< that guessed and de-skewed
  ingest::Recordings recordings = {};  ///< whose scans were placed

  /// False also before anything was placed.
  [[nodiscard]] bool is_of(const Dataset& dataset) const {
    return recordings.are_those_of(dataset.recordings);
  }
};

/// All recordings or none: without walls enough to place nearly every scan of every recording there are no
/// paths, and none where motions are stated one by one.
/// @param dataset measured
/// @param trace_ranges looks for errors of the ranges; null: nothing does
/// @param known the same scans placed with other parameters; empty: nothing is known yet
Placement place_all(const Dataset& dataset, const vehicle::VehicleModel& model,
                    const RangeTracer& trace_ranges, const std::vector<ScanPath>& known = {});

}  // namespace odomcalib::calib::measurement
