// Amount of each kind of motion in a drive, and what it is enough for: by nominal dimensions, before anything
// is measured.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/wheels/wheel_motion.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::classical {

/// Stretches as long as a pair of scans that a solve compares.
struct MotionKind {
  std::size_t stretches = 0;
  double amount = 0.0;  ///< m driven straight, rad turned
};

struct MotionKinds {
  MotionKind forward, backward;                  ///< straight, m
  MotionKind spin_left, spin_right;              ///< on the spot, rad
  MotionKind arc_left, arc_right;                ///< in bends, rad
  std::size_t stops = 0;                         ///< of kStop_s at least, between motions or at either end
  double way_forward = 0.0, way_backward = 0.0;  ///< m, straight and in bends: not on the spot

  [[nodiscard]] double left() const { return spin_left.amount + arc_left.amount; }
  [[nodiscard]] double right() const { return spin_right.amount + arc_right.amount; }
};

/// @param base nominal; positive lengths
MotionKinds motion_kinds(const wheels::WheelTrack& track, const wheels::BaseParameters& base);

enum class Supply { missing, little, enough };

/// The motion that one or some of the parameters need, and how much of it there is.
struct ParameterSupply {
  std::string parameters;                   ///< names as in calibration files, "a, b"
  std::string shown_by;                     ///< the motion
  double first_way = 0.0, other_way = 0.0;  ///< there is: forward and backward, m; or left and right, rad
  double each_way = 0.0;                    ///< what is enough
  bool of_turns = false;                    ///< rad, otherwise m
  Supply supply = Supply::missing;
};

/// missing: less than what the straight and spin methods refuse to do without; little: less than enough in
/// either direction (docs/user/motions.md).
std::vector<ParameterSupply> parameter_supply(const MotionKinds& kinds);

/// The motion to record: the lines or the turns that are hardly there, or both where the wheels always turned
/// in the same proportion. Nothing where no motion is missing.
std::optional<std::string> missing_motion(std::span<const wheels::WheelMotion> motions);

/// The remedy of an estimate that the motion does not determine: to record what is missing, or more of each.
std::string record_more(std::span<const wheels::WheelMotion> motions);

}  // namespace odomcalib::calib::classical
