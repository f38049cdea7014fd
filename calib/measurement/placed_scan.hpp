// Where a scan was taken in a map, and the motion from one such place to another.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "calib/math/se2.hpp"
#include "calib/measurement/settings.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::measurement {

struct PlacedScan {
  double time = 0.0;           ///< s, the scan's reference time on the sensor's clock
  math::Pose pose;             ///< of the sensor in the map
  Eigen::Matrix3d covariance;  ///< x, y in map axes, yaw
};

/// Motion of the sensor in its frame at the begin.
struct PlacedMotion {
  math::Pose motion;
  Eigen::Matrix3d covariance;  ///< x, y, yaw of `motion`
};

/// First order; the two places err independently.
PlacedMotion motion_between(const PlacedScan& begin, const PlacedScan& end);

/// Pose of the sensor as the wheels have it, by time (s, on the sensor's clock): it carries places over the
/// time to a scan.
using PathOfWheels = std::function<math::Pose(double)>;
/// @param trajectory must outlive it
PathOfWheels path_of_wheels(const vehicle::Trajectory& trajectory);

/// Place by the nearest scan, if one is near: not all are placed where there are many.
/// @param places in time order
std::optional<PlacedScan> place_at(std::span<const PlacedScan> places, double time,
                                   const PathOfWheels& wheels);

/// Those of a motion's begin and end, if both are known.
struct PlacedEnds {
  PlacedScan begin, end;
};
std::optional<PlacedEnds> places_at_ends(std::span<const PlacedScan> places,
                                         const vehicle::Interval& interval, const PathOfWheels& wheels);

/// Mean of places, at least one, each carried to the time, s.
PlacedScan mean_of(std::span<const PlacedScan> places, double time, const PathOfWheels& wheels);

using settings::kMeanReach;

/// Mean of all scans within `reach` of a time, s, if there are some. What the wheels do wrong before and
/// after cancels at a steady speed. In an acceleration some of it stays, and the mean leans towards the
/// wheels that carry it: the error of one model is to be measured with other wheels than its own, that of two
/// which are compared with the own ones of each, so that both lean alike. For a motion no scan may stand for
/// both ends of it.
/// @param places in time order
std::optional<PlacedScan> mean_place(std::span<const PlacedScan> places, double time,
                                     const PathOfWheels& wheels, double reach = kMeanReach);

/// Means of the poses of a tenth of a second each, carried to their middle by the wheels. Their covariance is
/// that of independent noise, estimated from how single poses scatter about the path of the wheels.
/// Headings go on beyond half a turn.
/// @param poses in time order
std::vector<PlacedScan> placed_poses(std::span<const PoseSample> poses, const PathOfWheels& wheels);

}  // namespace odomcalib::calib::measurement
