#include "calib/matching/point_to_line.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "calib/matching/joint_lines.hpp"
#include "calib/matching/settings.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/median.hpp"
#include "calib/math/tukey.hpp"
#include "calib/math/vector2.hpp"

namespace odomcalib::calib::matching {
namespace {

/// One point of the scan against one line of the reference.
struct Correspondence {
  Eigen::Vector2d position;  ///< in the scan's frame
  Eigen::Vector2d anchor;
  Eigen::Vector2d normal;
  double variance = 0.0;  ///< of the distance, m^2
};

struct Linearised {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  std::size_t inliers = 0;
};

/// Range noise acts along the beam; across the line only its projection counts. Reference lines average their
/// own readings, but each reading serves several lines, so over the scan the reference adds as much as the
/// scan itself.
double pair_variance(double cosine_of_incidence, double range_noise) {
  return 2.0 * distance_variance(cosine_of_incidence, range_noise);
}

std::vector<Correspondence> correspond(const MatchReference& reference, const Surface& scan,
                                       const math::Pose& pose, double gate, double range_noise,
                                       std::size_t stride) {
  const math::Frame frame(pose);
  std::vector<Correspondence> pairs;
  pairs.reserve(scan.points.size());
  for (std::size_t k = 0; k < scan.points.size(); k += stride) {
    const SurfacePoint& point = scan.points[k];
    const Eigen::Vector2d moved = frame.transform(point.position);
    const auto nearest = reference.order().nearest(moved, gate);
    if (!nearest) continue;
    const SurfacePoint& partner = reference.surface().points[nearest->index];
    if (!partner.has_line) continue;
    if (point.has_line && frame.rotate(point.normal).dot(partner.normal) < settings::kNormalsAgree) continue;
    const double cosine = frame.rotate(point.beam).dot(partner.normal);
    if (cosine > -settings::kFlattestBeam) continue;
    pairs.push_back({point.position, partner.anchor, partner.normal, pair_variance(cosine, range_noise)});
  }
  return pairs;
}

double distance(const Correspondence& pair, const math::Frame& frame) {
  return pair.normal.dot(frame.transform(pair.position) - pair.anchor);
}

/// Robust sigma of the distances in units of their expectation, at least 1 so that good matches stay good.
double residual_scale(const std::vector<Correspondence>& pairs, const math::Frame& frame) {
  std::vector<double> magnitudes;
  magnitudes.reserve(pairs.size());
  for (const Correspondence& pair : pairs)
    magnitudes.push_back(std::abs(distance(pair, frame)) / std::sqrt(pair.variance));
  return math::kMadToSigma * math::median_of(std::move(magnitudes));
}

Linearised linearise(const std::vector<Correspondence>& pairs, const math::Frame& frame, double scale) {
  Linearised system;
  for (const Correspondence& pair : pairs) {
    const double r = distance(pair, frame);
    const double weight =
        math::tukey_weight(r / (std::sqrt(pair.variance) * scale * math::kTukeyCut)) / pair.variance;
    if (!(weight > 0.0)) continue;
    const Eigen::Vector2d turned = frame.rotate(pair.position);
    const Eigen::Vector3d jacobian(pair.normal.x(), pair.normal.y(),
                                   pair.normal.y() * turned.x() - pair.normal.x() * turned.y());
    system.information += weight * jacobian * jacobian.transpose();
    system.gradient += weight * r * jacobian;
    ++system.inliers;
  }
  return system;
}

/// Whether the reference saw the part of the wall that a moved point is next to. Points beyond the ends of
/// what one scan saw would be pulled back there, and the motion towards zero.
bool lies_on(const Wall& wall, const Eigen::Vector2d& moved, const Eigen::Vector2d& beam, double gate) {
  const double s = place_of_beam(wall.line, moved, beam);
  return s >= wall.low && s <= wall.high && std::abs(wall.line.normal.dot(moved - wall.line.centre)) <= gate;
}

/// Both beams come from the same side of the wall, neither too flat, and the scan sees a line that is alike.
bool faces(const Wall& wall, const SurfacePoint& partner, const SurfacePoint& point, const math::Frame& frame,
           double cosine) {
  if (std::abs(cosine) < settings::kFlattestWallBeam || cosine * partner.beam.dot(wall.line.normal) < 0.0)
    return false;
  return !point.has_line ||
         std::abs(frame.rotate(point.normal).dot(wall.line.normal)) >= settings::kNormalsAgree;
}

std::vector<WallPoint> points_on_walls(const MatchReference& reference, const Surface& scan,
                                       const math::Pose& pose, double gate, double range_noise) {
  const math::Frame frame(pose);
  std::vector<WallPoint> found;
  const Walls& walls = reference.walls();
  for (const SurfacePoint& point : scan.points) {
    const Eigen::Vector2d moved = frame.transform(point.position);
    const auto nearest = reference.order().nearest(moved, gate);
    if (!nearest) continue;
    const std::size_t w = walls.of_point[nearest->index];
    if (w == Walls::kNone) continue;
    const Wall& wall = walls.walls[w];
    const Eigen::Vector2d beam = frame.rotate(point.beam);
    const double cosine = beam.dot(wall.line.normal);
    if (!lies_on(wall, moved, beam, gate) ||
        !faces(wall, reference.surface().points[nearest->index], point, frame, cosine) ||
        range_to_line(point, wall.line.normal.dot(moved - wall.line.centre), cosine) > scan.far_limit)
      continue;
    found.push_back({point.position, w, distance_variance(cosine, range_noise), range_noise * point.beam});
  }
  return found;
}

std::size_t count_lines(const Surface& surface) {
  return static_cast<std::size_t>(std::count_if(surface.points.begin(), surface.points.end(),
                                                [](const SurfacePoint& p) { return p.has_line; }));
}

/// A few times the distance between neighbouring beams.
double last_gate(const MatchOptions& options) {
  return std::max(settings::kLastGate_m, settings::kLastGateSigmas * options.range_noise);
}

double gate_at(int iteration, const MatchOptions& options) {
  return std::max(options.max_distance * std::pow(settings::kGateShrinks, iteration), last_gate(options));
}

/// The variance of the distances in units of the expected one; 1 where chance alone may have made more of it.
/// The median absolute deviation of n normal values scatters by 1.17 / sqrt(n) (Rousseeuw and Croux, JASA 88,
/// 1993: efficiency 37 %).
double excess_variance(double scale, std::size_t inliers) {
  constexpr double kChance = settings::kExcessSigmas * 1.17;
  const bool is_chance =
      scale < 1.0 + kChance / std::sqrt(static_cast<double>(std::max<std::size_t>(inliers, 1)));
  return is_chance ? 1.0 : scale * scale;
}

void conclude(MatchResult& result, const Linearised& system, double scale, std::size_t lines, bool converged,
              const MatchOptions& options) {
  result.inliers = system.inliers;
  result.overlap = static_cast<double>(system.inliers) / static_cast<double>(lines);
  result.residual = scale;
  result.converged = converged;
  const double variance = excess_variance(scale, system.inliers);
  result.information = system.information / variance;
  const Observability translation = observability(system.information);
  result.eigenvalue_ratio = translation.ratio;
  result.weak_direction = translation.weak_direction;
  if (result.overlap < options.min_overlap || system.inliers < settings::kFewestPoints)
    result.status = MatchStatus::no_overlap;
  else if (result.eigenvalue_ratio < options.min_eigenvalue_ratio)
    result.status = MatchStatus::degenerate;
  else
    result.status = converged ? MatchStatus::ok : MatchStatus::not_converged;
  if (result.eigenvalue_ratio > 0.0)
    result.covariance = math::inverse_symmetric(system.information) * variance;
}

}  // namespace

std::string to_string(MatchStatus status) {
  switch (status) {
    case MatchStatus::ok:
      return "ok";
    case MatchStatus::too_few_points:
      return "too_few_points";
    case MatchStatus::no_overlap:
      return "no_overlap";
    case MatchStatus::degenerate:
      return "degenerate";
    case MatchStatus::not_converged:
      return "not_converged";
  }
  return "unknown";
}

std::vector<Eigen::Vector2d> positions(const Surface& surface) {
  std::vector<Eigen::Vector2d> found;
  found.reserve(surface.points.size());
  for (const SurfacePoint& point : surface.points) found.push_back(point.position);
  return found;
}

MatchReference::MatchReference(Surface surface, double range_noise)
    : surface_(std::move(surface)), walls_(find_walls(surface_, range_noise)), order_(positions(surface_)) {}

namespace {

/// State of the iteration on local lines.
struct LocalMatch {
  math::Pose motion;
  GuessPrior prior;
  Linearised system;
  double scale = 1.0;
  int iterations = 0;
  bool converged = false;
};

/// Far from the solution a part of the points shows the way as well as all of them.
std::size_t stride_at(int iteration, std::size_t points) {
  return iteration < settings::kCoarseSteps ? std::max<std::size_t>(1, points / settings::kCoarsePoints) : 1;
}

/// One Gauss-Newton step; false when there is nothing to step on.
bool iterate(const MatchReference& reference, const Surface& scan, const MatchOptions& options,
             double settled, LocalMatch& match) {
  const int i = match.iterations++;
  const auto pairs = correspond(reference, scan, match.motion, gate_at(i, options), options.range_noise,
                                stride_at(i, scan.points.size()));
  if (pairs.size() < settings::kFewestPoints) return false;
  const math::Frame frame(match.motion);
  match.scale = std::max(1.0, residual_scale(pairs, frame));
  match.system = linearise(pairs, frame, match.scale);
  const double variance = match.scale * match.scale;
  const Eigen::Matrix3d information = match.system.information + variance * match.prior.information;
  const Eigen::Matrix3d damped = information + 1e-9 * information.trace() * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d gradient = match.system.gradient + variance * match.prior.gradient(match.motion);
  const Eigen::Vector3d step = math::solve_symmetric(damped, gradient);
  if (!step.allFinite()) return false;
  // Late, correspondences that flip to and fro are averaged.
  const double length = i < settings::kDampedFrom ? 1.0 : 0.5;
  match.motion.x -= length * step(0);
  match.motion.y -= length * step(1);
  match.motion.yaw -= length * step(2);
  // In units of the match's own uncertainty; smaller steps only follow correspondences that change back and
  // forth.
  const double largest = settled * match.scale;
  match.converged = i >= settings::kCoarseSteps && step.dot(information * step) < largest * largest;
  return true;
}

/// False when too few correspondences are left.
bool settle(const MatchReference& reference, const Surface& scan, const MatchOptions& options, double settled,
            LocalMatch& match) {
  match.converged = false;
  while (match.iterations < options.max_iterations && !match.converged)
    if (!iterate(reference, scan, options, settled, match)) return false;
  return true;
}

/// True when the walls carry the match: then motion, information and scale are theirs.
bool refine(const MatchReference& reference, const Surface& scan, const MatchOptions& options,
            LocalMatch& match) {
  const auto points = points_on_walls(reference, scan, match.motion, last_gate(options), options.range_noise);
  const JointEstimate joint = refine_on_walls(reference.walls(), points, match.motion, match.prior);
  if (!joint.converged || joint.inliers < settings::kFewestPoints || 2 * joint.inliers < match.system.inliers)
    return false;
  match.motion = joint.motion;
  match.system.information = joint.information;
  match.scale = joint.scale;
  match.converged = true;
  return true;
}

}  // namespace

MatchResult match_point_to_line(const MatchReference& reference, const Surface& scan, const math::Pose& guess,
                                const MatchOptions& options) {
  MatchResult result;
  result.motion = guess;
  const std::size_t lines = count_lines(scan);
  if (lines < settings::kFewestPoints || count_lines(reference.surface()) < settings::kFewestPoints) {
    result.status = MatchStatus::too_few_points;
    return result;
  }
  LocalMatch match;
  match.motion = guess;
  if (options.guess_is_near) match.iterations = settings::kCoarseSteps;
  match.prior = {guess, options.guess_information};
  result.status = MatchStatus::no_overlap;
  if (!settle(reference, scan, options, settings::kPointsSettled, match)) return result;
  if (!refine(reference, scan, options, match) &&
      !settle(reference, scan, options, settings::kPointsSettledAlone, match))
    return result;
  result.motion = match.motion;
  result.iterations = match.iterations;
  conclude(result, match.system, match.scale, lines, match.converged, options);
  return result;
}

Observability observability(const Eigen::Matrix3d& information) {
  if (!(information(2, 2) > 0.0)) return {};
  const Eigen::Matrix2d schur = information.topLeftCorner<2, 2>() - information.topRightCorner<2, 1>() *
                                                                        information.bottomLeftCorner<1, 2>() /
                                                                        information(2, 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(schur);
  return {std::max(eigen.eigenvalues()(0), 0.0) / std::max(eigen.eigenvalues()(1), 1e-300),
          eigen.eigenvectors().col(0)};
}

}  // namespace odomcalib::calib::matching
