// Straight lines, turns on the spot and squares from rest to rest: corrected lengths from each repetition,
// and their mean. The reference is a lidar that saw the robot at rest before and after, or a person with a
// tape.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calib/math/repeated.hpp"
#include "calib/wheels/wheel_motion.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::classical {

/// The three systematic errors of a differential drive as factors (J. Borenstein, L. Feng: Measurement and
/// correction of systematic odometry errors in mobile robots, IEEE Transactions on Robotics and Automation
/// 12(6), 1996).
struct GeometryErrors {
  double scale = 1.0;      ///< E_s: mean wheel diameter, true over nominal
  double diameters = 1.0;  ///< E_d: true right diameter over true left diameter
  double track = 1.0;      ///< E_b: track width, true over nominal
};

inline GeometryErrors errors_of(const wheels::BaseParameters& truth, const wheels::BaseParameters& nominal) {
  return {(truth.left_radius + truth.right_radius) / (nominal.left_radius + nominal.right_radius),
          truth.right_radius / truth.left_radius, truth.track_width / nominal.track_width};
}

/// Inverse of errors_of; the sensor's pose is that of `nominal`.
inline wheels::BaseParameters with_errors(const wheels::BaseParameters& nominal,
                                          const GeometryErrors& errors) {
  const double sum = errors.scale * (nominal.left_radius + nominal.right_radius);
  wheels::BaseParameters truth = nominal;
  truth.left_radius = sum / (1.0 + errors.diameters);
  truth.right_radius = errors.diameters * truth.left_radius;
  truth.track_width = errors.track * nominal.track_width;
  return truth;
}

/// Error of the reference that is the same in every repetition between the same two places, so that the
/// spread does not show it: standard deviations in m and rad.
struct ReferenceError {
  double position = 0.0, yaw = 0.0;
};
/// Mean of five scan matches at rest, a metre apart (twenty simulated robots: 0.24 mm, 0.19 mrad).
inline constexpr ReferenceError kLidarAtRest{3e-4, 2e-4};
/// A tape read to a millimetre, a mark on the floor read to a quarter of a degree (uniform within it).
inline constexpr ReferenceError kTapeAndMark{3e-4, 1.3e-3};
/// Where the lidar sits, as a ruler and the eye tell before a calibration does.
inline constexpr ReferenceError kLidarByRuler{0.02, 0.05};

/// Wheel rotations of one move from rest to rest, rad, forward positive.
struct WheelTurns {
  double left = 0.0, right = 0.0;
};

/// A straight move as it really was.
struct StraightMove {
  WheelTurns wheels;
  double distance = 0.0;      ///< m from where it began to where it ended, positive in either direction
  std::optional<double> yaw;  ///< change of heading, rad, counter-clockwise; a tape shows none
};

struct StraightProposal {
  math::Repeated scale;                     ///< E_s
  math::Repeated left, right;               ///< radii, m; without headings one factor for both
  std::optional<math::Repeated> diameters;  ///< E_d, from the headings
};

/// Corrected radii: travelled over claimed distance, and unequal wheels from the change of heading.
/// @param used the lengths that the wheels' claims were made with; its track width turns headings into a
/// difference of travel
/// Errors: refused when a move is shorter than 0.2 m, or turns by more than half a radian.
Result<StraightProposal> propose_radii(std::span<const StraightMove> moves,
                                       const wheels::BaseParameters& used,
                                       const ReferenceError& reference = kLidarAtRest);

/// A turn on the spot as it really was.
struct SpinMove {
  WheelTurns wheels;
  double turn = 0.0;  ///< rad, counter-clockwise, whole turns counted
};

struct SpinProposal {
  math::Repeated track;        ///< E_b
  math::Repeated track_width;  ///< m
};

/// Corrected track width: what the rims rolled against each other over the true angle.
/// @param used diameters that are right already, as a straight metre leaves them: the track width inherits
/// their error, and its deviation holds that of settings::kDiametersOfStraight
/// Errors: refused when a turn is less than a quarter of one.
Result<SpinProposal> propose_track_width(std::span<const SpinMove> moves, const wheels::BaseParameters& used,
                                         const ReferenceError& reference = kLidarAtRest);

/// One drive around a square and back to its start, four sides and four turns.
struct SquareRun {
  std::vector<WheelTurns> moves;
  math::Pose end;  ///< true pose at the end in the frame of the start, heading within half a turn of the
                   ///< wheels' claim
};

/// One drive counter-clockwise and one clockwise.
struct SquarePair {
  SquareRun ccw, cw;
};

struct SquareProposal {
  math::Repeated diameters, track;  ///< E_d, E_b by the exact equations
  GeometryErrors formula;           ///< E_d, E_b of the published first-order equations
  double farthest_before = 0.0,
         farthest_after = 0.0;  ///< E_max,syst: larger distance of both mean ends from where odometry says, m
};

/// UMBmark: E_d and E_b from where squares driven both ways end, each pair of drives by itself. E_s does not
/// show in a closed figure; the scale of `used` stands.
/// Exact: E_d and E_b with which dead reckoning ends where the lidar saw the robot end, least squares over
/// positions and headings, each by its deviation. The lidar may sit elsewhere than stated (kLidarByRuler):
/// ends a decimetre away are seen turned and shifted by millimetres then. Formula: eq. 11 to 17 of the paper,
/// mean of its x and y forms.
/// @param side nominal length of a side, m
/// Errors: refused without a pair, or when a run is no square.
Result<SquareProposal> propose_from_squares(std::span<const SquarePair> pairs,
                                            const wheels::BaseParameters& used, double side);

}  // namespace odomcalib::calib::classical
