// What a fit works on: the wheels' model of a recording and the sensor motions measured in it.
#pragma once

#include <vector>

#include "calib/measurement/placed_scan.hpp"
#include "calib/measurement/sensor_pair.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::measurement {

/// One recording: the model of its wheels and what the sensor saw.
struct FitData {
  const vehicle::DriveModel* model = nullptr;
  std::vector<SensorPair> pairs;
  std::vector<PlacedScan> places = {};  ///< of its scans in a map, in time order; empty without one
};

}  // namespace odomcalib::calib::measurement
