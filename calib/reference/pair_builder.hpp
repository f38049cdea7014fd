// Keyframes from a recording, and the sensor's motion between neighbouring ones.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "calib/reference/sensor_pair.hpp"
#include "proto/recording.hpp"

namespace odomcalib::calib {

struct PairOptions {
  double distance = 0.10;      ///< m, a new keyframe after this travel ...
  double rotation = 0.175;     ///< rad (10 degrees), ... or this rotation ...
  double duration = 0.5;       ///< s, ... or this time, if the wheels turned at all
  double min_overlap = 0.4;
};

struct PairSet {
  std::vector<SensorPair> pairs;
  std::map<std::string, std::size_t> rejected;  ///< reason -> number of pairs
  double range_noise = 0.0;                     ///< m; 0 for recordings without scans
};

/// Pairs of a recording. Scans are de-skewed and matched from guesses made with `parameters` and `effects`; poses and
/// tuples are used as they are.
PairSet build_pairs(const Recording& recording, const DriveModel& model, std::span<const double> parameters,
                    const EffectList& effects, const PairOptions& options);

}  // namespace odomcalib::calib
