// Where every scan of a recording was taken: placed one after the other in a map of walls that grows on the
// way, the map adjusted to all of them, and all placed again. Each scan's error is then its own: it does not
// add up along the drive as that of a chain of matches does.
#pragma once

#include <span>
#include <vector>

#include "calib/matching/settings.hpp"
#include "calib/measurement/adjust.hpp"
#include "calib/measurement/placed_scan.hpp"
#include "calib/measurement/sensor_pair.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::measurement {

struct ScanPath {
  std::vector<PlacedScan> scans;  ///< in time order
  std::size_t lost = 0;           ///< scans that could not be placed
  WallMap map;
  std::vector<terms::LidarFinding> lidar;  ///< errors of the ranges, if requested
  /// Lost scans are few enough for the others to be trusted.
  [[nodiscard]] bool is_usable() const;
};

struct PathOptions {
  double range_noise = matching::settings::kUsualRangeNoise_m;  ///< m
  /// Look for errors of the ranges; an offset that is found is taken out before scans are placed.
  RangeTracer trace_ranges = {};
};

/// @param parameters, effects of the model, for guesses and for de-skewing
/// @param known the same scans placed with other parameters, which change little but how they are de-skewed;
/// empty: nothing is known yet
ScanPath place_scans(const Recording& recording, const vehicle::DriveModel& model,
                     std::span<const double> parameters, const vehicle::EffectList& effects,
                     const PathOptions& options, const ScanPath& known = {});

/// Where the base was, from what is not a wheel: floors, slopes and cables act on places and headings, and
/// nominal dead reckoning loses both within minutes. Poses of the base, relative to the first one.
/// @param mount of the sensor on the base
std::vector<vehicle::Fix> fixes_of(const ScanPath& path, const math::Pose& mount);

/// Fixes by the reference poses, which are the base's own; none for recordings without.
std::vector<vehicle::Fix> fixes_of(const Recording& recording);

/// Largest drift of the chained matches against the path, in deviations that independent errors of the stated
/// covariances would have: the larger of x, y (map axes) and yaw.
double drift_of_matches(const std::vector<SensorPair>& pairs, const ScanPath& path,
                        const PathOfWheels& wheels);

/// The same pairs with motions from place to place, each that of the nearest scan; pairs without one are left
/// out.
std::vector<SensorPair> pairs_of_places(const std::vector<SensorPair>& pairs, const ScanPath& path,
                                        const PathOfWheels& wheels);

}  // namespace odomcalib::calib::measurement
