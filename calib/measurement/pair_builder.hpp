// Keyframes from a recording, and the sensor's motion between neighbouring ones.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "calib/measurement/sensor_pair.hpp"
#include "calib/measurement/settings.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::measurement {

struct PairOptions {
  double distance = settings::kPairDistance_m;    ///< m, a new keyframe after this travel ...
  double rotation = settings::kPairRotation_rad;  ///< rad (14 degrees), ... or this rotation ...
  double duration = settings::kPairDuration_s;    ///< s, ... or this time, if the wheels turned at all
  double min_overlap = settings::kPairOverlap;
  bool rough = false;  ///< scans matched one way only, for a first look
};

/// The customary keyframe spacing of 0.5 m and 0.5 rad. A pose reference does not drift and its error does
/// not grow with the baseline: there, and errors of its time stamps weigh less.
inline PairOptions pose_pair_options() {
  return {settings::kPosePairDistance_m, settings::kPosePairRotation_rad, settings::kPosePairDuration_s,
          settings::kPairOverlap};
}

struct PairSet {
  std::vector<SensorPair> pairs;
  std::map<std::string, std::size_t> rejected;  ///< reason -> number of pairs
  std::size_t unmatched = 0;                    ///< of these, scans that did not match
  std::size_t partial = 0;                      ///< of the pairs, those that leave a direction open
  std::size_t stood = 0;                ///< left out: the wheels turned, the scans show a robot that stood
  double range_noise = 0.0;             ///< m; 0 for recordings without scans
  std::size_t readings = 0, beams = 0;  ///< of a scan, medians: beams that met something, of all
};

/// Pairs of a recording. Scans are de-skewed and matched from guesses made with `parameters` and `effects`;
/// poses come at a spacing of their own, tuples as they are.
PairSet build_pairs(const Recording& recording, const vehicle::DriveModel& model,
                    std::span<const double> parameters, const vehicle::EffectList& effects,
                    const PairOptions& options);

}  // namespace odomcalib::calib::measurement
