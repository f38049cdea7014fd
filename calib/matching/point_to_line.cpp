#include "calib/matching/point_to_line.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

#include "calib/statistics/median.hpp"

namespace odomcalib::calib {
namespace {

constexpr std::size_t kMinPoints = 20;
constexpr double kMinNormalAgreement = 0.8;  ///< cosine between the two scans' normals
constexpr double kMinIncidence = 0.2;        ///< cosine; flatter beams say little and err much
constexpr double kTukey = 4.685;             ///< 95 % efficiency at the normal distribution
constexpr double kSurfaceFloor = 1e-3;       ///< m, unevenness of surfaces and angular error of beams
constexpr int kCoarseIterations = 4;
constexpr int kDampedFrom = 12;
constexpr double kSettled = 0.05;  ///< sigma, a step that no longer matters

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

Eigen::Vector2d transform(const Pose& pose, const Eigen::Vector2d& p) {
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  return {pose.x + c * p.x() - s * p.y(), pose.y + s * p.x() + c * p.y()};
}

Eigen::Vector2d rotate(double yaw, const Eigen::Vector2d& p) {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

/// Range noise acts along the beam; across the line only its projection counts. Reference lines average their
/// own readings, but each reading serves several lines, so over the scan the reference adds as much as the
/// scan itself.
double distance_variance(const SurfacePoint& point, const Eigen::Vector2d& normal, double yaw,
                         double range_noise) {
  const double incidence = rotate(yaw, point.beam).dot(normal);
  return 2.0 * (range_noise * range_noise * incidence * incidence + kSurfaceFloor * kSurfaceFloor);
}

std::vector<Correspondence> correspond(const MatchReference& reference, const Surface& scan, const Pose& pose,
                                       double gate, double range_noise) {
  std::vector<Correspondence> pairs;
  pairs.reserve(scan.points.size());
  for (const SurfacePoint& point : scan.points) {
    const Eigen::Vector2d moved = transform(pose, point.position);
    const auto [index, squared] = reference.nearest(moved);
    const SurfacePoint& partner = reference.surface().points[index];
    if (squared > gate * gate || !partner.has_line) continue;
    if (point.has_line && rotate(pose.yaw, point.normal).dot(partner.normal) < kMinNormalAgreement) continue;
    if (rotate(pose.yaw, point.beam).dot(partner.normal) > -kMinIncidence) continue;
    pairs.push_back({point.position, partner.anchor, partner.normal,
                     distance_variance(point, partner.normal, pose.yaw, range_noise)});
  }
  return pairs;
}

double distance(const Correspondence& pair, const Pose& pose) {
  return pair.normal.dot(transform(pose, pair.position) - pair.anchor);
}

/// Robust sigma of the distances in units of their expectation, at least 1 so that good matches stay good.
double residual_scale(const std::vector<Correspondence>& pairs, const Pose& pose) {
  std::vector<double> magnitudes;
  magnitudes.reserve(pairs.size());
  for (const Correspondence& pair : pairs)
    magnitudes.push_back(std::abs(distance(pair, pose)) / std::sqrt(pair.variance));
  return kMadToSigma * median_of(std::move(magnitudes));
}

Linearised linearise(const std::vector<Correspondence>& pairs, const Pose& pose, double scale) {
  Linearised system;
  for (const Correspondence& pair : pairs) {
    const double r = distance(pair, pose);
    const double z = r / (std::sqrt(pair.variance) * scale * kTukey);
    if (std::abs(z) >= 1.0) continue;
    const double weight = (1.0 - z * z) * (1.0 - z * z) / pair.variance;
    const Eigen::Vector2d turned = rotate(pose.yaw, pair.position);
    const Eigen::Vector3d jacobian(pair.normal.x(), pair.normal.y(),
                                   pair.normal.y() * turned.x() - pair.normal.x() * turned.y());
    system.information += weight * jacobian * jacobian.transpose();
    system.gradient += weight * r * jacobian;
    ++system.inliers;
  }
  return system;
}

/// Translation information after eliminating yaw, taken about the centre of the points so that it does not
/// depend on where the sensor's origin lies.
void judge_observability(const Eigen::Matrix3d& information, MatchResult& result) {
  if (!(information(2, 2) > 0.0)) return;
  const Eigen::Matrix2d schur = information.topLeftCorner<2, 2>() - information.topRightCorner<2, 1>() *
                                                                        information.bottomLeftCorner<1, 2>() /
                                                                        information(2, 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(schur);
  result.eigenvalue_ratio = std::max(eigen.eigenvalues()(0), 0.0) / std::max(eigen.eigenvalues()(1), 1e-300);
  result.weak_direction = eigen.eigenvectors().col(0);
}

std::size_t count_lines(const Surface& surface) {
  return static_cast<std::size_t>(std::count_if(surface.points.begin(), surface.points.end(),
                                                [](const SurfacePoint& p) { return p.has_line; }));
}

double gate_at(int iteration, const MatchOptions& options) {
  // Geometric decrease from the first gate to a few times the distance between neighbouring beams.
  const double last = std::max(0.10, 6.0 * options.range_noise);
  const double gate = options.max_distance * std::pow(0.6, iteration);
  return std::max(gate, last);
}

void conclude(MatchResult& result, const Linearised& system, double scale, std::size_t lines, bool converged,
              const MatchOptions& options) {
  result.inliers = system.inliers;
  result.overlap = static_cast<double>(system.inliers) / static_cast<double>(lines);
  result.residual = scale;
  judge_observability(system.information, result);
  if (result.overlap < options.min_overlap || system.inliers < kMinPoints)
    result.status = MatchStatus::no_overlap;
  else if (result.eigenvalue_ratio < options.min_eigenvalue_ratio)
    result.status = MatchStatus::degenerate;
  else
    result.status = converged ? MatchStatus::ok : MatchStatus::not_converged;
  if (result.eigenvalue_ratio > 0.0)
    result.covariance =
        system.information.ldlt().solve(Eigen::Matrix3d::Identity()) * std::max(1.0, scale * scale);
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

struct MatchReference::Tree {
  Surface surface;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return surface.points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t point, std::size_t axis) const {
    return surface.points[point].position(static_cast<Eigen::Index>(axis));
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
  using Index =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Tree>, Tree, 2, std::size_t>;
  std::unique_ptr<Index> kd_tree;
};

MatchReference::MatchReference(Surface surface) : tree_(std::make_unique<Tree>()) {
  tree_->surface = std::move(surface);
  tree_->kd_tree = std::make_unique<Tree::Index>(2, *tree_, nanoflann::KDTreeSingleIndexAdaptorParams(8));
  if (!tree_->surface.points.empty()) tree_->kd_tree->buildIndex();
}
MatchReference::~MatchReference() = default;
MatchReference::MatchReference(MatchReference&&) noexcept = default;
MatchReference& MatchReference::operator=(MatchReference&&) noexcept = default;

const Surface& MatchReference::surface() const { return tree_->surface; }

std::pair<std::size_t, double> MatchReference::nearest(const Eigen::Vector2d& position) const {
  std::size_t index = 0;
  double squared = 0.0;
  tree_->kd_tree->knnSearch(position.data(), 1, &index, &squared);
  return {index, squared};
}

MatchResult match_point_to_line(const MatchReference& reference, const Surface& scan, const Pose& guess,
                                const MatchOptions& options) {
  MatchResult result;
  result.motion = guess;
  const std::size_t lines = count_lines(scan);
  if (lines < kMinPoints || count_lines(reference.surface()) < kMinPoints) {
    result.status = MatchStatus::too_few_points;
    return result;
  }
  Linearised system;
  double scale = 1.0;
  bool converged = false;
  for (int i = 0; i < options.max_iterations && !converged; ++i) {
    result.iterations = i + 1;
    const auto pairs = correspond(reference, scan, result.motion, gate_at(i, options), options.range_noise);
    if (pairs.size() < kMinPoints) {
      result.status = MatchStatus::no_overlap;
      return result;
    }
    scale = std::max(1.0, residual_scale(pairs, result.motion));
    system = linearise(pairs, result.motion, scale);
    const Eigen::Matrix3d damped =
        system.information + 1e-9 * system.information.trace() * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d step = damped.ldlt().solve(system.gradient);
    if (!step.allFinite()) break;
    const double length =
        i < kDampedFrom ? 1.0 : 0.5;  // late, correspondences that flip to and fro are averaged
    result.motion.x -= length * step(0);
    result.motion.y -= length * step(1);
    result.motion.yaw -= length * step(2);
    // In units of the match's own uncertainty; smaller steps only follow correspondences that change back and
    // forth.
    converged =
        i >= kCoarseIterations && step.dot(system.information * step) < kSettled * kSettled * scale * scale;
  }
  conclude(result, system, scale, lines, converged, options);
  return result;
}

}  // namespace odomcalib::calib
