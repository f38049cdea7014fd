#include "calib/odometry/uncertainty.hpp"

#include <algorithm>
#include <cmath>

#include "calib/math/vector2.hpp"
#include "calib/vehicle/step_twist.hpp"

namespace odomcalib::calib::odometry {
namespace {

constexpr std::array kUnitsOfNoise = {"m/sqrt(m)", "m/sqrt(m)", "rad/sqrt(m)"};

/// m, mean of both wheels, whichever way each rolls. Headings may be cut off at half a turn.
double rolled(const math::Pose& from, const math::Pose& to, double track_width) {
  return std::max(std::hypot(to.x - from.x, to.y - from.y),
                  0.5 * track_width * std::abs(math::wrap_angle(to.yaw - from.yaw)));
}

/// An error of the heading moves all that follows sideways.
Eigen::Matrix3d carried_on(const math::Pose& from, const math::Pose& to) {
  Eigen::Matrix3d carried = Eigen::Matrix3d::Identity();
  carried(0, 2) = -(to.y - from.y);
  carried(1, 2) = to.x - from.x;
  return carried;
}

/// The covariance of the increment is in its own frame.
void grow(Eigen::Matrix3d& covariance, const math::Pose& from, const math::Pose& to,
          const Eigen::Vector3d& per_metre, double track_width) {
  const Eigen::Matrix3d carried = carried_on(from, to);
  const Eigen::Matrix3d turn = math::rotation_about_z(from.yaw);
  covariance = carried * covariance * carried.transpose() +
               rolled(from, to, track_width) * (turn * per_metre.asDiagonal() * turn.transpose());
}

math::Pose pose_of(const PoseSample& sample) { return {sample.x, sample.y, sample.yaw}; }

Eigen::Vector3d squares_of(const IncrementNoise& noise) {
  return Eigen::Vector3d(noise[0], noise[1], noise[2]).cwiseAbs2();
}

}  // namespace

ContactNoise entry_of(const IncrementNoise& noise) {
  return {{noise[0], kUnitsOfNoise[0]}, {noise[1], kUnitsOfNoise[1]}, {noise[2], kUnitsOfNoise[2]}};
}

std::optional<IncrementNoise> contact_noise_of(const Calibration& calibration) {
  if (!calibration.contact_noise) return std::nullopt;
  const auto& [forward, sideways, yaw] = *calibration.contact_noise;
  const IncrementNoise noise = {forward.value, sideways.value, yaw.value};
  const auto is_noise = [](double value) { return value >= 0.0 && std::isfinite(value); };
  return std::all_of(noise.begin(), noise.end(), is_noise) ? std::optional(noise) : std::nullopt;
}

std::array<double, 3> deviation_at_end(std::span<const PoseSample> path, const IncrementNoise& noise,
                                       double track_width) {
  const Eigen::Vector3d per_metre = squares_of(noise);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 1; k < path.size(); ++k)
    grow(covariance, pose_of(path[k - 1]), pose_of(path[k]), per_metre, track_width);
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
}

Uncertainty::Uncertainty(const Correction& correction, const IncrementNoise& noise)
    : per_metre_(squares_of(noise)), track_width_(correction.parameters(vehicle::kTrackWidth)) {
  for (Eigen::Index k = 0; k < correction.parameters.size(); ++k) {
    const bool moves_base = k <= vehicle::kTrackWidth || k >= vehicle::kBaseCount;
    if (moves_base && correction.covariance(k, k) > 0.0) unknown_.push_back(k);
  }
  covariance_ = correction.covariance(unknown_, unknown_);
  for (std::size_t first = 0; first < unknown_.size(); first += vehicle::kJetSize) {
    std::vector<vehicle::Jet> seed(correction.parameters.begin(), correction.parameters.end());
    const std::size_t end = std::min(first + vehicle::kJetSize, unknown_.size());
    for (std::size_t k = first; k < end; ++k)
      seed[static_cast<std::size_t>(unknown_[k])].v(static_cast<Eigen::Index>(k - first)) = 1.0;
    seeds_.push_back(std::move(seed));
  }
  of_twist_ = of_pose_ = Sensitivity::Zero(3, static_cast<Eigen::Index>(unknown_.size()));
}

void Uncertainty::differentiate(const DeadReckoning& reckoning, const vehicle::StepContext& interval) {
  for (std::size_t pass = 0; pass < seeds_.size(); ++pass) {
    const auto twist = twist_of(interval, std::span<const vehicle::Jet>(seeds_[pass]), reckoning.effects());
    const auto first = static_cast<Eigen::Index>(pass) * vehicle::kJetSize;
    const Eigen::Index count = std::min<Eigen::Index>(vehicle::kJetSize, of_twist_.cols() - first);
    of_twist_.block(0, first, 1, count) = twist.x.v.head(count).transpose();
    of_twist_.block(1, first, 1, count) = twist.y.v.head(count).transpose();
    of_twist_.block(2, first, 1, count) = twist.yaw.v.head(count).transpose();
  }
}

void Uncertainty::advance(const DeadReckoning& reckoning, const vehicle::StepContext& interval,
                          const math::Pose& before) {
  const math::Pose& after = reckoning.pose();
  differentiate(reckoning, interval);
  // A chord is turned by half the interval's turn, and stays as long as it is to first order.
  Eigen::Matrix3d at_begin = math::rotation_about_z(0.5 * (before.yaw + after.yaw));
  at_begin(0, 2) = -0.5 * (after.y - before.y);
  at_begin(1, 2) = 0.5 * (after.x - before.x);
  const Eigen::Matrix3d carried = carried_on(before, after);
  for (Eigen::Index k = 0; k < of_pose_.cols(); ++k) {
    const Eigen::Vector3d column = carried * of_pose_.col(k) + at_begin * of_twist_.col(k);
    of_pose_.col(k) = column;
  }
  grow(noise_, before, after, per_metre_, track_width_);
  last_noise_ = (rolled(before, after, track_width_) * per_metre_).asDiagonal();
}

void Uncertainty::forget() {
  noise_.setZero();
  of_pose_.setZero();
}

/// Written out: a product of matrices of unknown size would take memory.
Eigen::Matrix3d Uncertainty::by_parameters(const Sensitivity& sensitivity) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (Eigen::Index a = 0; a < sensitivity.cols(); ++a)
    for (Eigen::Index b = 0; b < sensitivity.cols(); ++b)
      sum += covariance_(a, b) * sensitivity.col(a) * sensitivity.col(b).transpose();
  return sum;
}

Eigen::Matrix3d Uncertainty::of_pose() const { return noise_ + by_parameters(of_pose_); }
Eigen::Matrix3d Uncertainty::of_twist() const { return last_noise_ + by_parameters(of_twist_); }

}  // namespace odomcalib::calib::odometry
