#include "tests/sim/world/ray_bound.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

namespace odomcalib::sim {

namespace {

/// Pose of the base (x, y in the room, yaw), then what is to be learned, wheels as radii.
constexpr Eigen::Index kState = 3 + static_cast<Eigen::Index>(kLearned);
using State = Eigen::Matrix<double, kState, 1>;
using StateMatrix = Eigen::Matrix<double, kState, kState>;
enum Column : Eigen::Index { kX, kY, kYaw, kLeftRadius, kRightRadius, kTrack, kLidarX, kLidarY, kLidarYaw };

constexpr double kProbe = 1e-6;     // m and rad, for derivatives of ranges
constexpr double kSteepest = 50.0;  // m per m and m per rad; beams that strike a corner tell nothing
/// m per m, 1 / cos(80 deg): flatter beams would promise what no real wall keeps (they are left out of the
/// published bounds of matching, too).
constexpr double kGrazing = 5.76;

/// Before the first reading nothing is known but that the robot is no toy and no truck.
StateMatrix ignorance() {
  State deviation;
  deviation << 10.0, 10.0, 10.0, 0.05, 0.05, 0.3, 0.5, 0.5, 3.0;
  return deviation.cwiseAbs2().asDiagonal();
}

class Path {
 public:
  explicit Path(const std::vector<TruthSample>& samples) : samples_(samples) {}

  [[nodiscard]] Pose at(double t) const {
    const auto k = index(t);
    const TruthSample &a = samples_[k], &b = samples_[k + 1];
    const double share = (t - a.t) / (b.t - a.t);
    return {a.pose.x + share * (b.pose.x - a.pose.x), a.pose.y + share * (b.pose.y - a.pose.y),
            a.pose.yaw + share * (b.pose.yaw - a.pose.yaw)};
  }
  [[nodiscard]] double end() const { return samples_.back().t; }
  [[nodiscard]] const TruthSample& sample(std::size_t k) const { return samples_[k]; }
  /// Index of the sample interval that holds t.
  [[nodiscard]] std::size_t index(double t) const {
    const double period = samples_[1].t - samples_[0].t;
    return std::min(static_cast<std::size_t>(std::max(0.0, t / period)), samples_.size() - 2);
  }

 private:
  const std::vector<TruthSample>& samples_;
};

/// Range by position and direction of the beam; nothing where a corner is near or the wall is grazed.
std::optional<Eigen::Vector3d> range_gradient(const Room& room, const Pose& eye, double direction) {
  const auto cast = [&](double dx, double dy, double dyaw) {
    const auto hit = room.cast({eye.x + dx, eye.y + dy}, direction + dyaw);
    return hit ? hit->range : 1e9;
  };
  Eigen::Vector3d gradient(cast(kProbe, 0, 0) - cast(-kProbe, 0, 0), cast(0, kProbe, 0) - cast(0, -kProbe, 0),
                           cast(0, 0, kProbe) - cast(0, 0, -kProbe));
  gradient /= 2.0 * kProbe;
  if (gradient.cwiseAbs().maxCoeff() > kSteepest || gradient.head<2>().norm() > kGrazing) return std::nullopt;
  return gradient;
}

class Recursion {
 public:
  Recursion(const SimulationConfig& config, const SimulatedRun& run)
      : config_(config), run_(run), path_(run.path), covariance_(ignorance()) {}

  std::array<double, kLearned> deviations() {
    double now = path_.sample(0).t;
    for (const Scan& scan : run_.recording.scans) {
      const double middle =
          scan.t + 0.5 * scan.time_increment.value() * static_cast<double>(scan.ranges.size());
      if (middle > path_.end()) break;
      roll(now, middle);
      now = middle;
      see(scan, middle);
    }
    std::array<double, kLearned> result{};
    for (std::size_t k = 0; k < kLearned; ++k) {
      const auto column = static_cast<Eigen::Index>(k) + kLeftRadius;
      result[k] = (k < 2 ? 2.0 : 1.0) * std::sqrt(covariance_(column, column));
    }
    return result;
  }

 private:
  /// Wheels carry the pose and what is not known about it from one time to another.
  void roll(double from, double to) {
    for (double t = from; t < to;) {
      const std::size_t k = path_.index(t + 1e-9);
      const double next = std::min(to, path_.sample(k + 1).t);
      step(path_.sample(k), path_.sample(k + 1), path_.at(t), path_.at(next), next - t);
      t = next;
    }
  }

  void step(const TruthSample& begin, const TruthSample& end, const Pose& a, const Pose& b, double dt) {
    const double left = 0.5 * (begin.rate[kLeft] + end.rate[kLeft]) * dt;
    const double right = 0.5 * (begin.rate[kRight] + end.rate[kRight]) * dt;
    const Geometry& g = run_.truth;
    const double yaw = 0.5 * (a.yaw + b.yaw);
    Eigen::Matrix<double, 3, 2> by_travel;  // of the pose, by the travel of each wheel
    by_travel << 0.5 * std::cos(yaw), 0.5 * std::cos(yaw), 0.5 * std::sin(yaw), 0.5 * std::sin(yaw),
        -1.0 / g.track_width, 1.0 / g.track_width;
    StateMatrix transition = StateMatrix::Identity();
    transition(kX, kYaw) = -(b.y - a.y);
    transition(kY, kYaw) = b.x - a.x;
    transition.block<3, 1>(0, kLeftRadius) = left * by_travel.col(0);
    transition.block<3, 1>(0, kRightRadius) = right * by_travel.col(1);
    transition(kYaw, kTrack) = -(b.yaw - a.yaw) / g.track_width;
    covariance_ = (transition * covariance_ * transition.transpose()).eval();
    const double slip = config_.body.slip_noise * config_.body.slip_noise;
    const Eigen::Vector2d travelled(0.5 * g.left_diameter * std::abs(left),
                                    0.5 * g.right_diameter * std::abs(right));
    covariance_.topLeftCorner<3, 3>() += by_travel * (slip * travelled).asDiagonal() * by_travel.transpose();
  }

  /// One scan: its readings are independent of each other.
  void see(const Scan& scan, double middle) {
    StateMatrix information = StateMatrix::Zero();
    const Pose base = path_.at(middle);
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam)
      if (scan.ranges[beam] > 0.0F) add(scan, beam, base, information);
    const StateMatrix inverse = covariance_.ldlt().solve(StateMatrix::Identity());
    covariance_ = (inverse + information).ldlt().solve(StateMatrix::Identity());
    covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  }

  /// A shift of the base at the middle of the sweep carries the whole sweep along.
  void add(const Scan& scan, std::size_t beam, const Pose& base, StateMatrix& information) const {
    const Pose then = path_.at(scan.t + scan.time_increment.value() * static_cast<double>(beam));
    const Pose eye = compose(then, run_.truth.lidar);
    const auto gradient = range_gradient(config_.room, eye, eye.yaw + scan.angle(beam));
    if (!gradient) return;
    const double c = std::cos(then.yaw), s = std::sin(then.yaw);
    State row = State::Zero();
    row.head<2>() = gradient->head<2>();
    row(kYaw) = (*gradient)(2) - (*gradient)(0) * (eye.y - base.y) + (*gradient)(1) * (eye.x - base.x);
    row(kLidarX) = c * (*gradient)(0) + s * (*gradient)(1);
    row(kLidarY) = -s * (*gradient)(0) + c * (*gradient)(1);
    row(kLidarYaw) = (*gradient)(2);
    const LidarOptions& lidar = config_.lidar;
    const double variance =
        lidar.range_noise * lidar.range_noise + lidar.resolution * lidar.resolution / 12.0;
    information += row * row.transpose() / variance;
  }

  const SimulationConfig& config_;
  const SimulatedRun& run_;
  Path path_;
  StateMatrix covariance_;
};

}  // namespace

std::array<double, kLearned> ray_bound(const SimulationConfig& config, const SimulatedRun& run) {
  return Recursion(config, run).deviations();
}

}  // namespace odomcalib::sim
