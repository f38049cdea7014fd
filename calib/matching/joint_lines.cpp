#include "calib/matching/joint_lines.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "calib/geometry/vector2.hpp"
#include "calib/statistics/median.hpp"
#include "calib/statistics/tukey.hpp"

namespace odomcalib::calib {
namespace {

constexpr int kMaxIterations = 10;
constexpr double kSettled = 0.02;  ///< sigma, a step that no longer matters

/// Normal equations of the motion with the two parameters of every line eliminated.
struct Reduced {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d spurious = Eigen::Matrix3d::Zero();  ///< what noisy directions of lines seem to tell
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

/// What the second scan's readings on one wall add up to.
struct WallTerms {
  LineSums sums;  ///< in the reference frame
  Eigen::Matrix3d motion = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> mixed = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Matrix2d line = Eigen::Matrix2d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

class Refinement {
 public:
  Refinement(const Walls& reference, const std::vector<WallPoint>& points, const Pose& start,
             const GuessPrior& prior)
      : reference_(reference), points_(points), prior_(prior), weights_(points.size(), 1.0), frame_(start) {
    estimate_.motion = start;
    for (const Wall& wall : reference.walls) lines_.push_back(wall.line);
  }

  JointEstimate run() {
    for (int i = 0; i < kMaxIterations && !estimate_.converged; ++i) {
      weigh();
      const std::vector<WallTerms> terms = fit_lines();
      const Reduced system = reduce(terms);
      const double variance = estimate_.scale * estimate_.scale;
      const Eigen::Matrix3d information = system.information + variance * prior_.information;
      const Eigen::Matrix3d damped = information + 1e-9 * information.trace() * Eigen::Matrix3d::Identity();
      const Eigen::Vector3d step =
          damped.ldlt().solve(system.gradient + variance * prior_.gradient(estimate_.motion));
      if (!step.allFinite()) break;
      estimate_.motion.x -= step(0);
      estimate_.motion.y -= step(1);
      estimate_.motion.yaw -= step(2);
      frame_ = Frame(estimate_.motion);
      estimate_.information = system.information - system.spurious;
      estimate_.converged = step.dot(information * step) < kSettled * kSettled;
    }
    return estimate_;
  }

 private:
  [[nodiscard]] Eigen::Vector2d moved(const WallPoint& point) const {
    return frame_.origin() + frame_.rotate(point.position);
  }
  [[nodiscard]] double distance(const WallPoint& point) const {
    const FittedLine& line = lines_[point.wall];
    return line.normal.dot(moved(point) - line.centre);
  }

  /// Tukey's weights for distances from the lines as they are.
  void weigh() {
    std::vector<double> normalised;
    normalised.reserve(points_.size());
    for (const WallPoint& point : points_)
      normalised.push_back(std::abs(distance(point)) / std::sqrt(point.variance));
    estimate_.scale = std::max(1.0, kMadToSigma * median_of(normalised));
    estimate_.inliers = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double weight = tukey_weight(normalised[i] / (estimate_.scale * kTukeyCut));
      weights_[i] = weight / points_[i].variance;
      if (weight > 0.0) ++estimate_.inliers;
    }
  }

  /// Lines through both scans' readings, and the sums that belong to them.
  std::vector<WallTerms> fit_lines() {
    std::vector<WallTerms> terms(reference_.walls.size());
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (weights_[i] > 0.0)
        terms[points_[i].wall].sums.add(moved(points_[i]), weights_[i], frame_.rotate(points_[i].spread));
    for (std::size_t w = 0; w < terms.size(); ++w) {
      if (terms[w].sums.count == 0) continue;
      LineSums both = reference_.walls[w].sums;
      both += terms[w].sums;
      lines_[w] = fit_line(both);
    }
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (weights_[i] > 0.0) add(points_[i], weights_[i], terms[points_[i].wall]);
    return terms;
  }

  void add(const WallPoint& point, double weight, WallTerms& terms) const {
    const FittedLine& line = lines_[point.wall];
    const Eigen::Vector2d arm = frame_.rotate(point.position);
    const Eigen::Vector2d offset = moved(point) - line.centre;
    const Eigen::Vector3d jacobian(line.normal.x(), line.normal.y(), -line.direction().dot(arm));
    const Eigen::Vector2d line_jacobian(1.0, line.direction().dot(offset));
    terms.motion += weight * jacobian * jacobian.transpose();
    terms.mixed += weight * jacobian * line_jacobian.transpose();
    terms.line += weight * line_jacobian * line_jacobian.transpose();
    terms.gradient += weight * line.normal.dot(offset) * jacobian;
    // The arm carries the noise of the distance: their mean product would turn the scan.
    const Eigen::Vector2d spread = frame_.rotate(point.spread);
    terms.gradient(2) -= weight * line.normal.dot(spread) * -line.direction().dot(spread);
  }

  /// At the fitted line the gradient of its own parameters is zero: only the matrix changes.
  [[nodiscard]] Reduced reduce(const std::vector<WallTerms>& terms) const {
    Reduced system;
    for (std::size_t w = 0; w < terms.size(); ++w) {
      const WallTerms& t = terms[w];
      if (t.sums.count == 0) continue;
      const Eigen::Matrix2d line = t.line + own_information(reference_.walls[w], lines_[w]);
      const Eigen::Matrix3d reduced = t.motion - t.mixed * line.ldlt().solve(t.mixed.transpose());
      system.information += reduced;
      system.gradient += t.gradient;
      // A line that is off by an angle takes a motion along it for one across it.
      const Eigen::Vector2d along = lines_[w].direction();
      const Eigen::Vector2d arm = t.sums.centre() - frame_.origin();
      const Eigen::Vector3d slide(along.x(), along.y(), lines_[w].normal.dot(arm));
      const double own = reference_.walls[w].sums.weight;
      const double offset_information = own * t.sums.weight / (own + t.sums.weight);
      system.spurious += offset_information * lines_[w].angle_variance * slide * slide.transpose();
    }
    return system;
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
  std::vector<double> weights_;
  std::vector<FittedLine> lines_;
  JointEstimate estimate_;
  Frame frame_;  ///< at the estimate
};

}  // namespace

JointEstimate refine_on_walls(const Walls& reference, const std::vector<WallPoint>& points, const Pose& start,
                              const GuessPrior& prior) {
  if (points.empty()) return {start};
  return Refinement(reference, points, start, prior).run();
}

}  // namespace odomcalib::calib
