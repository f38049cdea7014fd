#include "calib/classical/rest_to_rest.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace odomcalib::calib::classical {
namespace {

constexpr double kLeastDistance = 0.2;          ///< m; below it the errors at rest are a per cent of the move
constexpr double kMostYaw = 0.5;                ///< rad in a straight line
constexpr double kLeastTurn = math::kPi / 2.0;  ///< rad
constexpr double kFarEnd = 0.5;  ///< of a side: a drive that ends farther from its start is no square
constexpr int kMostSteps = 20;   ///< Gauss-Newton from E_d = E_b = 1 takes three or four
constexpr double kSmallStep = 1e-12;

using Unknowns = Eigen::Vector2d;  ///< E_d, E_b

Error refused(const std::string& what, const std::string& where, const std::string& remedy) {
  return {ErrorCode::refused, what, where, remedy};
}

/// Travel along the arc that has this chord.
double arc_length(double chord, double yaw) {
  const double half = yaw / 2.0;
  return std::abs(half) < 1e-6 ? chord : chord * half / std::sin(half);
}

/// @param error of the mean that repetitions do not show
math::Repeated with_reference(math::Repeated values, double error) {
  if (values.std >= 0.0) values.std = std::hypot(values.std, error);
  return values;
}

math::Repeated times(math::Repeated values, double factor) {
  values.mean *= factor;
  values.spread *= factor;
  if (values.std > 0.0) values.std *= factor;
  return values;
}

double mean_distance(std::span<const StraightMove> moves) {
  double sum = 0.0;
  for (const StraightMove& move : moves) sum += move.distance;
  return sum / static_cast<double>(moves.size());
}

std::optional<Error> unfit(const StraightMove& move) {
  if (!(move.distance >= kLeastDistance))
    return refused("a move of less than 0.2 m", "straight method", "drive farther, better a metre");
  if (move.yaw && !(std::abs(*move.yaw) <= kMostYaw))
    return refused("a move that turned by more than half a radian", "straight method",
                   "check that both wheels are driven and counted");
  if (!(move.wheels.left * move.wheels.right > 0.0))
    return refused("wheels that turned against each other", "straight method", "odomcalibctl check --nudge");
  return std::nullopt;
}

math::Pose end_of(const SquareRun& run, const wheels::BaseParameters& base) {
  math::Pose pose;
  for (const WheelTurns& move : run.moves)
    pose = compose(pose, wheels::wheel_arc(base.left_radius * move.left, base.right_radius * move.right,
                                           base.track_width));
  return pose;
}

/// Where the robot ended, seen from where the wheels say: m, m, and the heading as m at the end of a side.
Eigen::Vector3d miss(const SquareRun& run, const wheels::BaseParameters& base, double side) {
  const math::Pose claimed = end_of(run, base);
  return {run.end.x - claimed.x, run.end.y - claimed.y, side * math::wrap_angle(run.end.yaw - claimed.yaw)};
}

Eigen::Matrix<double, 6, 1> miss(const SquarePair& pair, const wheels::BaseParameters& used,
                                 const Unknowns& errors, double side) {
  const wheels::BaseParameters base = with_errors(used, {1.0, errors(0), errors(1)});
  Eigen::Matrix<double, 6, 1> out;
  out << miss(pair.ccw, base, side), miss(pair.cw, base, side);
  return out;
}

/// Gauss-Newton with central differences: two unknowns, and nearly linear.
Unknowns solve_exactly(const SquarePair& pair, const wheels::BaseParameters& used, double side) {
  constexpr double kStep = 1e-6;
  Unknowns errors(used.right_radius / used.left_radius, 1.0);
  for (int k = 0; k < kMostSteps; ++k) {
    Eigen::Matrix<double, 6, 2> jacobian;
    for (int i = 0; i < 2; ++i) {
      const Unknowns step = kStep * Unknowns::Unit(i);
      jacobian.col(i) =
          (miss(pair, used, errors + step, side) - miss(pair, used, errors - step, side)) / (2.0 * kStep);
    }
    const Unknowns change = jacobian.householderQr().solve(-miss(pair, used, errors, side));
    errors += change;
    if (change.norm() < kSmallStep) break;
  }
  return errors;
}

/// Mean displacement of the true end from the claimed one.
Eigen::Vector2d mean_miss(std::span<const SquarePair> pairs, SquareRun SquarePair::*way,
                          const wheels::BaseParameters& base) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const SquarePair& pair : pairs) sum += miss(pair.*way, base, 0.0).head<2>();
  return sum / static_cast<double>(pairs.size());
}

double farthest(std::span<const SquarePair> pairs, const wheels::BaseParameters& base) {
  return std::max(mean_miss(pairs, &SquarePair::ccw, base).norm(),
                  mean_miss(pairs, &SquarePair::cw, base).norm());
}

GeometryErrors by_formula(std::span<const SquarePair> pairs, const wheels::BaseParameters& used,
                          double side) {
  const Eigen::Vector2d ccw = mean_miss(pairs, &SquarePair::ccw, used);
  const Eigen::Vector2d cw = mean_miss(pairs, &SquarePair::cw, used);
  // A square driven to the left ends at 2 side (-a + b, a - b), one to the right at 2 side (-a - b, -a - b):
  // a, the angle that each turn lacks, and b, the angle that each side is bent to the left.
  const double alpha = (-(cw.x() + ccw.x()) + (ccw.y() - cw.y())) / (8.0 * side);
  const double beta = (-(cw.x() - ccw.x()) - (cw.y() + ccw.y())) / (8.0 * side);
  // E_d = (R + b/2) / (R - b/2) with R = (side / 2) / sin(beta / 2), the radius that a side is bent to.
  const double bend = used.track_width * std::sin(beta / 2.0) / side;
  const double quarter = math::kPi / 2.0;
  return {1.0, used.right_radius / used.left_radius * (1.0 + bend) / (1.0 - bend),
          quarter / (quarter - alpha)};
}

bool is_square(const SquareRun& run, const wheels::BaseParameters& used, double side) {
  const math::Pose claimed = end_of(run, used);
  return run.moves.size() == 8 && std::hypot(claimed.x, claimed.y) < kFarEnd * side &&
         std::hypot(run.end.x, run.end.y) < kFarEnd * side;
}

}  // namespace

Result<StraightProposal> propose_radii(std::span<const StraightMove> moves,
                                       const wheels::BaseParameters& used, const ReferenceError& reference) {
  if (moves.empty())
    return Error{ErrorCode::empty, "no straight move", "straight method", "odomcalibctl straight"};
  std::vector<double> scale, left, right, ratio;
  bool headings = true;
  for (const StraightMove& move : moves) {
    if (const auto why = unfit(move)) return *why;
    const double yaw = move.yaw.value_or(0.0);
    const double way = arc_length(move.distance, yaw);
    const double turn_left = std::abs(move.wheels.left), turn_right = std::abs(move.wheels.right);
    scale.push_back(2.0 * way / (used.left_radius * turn_left + used.right_radius * turn_right));
    headings = headings && move.yaw.has_value();
    // Backwards, a wheel that is ahead of the other turns the robot the other way.
    const double ahead = (move.wheels.left > 0.0 ? 1.0 : -1.0) * used.track_width * yaw / 2.0;
    left.push_back((way - ahead) / turn_left);
    right.push_back((way + ahead) / turn_right);
    ratio.push_back(right.back() / left.back());
  }
  // Relative to the mean way: of the distance, and of half the difference of both wheels' ways.
  const double way = mean_distance(moves);
  const double of_scale = reference.position / way;
  const double of_half_difference = used.track_width * reference.yaw / (2.0 * way);
  StraightProposal proposal{with_reference(math::repeated(scale), of_scale), {}, {}, std::nullopt};
  if (!headings) {
    proposal.left = times(proposal.scale, used.left_radius);
    proposal.right = times(proposal.scale, used.right_radius);
    return proposal;
  }
  const double of_wheel = std::hypot(of_scale, of_half_difference);
  proposal.left = with_reference(math::repeated(left), of_wheel * used.left_radius);
  proposal.right = with_reference(math::repeated(right), of_wheel * used.right_radius);
  proposal.diameters = with_reference(math::repeated(ratio), 2.0 * of_half_difference);
  return proposal;
}

Result<SpinProposal> propose_track_width(std::span<const SpinMove> moves, const wheels::BaseParameters& used,
                                         const ReferenceError& reference) {
  if (moves.empty())
    return Error{ErrorCode::empty, "no turn on the spot", "spin method", "odomcalibctl spin"};
  std::vector<double> factor, width;
  for (const SpinMove& move : moves) {
    if (!(std::abs(move.turn) >= kLeastTurn))
      return refused("a turn of less than a quarter of one", "spin method",
                     "turn farther, better a whole turn");
    width.push_back((used.right_radius * move.wheels.right - used.left_radius * move.wheels.left) /
                    move.turn);
    if (!(width.back() > 0.0))
      return refused("a turn against that of the wheels", "spin method", "odomcalibctl check --nudge");
    factor.push_back(width.back() / used.track_width);
  }
  double turned = 0.0;
  for (const SpinMove& move : moves) turned += std::abs(move.turn) / static_cast<double>(moves.size());
  const double of_turn = reference.yaw / turned;
  return SpinProposal{with_reference(math::repeated(factor), of_turn),
                      with_reference(math::repeated(width), of_turn * used.track_width)};
}

Result<SquareProposal> propose_from_squares(std::span<const SquarePair> pairs,
                                            const wheels::BaseParameters& used, double side) {
  if (pairs.empty())
    return Error{ErrorCode::empty, "no square in both directions", "square method",
                 "odomcalibctl straight --square"};
  std::vector<double> diameters, track;
  for (const SquarePair& pair : pairs) {
    if (!is_square(pair.ccw, used, side) || !is_square(pair.cw, used, side))
      return refused("a drive that does not end near its start after four sides and four turns",
                     "square method",
                     "drive straight and spin first: the square needs lengths that are about right");
    const Unknowns errors = solve_exactly(pair, used, side);
    diameters.push_back(errors(0));
    track.push_back(errors(1));
  }
  // An error of the heading at the end is one of eight quarter turns and of the bend of eight sides; one of
  // the position is about as much over a side.
  const double at_end = std::hypot(kLidarAtRest.yaw, kLidarAtRest.position / side);
  SquareProposal proposal;
  proposal.diameters = with_reference(math::repeated(diameters), used.track_width * at_end / (4.0 * side));
  proposal.track = with_reference(math::repeated(track), at_end / (2.0 * math::kPi));
  proposal.formula = by_formula(pairs, used, side);
  proposal.farthest_before = farthest(pairs, used);
  proposal.farthest_after =
      farthest(pairs, with_errors(used, {1.0, proposal.diameters.mean, proposal.track.mean}));
  return proposal;
}

}  // namespace odomcalib::calib::classical
