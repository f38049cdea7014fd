#include "calib/estimators/joint.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

namespace odomcalib::calib {
namespace {

constexpr double kStudentDof = 4.0;
constexpr double kOutlier = 5.0;         ///< sigma of a standardised residual vector
constexpr int kNoiseRounds = 4;          ///< noise and weights are settled over this many outer rounds
constexpr double kBlockSeconds = 5.0;    ///< cluster length of the robust covariance
constexpr double kMinRelativePivot = 1e-12;

/// Stacked residuals and Jacobians of all recordings, before weighting.
struct Stack {
  Eigen::MatrixXd residual;  ///< 3 n x 1
  Eigen::MatrixXd jacobian;  ///< 3 n x parameters
  std::vector<std::size_t> first;  ///< first pair of each recording, and the total
  std::vector<double> headings;    ///< of the sensor at each pair's begin
};

std::vector<Interval> intervals_of(const std::vector<SensorPair>& pairs) {
  std::vector<Interval> intervals;
  intervals.reserve(pairs.size());
  for (const SensorPair& pair : pairs) intervals.push_back(pair.interval);
  return intervals;
}

Eigen::Vector3d difference(const Pose& measured, const Pose& predicted) {
  return {measured.x - predicted.x, measured.y - predicted.y, wrap_angle(measured.yaw - predicted.yaw)};
}

std::span<const double> as_span(const Eigen::VectorXd& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

Stack make_stack(std::span<const FitData> data, const EffectList& effects, const Eigen::VectorXd& p, bool derivatives) {
  Stack stack;
  std::size_t total = 0;
  for (const FitData& d : data) total += d.pairs.size();
  stack.residual.resize(static_cast<Eigen::Index>(3 * total), 1);
  if (derivatives) stack.jacobian.resize(stack.residual.rows(), p.size());
  std::size_t row = 0;
  for (const FitData& d : data) {
    stack.first.push_back(row);
    const auto intervals = intervals_of(d.pairs);
    Eigen::MatrixXd jacobian;
    const auto predicted = derivatives ? d.model->predict(as_span(p), effects, intervals, jacobian)
                                       : d.model->predict(as_span(p), effects, intervals);
    if (derivatives) stack.jacobian.middleRows(static_cast<Eigen::Index>(3 * row), jacobian.rows()) = jacobian;
    const Trajectory trajectory = d.model->trajectory(as_span(p), effects);
    for (std::size_t k = 0; k < d.pairs.size(); ++k) {
      stack.residual.block<3, 1>(static_cast<Eigen::Index>(3 * (row + k)), 0) =
          difference(d.pairs[k].motion, predicted[k]);
      stack.headings.push_back(trajectory.at(d.pairs[k].interval.begin).yaw + p(kMountYaw));
    }
    row += d.pairs.size();
  }
  stack.first.push_back(row);
  return stack;
}

/// Applies `op(whitener, block)` recording by recording.
template <typename Operation>
void for_each_recording(std::span<const FitData> data, const Stack& stack, const std::vector<NoiseModel>& noise,
                        const std::vector<double>& weights, Eigen::MatrixXd& rows, Operation op) {
  for (std::size_t d = 0; d < data.size(); ++d) {
    const std::size_t count = data[d].pairs.size();
    if (count == 0) continue;
    const Whitener whitener(data[d].pairs, std::span(stack.headings).subspan(stack.first[d], count), noise[d],
                            std::span(weights).subspan(stack.first[d], count));
    Eigen::MatrixXd block = rows.middleRows(static_cast<Eigen::Index>(3 * stack.first[d]),
                                            static_cast<Eigen::Index>(3 * count));
    op(whitener, block);
    rows.middleRows(static_cast<Eigen::Index>(3 * stack.first[d]), block.rows()) = block;
  }
}

Eigen::MatrixXd standardised(std::span<const FitData> data, const Stack& stack, const std::vector<NoiseModel>& noise) {
  const std::vector<double> ones(stack.headings.size(), 1.0);
  Eigen::MatrixXd z = stack.residual;
  for_each_recording(data, stack, noise, ones, z,
                     [](const Whitener& w, Eigen::MatrixXd& block) { w.standardise(block); });
  return z;
}

Eigen::MatrixXd whitened(std::span<const FitData> data, const Stack& stack, const std::vector<NoiseModel>& noise,
                         const std::vector<double>& weights, Eigen::MatrixXd rows) {
  for_each_recording(data, stack, noise, weights, rows,
                     [](const Whitener& w, Eigen::MatrixXd& block) { w.apply(block); });
  return rows;
}

double median_magnitude(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Robust scale of the given axes over pairs [first, last) of a standardised residual.
double mad_scale(const Eigen::MatrixXd& z, std::size_t first, std::size_t last, std::initializer_list<int> axes) {
  std::vector<double> magnitudes;
  for (std::size_t k = first; k < last; ++k)
    for (const int axis : axes) magnitudes.push_back(std::abs(z(static_cast<Eigen::Index>(3 * k) + axis, 0)));
  return 1.4826 * median_magnitude(std::move(magnitudes));
}

/// Lag-1 correlation of winsorised values over neighbouring pairs.
double lag_correlation(const Eigen::MatrixXd& z, const FitData& data, std::size_t first, int axis) {
  double products = 0.0;
  double squares = 0.0;
  const auto value = [&](std::size_t k) {
    return std::clamp(z(static_cast<Eigen::Index>(3 * (first + k)) + axis, 0), -2.5, 2.5);
  };
  for (std::size_t k = 1; k < data.pairs.size(); ++k) {
    if (!data.pairs[k].follows_previous) continue;
    products += value(k) * value(k - 1);
    squares += 0.5 * (value(k) * value(k) + value(k - 1) * value(k - 1));
  }
  return squares > 0.0 ? std::clamp(products / squares, -0.48, 0.3) : 0.0;
}

/// Robust scale of recording d on these axes when its noise model has `member` set to `value`.
double scale_with(std::span<const FitData> data, const Stack& stack, std::vector<NoiseModel>& noise, std::size_t d,
                  double NoiseModel::*member, double value, std::initializer_list<int> axes) {
  noise[d].*member = value;
  return mad_scale(standardised(data, stack, noise), stack.first[d], stack.first[d + 1], axes);
}

/// Smallest process noise that explains the spread of the residuals: the scale falls monotonically with it.
void settle_process_noise(std::span<const FitData> data, const Stack& stack, std::vector<NoiseModel>& noise,
                          std::size_t d, double NoiseModel::*member, double largest, std::initializer_list<int> axes) {
  if (scale_with(data, stack, noise, d, member, 0.0, axes) <= 1.0) return;
  double low = largest * 1e-6;
  double high = largest;
  for (int i = 0; i < 16; ++i) {
    const double middle = std::sqrt(low * high);
    (scale_with(data, stack, noise, d, member, middle, axes) > 1.0 ? low : high) = middle;
  }
  noise[d].*member = high;
}

std::vector<NoiseModel> estimate_noise(std::span<const FitData> data, const Stack& stack,
                                       std::vector<NoiseModel> noise) {
  for (std::size_t d = 0; d < data.size(); ++d) {
    const std::size_t first = stack.first[d];
    const std::size_t last = stack.first[d + 1];
    if (first == last) continue;
    noise[d] = NoiseModel{};
    noise[d].matcher_scale = std::clamp(mad_scale(standardised(data, stack, noise), first, last, {0, 1, 2}), 0.3, 1.0);
    settle_process_noise(data, stack, noise, d, &NoiseModel::process_rotation, 1.0, {2});
    settle_process_noise(data, stack, noise, d, &NoiseModel::process_translation, 1.0, {0, 1});
  }
  const Eigen::MatrixXd z = standardised(data, stack, noise);
  for (std::size_t d = 0; d < data.size(); ++d)
    for (int axis = 0; axis < 3; ++axis)
      noise[d].correlation[static_cast<std::size_t>(axis)] = lag_correlation(z, data[d], stack.first[d], axis);
  return noise;
}

/// Student t weights of the standardised residual vectors (Lange, Little and Taylor, JASA 1989, eq. 4).
std::vector<double> robust_weights(const Eigen::MatrixXd& z) {
  std::vector<double> weights;
  for (Eigen::Index k = 0; k < z.rows() / 3; ++k)
    weights.push_back((kStudentDof + 3.0) / (kStudentDof + z.block<3, 1>(3 * k, 0).squaredNorm()));
  return weights;
}

std::string parameter_names(const Eigen::VectorXd& direction) {
  static constexpr const char* kNames[] = {"left wheel diameter", "right wheel diameter", "track width",
                                           "lidar x",             "lidar y",              "lidar yaw"};
  std::string names;
  for (Eigen::Index k = 0; k < std::min<Eigen::Index>(direction.size(), kBaseCount); ++k)
    if (std::abs(direction(k)) > 0.3) names += std::string(names.empty() ? "" : ", ") + kNames[k];
  return names.empty() ? "an effect's parameters" : names;
}

/// Columns scaled to unit norm; fixed parameters drop out.
struct NormalSystem {
  Eigen::VectorXd scale;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right_side;
};

NormalSystem normal_system(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
                           const std::vector<bool>& fixed) {
  NormalSystem system;
  system.scale = jacobian.colwise().norm().transpose();
  for (Eigen::Index k = 0; k < system.scale.size(); ++k)
    system.scale(k) = !fixed[static_cast<std::size_t>(k)] && system.scale(k) > 0.0 ? 1.0 / system.scale(k) : 0.0;
  const Eigen::MatrixXd scaled = jacobian * system.scale.asDiagonal();
  system.matrix = scaled.transpose() * scaled;
  system.right_side = scaled.transpose() * residual;
  return system;
}

std::optional<Error> check_rank(const NormalSystem& system, const std::vector<bool>& fixed) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < system.scale.size(); ++k)
    if (!fixed[static_cast<std::size_t>(k)]) free.push_back(k);
  const Eigen::MatrixXd matrix = system.matrix(free, free);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  if (eigen.eigenvalues()(0) > kMinRelativePivot) return std::nullopt;
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(system.scale.size());
  for (std::size_t i = 0; i < free.size(); ++i)
    direction(free[i]) = eigen.eigenvectors()(static_cast<Eigen::Index>(i), 0);
  return Error{ErrorCode::refused, "the motion does not determine: " + parameter_names(direction), "joint estimate",
               "record straight lines, arcs and turns on the spot, both ways"};
}

double sum_of_squares(std::span<const FitData> data, const EffectList& effects, const Eigen::VectorXd& p,
                      const std::vector<NoiseModel>& noise, const std::vector<double>& weights) {
  const Stack stack = make_stack(data, effects, p, false);
  return whitened(data, stack, noise, weights, stack.residual).squaredNorm();
}

/// Levenberg-Marquardt on fixed weights; returns whether it settled.
Result<bool> descend(std::span<const FitData> data, const EffectList& effects, const std::vector<NoiseModel>& noise,
                     const std::vector<double>& weights, const std::vector<bool>& fixed, int iterations,
                     Eigen::VectorXd& p) {
  double damping = 1e-9;
  for (int i = 0; i < iterations; ++i) {
    const Stack stack = make_stack(data, effects, p, true);
    const Eigen::MatrixXd residual = whitened(data, stack, noise, weights, stack.residual);
    const Eigen::MatrixXd jacobian = whitened(data, stack, noise, weights, stack.jacobian);
    const NormalSystem system = normal_system(jacobian, residual.col(0), fixed);
    if (auto error = check_rank(system, fixed)) return *error;
    const double before = residual.squaredNorm();
    bool improved = false;
    for (int attempt = 0; attempt < 8 && !improved; ++attempt) {
      Eigen::MatrixXd damped = system.matrix;
      for (Eigen::Index k = 0; k < damped.rows(); ++k)
        damped(k, k) = system.scale(k) > 0.0 ? damped(k, k) + damping : 1.0;
      const Eigen::VectorXd step = system.scale.asDiagonal() * damped.ldlt().solve(system.right_side);
      const Eigen::VectorXd candidate = p + step;
      const double after = sum_of_squares(data, effects, candidate, noise, weights);
      improved = after <= before * (1.0 + 1e-12);
      if (!improved) {
        damping = std::max(damping * 10.0, 1e-6);
        continue;
      }
      p = candidate;
      damping = std::max(damping * 0.1, 1e-12);
      // In units of standard deviations: a step of 1e-4 sigma cannot matter to anyone.
      if (std::sqrt(std::max(step.dot((jacobian.transpose() * jacobian) * step), 0.0)) < 1e-4) return true;
    }
    if (!improved) return true;
  }
  return false;
}

/// Cluster-robust (sandwich) covariance over blocks of kBlockSeconds (Liang and Zeger, Biometrika 1986).
Eigen::MatrixXd robust_covariance(std::span<const FitData> data, const Stack& stack, const FitResult& fit,
                                  const Eigen::MatrixXd& inverse) {
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(inverse.rows(), inverse.cols());
  Eigen::VectorXd block = Eigen::VectorXd::Zero(inverse.rows());
  double blocks = 0.0;
  const auto close = [&] {
    if (!block.isZero()) blocks += 1.0;
    meat += block * block.transpose();
    block.setZero();
  };
  for (std::size_t d = 0; d < data.size(); ++d) {
    double begin = -1e300;
    for (std::size_t k = 0; k < data[d].pairs.size(); ++k) {
      if (data[d].pairs[k].interval.begin > begin + kBlockSeconds) {
        close();
        begin = data[d].pairs[k].interval.begin;
      }
      const auto row = static_cast<Eigen::Index>(3 * (stack.first[d] + k));
      block += fit.whitened_jacobian.middleRows<3>(row).transpose() * fit.whitened_residual.segment<3>(row);
    }
    close();
  }
  const double small_sample = blocks > 1.0 ? blocks / (blocks - 1.0) : 1.0;
  return small_sample * inverse * meat * inverse;
}

/// Model covariance, each parameter's deviation raised to the robust one where that is larger.
void set_covariance(std::span<const FitData> data, const Stack& stack, const std::vector<bool>& fixed, FitResult& fit) {
  const NormalSystem system = normal_system(fit.whitened_jacobian, fit.whitened_residual, fixed);
  Eigen::MatrixXd matrix = system.matrix;
  for (Eigen::Index k = 0; k < matrix.rows(); ++k)
    if (!(system.scale(k) > 0.0)) matrix(k, k) = 1.0;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  const Eigen::MatrixXd inverse = system.scale.asDiagonal() * matrix.ldlt().solve(identity) * system.scale.asDiagonal();
  const Eigen::MatrixXd robust = robust_covariance(data, stack, fit, inverse);
  const double variance = std::max(1.0, fit.whitened_residual.squaredNorm() /
                                            std::max(static_cast<double>(fit.whitened_residual.size()), 1.0));
  Eigen::VectorXd inflation = Eigen::VectorXd::Ones(inverse.rows());
  for (Eigen::Index k = 0; k < inverse.rows(); ++k)
    if (inverse(k, k) > 0.0)
      inflation(k) = std::sqrt(std::max(variance, robust(k, k) / inverse(k, k)));
  fit.covariance = inflation.asDiagonal() * inverse * inflation.asDiagonal();
}

void count_outliers(const Eigen::MatrixXd& z, FitResult& fit) {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < fit.residuals.rows(); ++k) {
    if (z.block<3, 1>(3 * k, 0).norm() > kOutlier) {
      ++fit.discarded;
      continue;
    }
    ++fit.used;
    squares += fit.residuals.row(k).transpose().cwiseAbs2();
  }
  fit.rms = (squares / std::max(static_cast<double>(fit.used), 1.0)).cwiseSqrt();
}

void conclude(std::span<const FitData> data, const EffectList& effects, const std::vector<bool>& fixed, FitResult& fit) {
  const Stack stack = make_stack(data, effects, fit.parameters, true);
  fit.residuals = stack.residual.reshaped(3, stack.residual.rows() / 3).transpose();
  const Eigen::MatrixXd z = standardised(data, stack, fit.noise);
  fit.weights = robust_weights(z);
  fit.whitened_residual = whitened(data, stack, fit.noise, fit.weights, stack.residual);
  fit.whitened_jacobian = whitened(data, stack, fit.noise, fit.weights, stack.jacobian);
  fit.cost = 0.0;
  for (Eigen::Index k = 0; k < z.rows() / 3; ++k)
    fit.cost += (kStudentDof + 3.0) * std::log1p(z.block<3, 1>(3 * k, 0).squaredNorm() / kStudentDof);
  count_outliers(z, fit);
  set_covariance(data, stack, fixed, fit);
}

}  // namespace

Result<FitResult> fit_joint(std::span<const FitData> data, const EffectList& effects, const Eigen::VectorXd& start,
                            const FitOptions& options) {
  FitResult fit;
  fit.parameters = start;
  std::vector<bool> fixed = options.fixed;
  fixed.resize(static_cast<std::size_t>(start.size()), false);
  fit.noise = options.noise.empty() ? std::vector<NoiseModel>(data.size()) : options.noise;
  Stack stack = make_stack(data, effects, start, false);
  if (stack.headings.empty())
    return Error{ErrorCode::empty, "no pair of scans or poses with ticks", "joint estimate", "check the recording"};
  for (int round = 0; round < kNoiseRounds; ++round) {
    if (options.noise.empty()) fit.noise = estimate_noise(data, stack, fit.noise);
    fit.weights = robust_weights(standardised(data, stack, fit.noise));
    const auto settled = descend(data, effects, fit.noise, fit.weights, fixed, options.max_iterations / kNoiseRounds,
                                 fit.parameters);
    if (!settled) return settled.error();
    fit.converged = settled.value();
    stack = make_stack(data, effects, fit.parameters, false);
  }
  if (!fit.parameters.allFinite())
    return Error{ErrorCode::refused, "the fit diverged", "joint estimate", "check the nominal values"};
  conclude(data, effects, fixed, fit);
  return fit;
}

}  // namespace odomcalib::calib
