#include "calib/classical/closed_form.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>

#include "calib/classical/settings.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/vector2.hpp"

namespace odomcalib::calib::classical {
namespace {

using Matrix5 = Eigen::Matrix<double, 5, 5>;
using Vector5 = Eigen::Matrix<double, 5, 1>;
using Indices = std::vector<std::size_t>;

Error underdetermined(const std::string& what, const std::string& motion) {
  return {ErrorCode::refused, what, "joint closed form", "record " + motion};
}

/// Rotation per wheel angle (J21, J22), linear in the data: eq. 15.
Result<Eigen::Vector2d> solve_rotation(std::span<const wheels::WheelMotion> samples, const Indices& used) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
  for (const std::size_t i : used) {
    const Eigen::Vector2d wheels(samples[i].left, samples[i].right);
    normal += wheels * wheels.transpose();
    right_side += wheels * samples[i].sensor_motion.yaw;
  }
  const math::Eigensystem eigen = math::eigensystem(normal);
  if (!(eigen.values(0) * settings::kMostConditionOfRotation * settings::kMostConditionOfRotation >
        eigen.values(1)))
    return underdetermined("the wheels always turned in the same proportion",
                           "straight lines and turns on the spot in one drive");
  return Eigen::Vector2d(
      eigen.vectors * (eigen.values.cwiseInverse().asDiagonal() * (eigen.vectors.transpose() * right_side)));
}

/// Quadratic form in (b, l_x, l_y, cos l_yaw, sin l_yaw) of the rewritten residual l (+) s (-) r (-) l: eq.
/// 17-19.
Matrix5 quadratic_form(std::span<const wheels::WheelMotion> samples, const Indices& used,
                       const Eigen::Vector2d& rotation) {
  Matrix5 form = Matrix5::Zero();
  for (const std::size_t i : used) {
    const double left = rotation(0) * samples[i].left;
    const double right = rotation(1) * samples[i].right;
    const math::Pose unit =
        math::exp_se2((right - left) / 2.0, 0.0, left + right);  // base motion for track width 1
    const math::Pose& s = samples[i].sensor_motion;
    const double c = std::cos(unit.yaw);
    const double sn = std::sin(unit.yaw);
    Eigen::Matrix<double, 2, 5> row;
    row << -unit.x, 1.0 - c, sn, s.x, -s.y,  //
        -unit.y, -sn, 1.0 - c, s.y, s.x;
    form += row.transpose() * row;
  }
  return form;
}

/// Null vector of M + lambda W, W = diag(0,0,0,1,1), scaled to a unit heading vector and positive track
/// width.
std::optional<Vector5> solution_for(const Matrix5& form, double lambda) {
  Matrix5 shifted = form;
  shifted(3, 3) += lambda;
  shifted(4, 4) += lambda;
  Vector5 x = math::null_vector(shifted);
  const double norm = std::hypot(x(3), x(4));
  if (!(norm > 1e-12)) return std::nullopt;
  x *= (x(0) < 0.0 ? -1.0 : 1.0) / norm;
  return x;
}

/// Minimum of x^T M x with |(x4, x5)| = 1. Eliminating b, l_x, l_y leaves a 2x2 eigenproblem whose two
/// eigenvalues are the two multipliers of the paper; both are evaluated and the better one is taken.
Result<Vector5> minimise_on_circle(const Matrix5& form) {
  const Eigen::MatrixXd a = form.topLeftCorner<3, 3>();
  const Eigen::VectorXd squares = math::eigensystem(a).values;
  if (!(squares(0) > 1e-12 * squares(2)))
    return underdetermined("track width and sensor position cannot be separated",
                           "turns on the spot both ways");
  const Eigen::MatrixXd b = form.topRightCorner<3, 2>();
  const Eigen::Matrix2d reduced =
      form.bottomRightCorner<2, 2>() - b.transpose() * math::solve_symmetric(a, b);
  const Eigen::VectorXd multipliers = math::eigensystem(reduced).values;
  std::optional<Vector5> best;
  for (int k = 0; k < 2; ++k) {
    const auto x = solution_for(form, -multipliers(k));
    if (x && (!best || x->dot(form * *x) < best->dot(form * *best))) best = x;
  }
  if (!best) return underdetermined("the sensor's heading is undetermined", "straight lines");
  return *best;
}

Result<wheels::BaseParameters> solve_once(std::span<const wheels::WheelMotion> samples, const Indices& used) {
  const auto rotation = solve_rotation(samples, used);
  if (!rotation) return rotation.error();
  const auto x = minimise_on_circle(quadratic_form(samples, used, rotation.value()));
  if (!x) return x.error();
  const Vector5& v = x.value();
  return wheels::BaseParameters{-rotation.value()(0) * v(0), rotation.value()(1) * v(0), v(0),
                                math::Pose{v(1), v(2), std::atan2(v(4), v(3))}};
}

math::Pose predict_base(const wheels::BaseParameters& p, const wheels::WheelMotion& sample) {
  return wheels::wheel_arc(p.left_radius * sample.left, p.right_radius * sample.right, p.track_width);
}

/// Rewritten residual: position part of (l (+) s) minus (r (+) l), and heading difference.
Eigen::Vector3d rewritten_error(const wheels::BaseParameters& p, const wheels::WheelMotion& sample) {
  const math::Pose measured = compose(p.mount, sample.sensor_motion);
  const math::Pose predicted = compose(predict_base(p, sample), p.mount);
  return math::difference(measured, predicted);
}

/// Prediction error of the sensor motion itself, in the sensor's frame.
Eigen::Vector3d prediction_error(const wheels::BaseParameters& p, const wheels::WheelMotion& sample) {
  return math::difference(sample.sensor_motion, conjugate(predict_base(p, sample), p.mount));
}

/// Value that a share of 1 - fraction of the samples does not exceed.
double percentile(std::vector<double> values, double fraction) {
  const auto index =
      static_cast<std::size_t>(std::round((1.0 - fraction) * static_cast<double>(values.size())));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::min(index, values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// Reference rule: cut the worst share by |e_xy| and, separately, the worst share by |e_yaw|.
Indices drop_worst(std::span<const wheels::WheelMotion> samples, const Indices& used,
                   const wheels::BaseParameters& p, double fraction) {
  std::vector<double> position;
  std::vector<double> heading;
  for (const std::size_t i : used) {
    const Eigen::Vector3d e = rewritten_error(p, samples[i]);
    position.push_back(e.head<2>().norm());
    heading.push_back(std::abs(e(2)));
  }
  const double position_limit = percentile(position, fraction);
  const double heading_limit = percentile(heading, fraction);
  Indices kept;
  for (std::size_t k = 0; k < used.size(); ++k)
    if (position[k] <= position_limit && heading[k] <= heading_limit) kept.push_back(used[k]);
  return kept;
}

Eigen::Vector3d rms_error(std::span<const wheels::WheelMotion> samples, const Indices& used,
                          const wheels::BaseParameters& p) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t i : used) sum += prediction_error(p, samples[i]).cwiseAbs2();
  return (sum / static_cast<double>(used.size())).cwiseSqrt();
}

Eigen::Matrix<double, 3, 6> numeric_jacobian(const wheels::BaseParameters& p,
                                             const wheels::WheelMotion& sample) {
  Eigen::Matrix<double, 3, 6> jacobian;
  for (int k = 0; k < 6; ++k) {
    wheels::BaseParameters plus = p;
    wheels::BaseParameters minus = p;
    double* fields_plus[] = {&plus.left_radius, &plus.right_radius, &plus.track_width,
                             &plus.mount.x,     &plus.mount.y,      &plus.mount.yaw};
    double* fields_minus[] = {&minus.left_radius, &minus.right_radius, &minus.track_width,
                              &minus.mount.x,     &minus.mount.y,      &minus.mount.yaw};
    constexpr double kStep = 1e-6;
    *fields_plus[k] += kStep;
    *fields_minus[k] -= kStep;
    jacobian.col(k) = (prediction_error(minus, sample) - prediction_error(plus, sample)) / (2.0 * kStep);
  }
  return jacobian;
}

/// Inverse Fisher information, eq. 24.
Eigen::Matrix<double, 6, 6> parameter_covariance(std::span<const wheels::WheelMotion> samples,
                                                 const Indices& used, const wheels::BaseParameters& p,
                                                 const Eigen::Vector3d& noise) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(6, 6);
  for (const std::size_t i : used) {
    const Eigen::Matrix<double, 3, 6> scaled =
        noise.cwiseInverse().asDiagonal() * numeric_jacobian(p, samples[i]);
    information += scaled.transpose() * scaled;
  }
  return math::solve_symmetric(information, Eigen::MatrixXd(Eigen::MatrixXd::Identity(6, 6)));
}

}  // namespace

Result<ClosedFormResult> solve_closed_form(std::span<const wheels::WheelMotion> samples,
                                           const ClosedFormOptions& options) {
  if (samples.empty())
    return Error{ErrorCode::empty, "no motion samples", "joint closed form", "record motion"};
  ClosedFormResult result;
  result.inliers.resize(samples.size());
  std::iota(result.inliers.begin(), result.inliers.end(), std::size_t{0});
  for (int round = 0; round <= options.rounds; ++round) {
    const auto estimate = solve_once(samples, result.inliers);
    if (!estimate) return estimate.error();
    result.parameters = estimate.value();
    result.rms = rms_error(samples, result.inliers, result.parameters);
    if (round == 0) result.first_rms = result.rms;
    // The reference cuts once more after its last estimate; what it calls kept is what this leaves.
    if (options.rounds > 0)
      result.inliers = drop_worst(samples, result.inliers, result.parameters, options.drop_fraction);
    if (result.inliers.empty()) return underdetermined("outlier rounds removed all samples", "more motion");
  }
  result.covariance = parameter_covariance(samples, result.inliers, result.parameters, result.rms);
  return result;
}

}  // namespace odomcalib::calib::classical
