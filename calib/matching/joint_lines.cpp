#include "calib/matching/joint_lines.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "calib/matching/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/tukey.hpp"
#include "calib/math/vector2.hpp"

namespace odomcalib::calib::matching {
namespace {

/// Normal equations of the motion with the two parameters of every line eliminated.
struct Reduced {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d spurious =
      Eigen::Matrix3d::Zero();  ///< information that noisy directions of lines only seem to have
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

class Refinement {
 public:
  Refinement(const Walls& reference, const std::vector<WallPoint>& points, const math::Pose& start,
             const GuessPrior& prior)
      : reference_(reference), points_(points), prior_(prior), weights_(points.size(), 1.0), frame_(start) {
    estimate_.motion = start;
    for (const Wall& wall : reference.walls) lines_.push_back(wall.line);
    for (const WallPoint& point : points) root_weights_.push_back(1.0 / std::sqrt(point.variance));
    moved_.resize(points.size());
  }

  JointEstimate run() {
    for (int i = 0; i < settings::kMostLineSteps && !estimate_.converged; ++i) {
      weigh();
      const Reduced system = reduce(fit_lines());
      const double variance = estimate_.scale * estimate_.scale;
      const Eigen::Matrix3d information = system.information + variance * prior_.information;
      const Eigen::Matrix3d damped = information + 1e-9 * information.trace() * Eigen::Matrix3d::Identity();
      const Eigen::Vector3d step =
          damped.ldlt().solve(system.gradient + variance * prior_.gradient(estimate_.motion));
      if (!step.allFinite()) break;
      estimate_.motion.x -= step(0);
      estimate_.motion.y -= step(1);
      estimate_.motion.yaw -= step(2);
      frame_ = math::Frame(estimate_.motion);
      estimate_.information = system.information - system.spurious;
      estimate_.converged = step.dot(information * step) < settings::kLinesSettled * settings::kLinesSettled;
    }
    return estimate_;
  }

 private:
  /// Tukey's weights for distances from the lines as they are.
  void weigh() {
    std::vector<double> normalised;
    normalised.reserve(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const FittedLine& line = lines_[points_[i].wall];
      moved_[i] = frame_.transform(points_[i].position);
      normalised.push_back(std::abs(line.normal.dot(moved_[i] - line.centre)) * root_weights_[i]);
    }
    estimate_.scale = std::max(1.0, math::kMadToSigma * math::median_of(normalised));
    estimate_.inliers = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double weight =
          math::tukey_weight(normalised[i] / (estimate_.scale * math::kTukeyCut)) / math::kTukeyMeanWeight;
      weights_[i] = weight * root_weights_[i] * root_weights_[i];
      if (weight > 0.0) ++estimate_.inliers;
    }
  }

  /// Lines through both scans' readings.
  /// @return what the second scan's add up to on each wall, in the axes of the reference
  std::vector<LineSums> fit_lines() {
    std::vector<LineSums> seen(reference_.walls.size());
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (weights_[i] > 0.0)
        seen[points_[i].wall].add(moved_[i], weights_[i], frame_.rotate(points_[i].spread));
    for (std::size_t w = 0; w < seen.size(); ++w) {
      if (seen[w].count == 0) continue;
      LineSums both = reference_.walls[w].sums;
      both += seen[w];
      lines_[w] = fit_line(both);
    }
    return seen;
  }

  /// At the fitted line the gradient of its own parameters is zero: only the matrix changes.
  [[nodiscard]] Reduced reduce(const std::vector<LineSums>& seen) const {
    Reduced system;
    for (std::size_t w = 0; w < seen.size(); ++w)
      if (seen[w].count > 0) add(seen[w], w, system);
    return system;
  }

  /// On one wall the Jacobian of a distance is (normal, -a), a the place of the reading along the wall from
  /// the sensor, and that by the line's offset and angle (1, s), s from the line's centre: all sums of
  /// products are moments of the readings.
  void add(const LineSums& seen, std::size_t w, Reduced& system) const {
    const FittedLine& line = lines_[w];
    const Eigen::Vector2d normal = line.normal, along = line.direction();
    const double n = seen.weight;
    const Eigen::Vector2d arm = seen.centre() - frame_.origin(), offset = seen.centre() - line.centre;
    const Eigen::Matrix2d scatter = seen.second - n * seen.centre() * seen.centre().transpose();
    const double spread = along.dot(scatter * along), tilt = normal.dot(scatter * along);
    const double a = along.dot(arm), s = along.dot(offset), d = normal.dot(offset);

    Eigen::Matrix3d motion;
    motion << n * normal * normal.transpose(), -n * a * normal, -n * a * normal.transpose(),
        spread + n * a * a;
    Eigen::Matrix<double, 3, 2> mixed;
    mixed << n * normal, n * s * normal, -n * a, -(spread + n * a * s);
    Eigen::Matrix2d own;
    own << n, n * s, n * s, spread + n * s * s;
    own += own_information(reference_.walls[w], line);
    system.information += motion - mixed * own.ldlt().solve(mixed.transpose());
    // The arm carries the noise of the distance: their mean product would turn the scan.
    const double noise = normal.dot(seen.noise * along);
    system.gradient += Eigen::Vector3d(n * d * normal.x(), n * d * normal.y(), noise - tilt - n * d * a);
    system.spurious += spurious_information(seen, w);
  }

  /// A line that is off by an angle takes a motion along it for one across it.
  [[nodiscard]] Eigen::Matrix3d spurious_information(const LineSums& seen, std::size_t w) const {
    const Eigen::Vector2d along = lines_[w].direction();
    const Eigen::Vector3d slide(along.x(), along.y(), lines_[w].normal.dot(seen.centre() - frame_.origin()));
    const double own = reference_.walls[w].sums.weight;
    const double offset_information = own * seen.weight / (own + seen.weight);
    return offset_information * lines_[w].angle_variance * slide * slide.transpose();
  }

  /// Information of the reference scan's readings about the offset and the angle of a line.
  static Eigen::Matrix2d own_information(const Wall& wall, const FittedLine& line) {
    const Eigen::Vector2d along = line.direction();
    const Eigen::Vector2d to_centre = wall.sums.centre() - line.centre;
    const double s = along.dot(to_centre);
    const Eigen::Matrix2d scatter =
        wall.sums.second - wall.sums.weight * wall.sums.centre() * wall.sums.centre().transpose();
    Eigen::Matrix2d information;
    information << wall.sums.weight, wall.sums.weight * s, wall.sums.weight * s,
        wall.sums.weight * s * s + along.dot(scatter * along);
    return information;
  }

  const Walls& reference_;
  const std::vector<WallPoint>& points_;
  const GuessPrior& prior_;
  std::vector<double> root_weights_;  ///< 1/m, by the points' variances alone
  std::vector<double> weights_;
  std::vector<Eigen::Vector2d> moved_;  ///< the points at the estimate, m
  std::vector<FittedLine> lines_;
  JointEstimate estimate_;
  math::Frame frame_;  ///< at the estimate
};

}  // namespace

JointEstimate refine_on_walls(const Walls& reference, const std::vector<WallPoint>& points,
                              const math::Pose& start, const GuessPrior& prior) {
  if (points.empty()) return {start};
  return Refinement(reference, points, start, prior).run();
}

}  // namespace odomcalib::calib::matching
