#include "calib/classical/rest_to_rest.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/classical/settings.hpp"
#include "calib/math/linear_solve.hpp"

namespace odomcalib::calib::classical {
namespace {

constexpr int kMostSteps = 20;  ///< Gauss-Newton from E_d = E_b = 1 takes three or four
constexpr double kSmallStep = 1e-12;

/// E_d, E_b, and by how much the lidar sits elsewhere than stated: m, m, rad in the frame of the base.
using Unknowns = Eigen::Matrix<double, 5, 1>;
/// Whitened residuals: two ends and what is known of the lidar's place.
using Misses = Eigen::Matrix<double, 9, 1>;

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
  if (!(move.distance >= settings::kLeastDistance_m))
    return refused("a move of less than 0.2 m", "straight method", "drive farther, better a metre");
  if (move.yaw && !(std::abs(*move.yaw) <= settings::kMostYaw_rad))
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

/// Where the robot was seen to end, from where the wheels say that it would be seen, over the lidar's error.
Eigen::Vector3d miss(const SquareRun& run, const wheels::BaseParameters& base,
                     const math::Pose& moved_lidar) {
  const math::Pose claimed = conjugate(end_of(run, base), moved_lidar);
  return {(run.end.x - claimed.x) / kLidarAtRest.position, (run.end.y - claimed.y) / kLidarAtRest.position,
          math::wrap_angle(run.end.yaw - claimed.yaw) / kLidarAtRest.yaw};
}

Misses misses(const SquarePair& pair, const wheels::BaseParameters& used, const Unknowns& x) {
  const wheels::BaseParameters base = with_errors(used, {1.0, x(0), x(1)});
  const math::Pose moved_lidar{x(2), x(3), x(4)};
  Misses out;
  out << miss(pair.ccw, base, moved_lidar), miss(pair.cw, base, moved_lidar),
      x.segment<2>(2) / kLidarByRuler.position, x(4) / kLidarByRuler.yaw;
  return out;
}

struct ExactErrors {
  Unknowns values = Unknowns::Zero();
  Unknowns std =
      Unknowns::Zero();  ///< by the lidar's error at rest and its place, none of which repetitions show
};

/// Gauss-Newton with central differences: few unknowns, and nearly linear.
ExactErrors solve_exactly(const SquarePair& pair, const wheels::BaseParameters& used) {
  constexpr double kStep = 1e-6;
  Unknowns x = Unknowns::Zero();
  x.head<2>() << used.right_radius / used.left_radius, 1.0;
  Eigen::Matrix<double, 9, 5> jacobian;
  for (int k = 0; k < kMostSteps; ++k) {
    for (int i = 0; i < x.size(); ++i) {
      const Unknowns step = kStep * Unknowns::Unit(i);
      jacobian.col(i) = (misses(pair, used, x + step) - misses(pair, used, x - step)) / (2.0 * kStep);
    }
    const Unknowns change = math::solve_independent(jacobian, -misses(pair, used, x));
    x += change;
    if (change.norm() < kSmallStep) break;
  }
  const Eigen::Matrix<double, 5, 5> information = jacobian.transpose() * jacobian;
  return {x, information.inverse().diagonal().cwiseSqrt()};
}

/// Mean displacement of the true end from the claimed one.
Eigen::Vector2d mean_miss(std::span<const SquarePair> pairs, SquareRun SquarePair::*way,
                          const wheels::BaseParameters& base) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const SquarePair& pair : pairs) {
    const SquareRun& run = pair.*way;
    const math::Pose claimed = end_of(run, base);
    sum += Eigen::Vector2d(run.end.x - claimed.x, run.end.y - claimed.y);
  }
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
  return run.moves.size() == 8 && std::hypot(claimed.x, claimed.y) < settings::kFarEnd * side &&
         std::hypot(run.end.x, run.end.y) < settings::kFarEnd * side;
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
    if (!(std::abs(move.turn) >= settings::kLeastTurn_rad))
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
  const double unseen = std::hypot(reference.yaw / turned, settings::kDiametersOfStraight);
  return SpinProposal{with_reference(math::repeated(factor), unseen),
                      with_reference(math::repeated(width), unseen * used.track_width)};
}

Result<SquareProposal> propose_from_squares(std::span<const SquarePair> pairs,
                                            const wheels::BaseParameters& used, double side) {
  if (pairs.empty())
    return Error{ErrorCode::empty, "no square in both directions", "square method",
                 "odomcalibctl straight --square"};
  std::vector<double> diameters, track;
  ExactErrors errors;
  for (const SquarePair& pair : pairs) {
    if (!is_square(pair.ccw, used, side) || !is_square(pair.cw, used, side))
      return refused("a drive that does not end near its start after four sides and four turns",
                     "square method",
                     "drive straight and spin first: the square needs lengths that are about right");
    errors = solve_exactly(pair, used);
    diameters.push_back(errors.values(0));
    track.push_back(errors.values(1));
  }
  SquareProposal proposal;
  proposal.diameters = with_reference(math::repeated(diameters), errors.std(0));
  proposal.track =
      with_reference(math::repeated(track), std::hypot(errors.std(1), settings::kDiametersOfStraight));
  proposal.formula = by_formula(pairs, used, side);
  proposal.farthest_before = farthest(pairs, used);
  proposal.farthest_after =
      farthest(pairs, with_errors(used, {1.0, proposal.diameters.mean, proposal.track.mean}));
  return proposal;
}

}  // namespace odomcalib::calib::classical
