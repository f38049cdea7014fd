#include "calib/estimation/joint.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "calib/classical/motion_kinds.hpp"
#include "calib/estimation/settings.hpp"
#include "calib/estimation/stack.hpp"
#include "calib/math/cluster_robust.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/measurement/dataset.hpp"
#include "calib/measurement/noise_estimate.hpp"

namespace odomcalib::calib::estimation {
namespace {

constexpr double kMinRelativePivot = 1e-12;

std::vector<measurement::NoiseModel> estimate_noise(std::span<const measurement::FitData> data,
                                                    const Stack& stack,
                                                    const std::vector<measurement::NoiseModel>& start) {
  std::vector<measurement::NoiseModel> noise = start;
  std::vector<measurement::SensorPair> pooled;
  std::vector<Eigen::Vector3d> pooled_residuals;
  std::vector<measurement::PairState> pooled_states;
  for (std::size_t d = 0; d < data.size(); ++d) {
    const auto residuals = residuals_of(stack, d);
    if (data[d].pairs.size() >= settings::kPairsForOwnNoise || data.size() == 1) {
      noise[d] = odomcalib::calib::measurement::estimate_noise(data[d].pairs, states_of(stack, d), residuals,
                                                               start[d]);
      continue;
    }
    pooled.insert(pooled.end(), data[d].pairs.begin(), data[d].pairs.end());
    pooled_residuals.insert(pooled_residuals.end(), residuals.begin(), residuals.end());
    pooled_states.insert(pooled_states.end(), states_of(stack, d).begin(), states_of(stack, d).end());
  }
  if (pooled.empty()) return noise;
  const measurement::NoiseModel common = odomcalib::calib::measurement::estimate_noise(
      pooled, pooled_states, pooled_residuals, measurement::NoiseModel{});
  for (std::size_t d = 0; d < data.size(); ++d)
    if (data[d].pairs.size() < settings::kPairsForOwnNoise && data.size() > 1) noise[d] = common;
  return noise;
}

std::vector<double> distances(std::span<const measurement::FitData> data, const Stack& stack,
                              const std::vector<measurement::NoiseModel>& noise) {
  std::vector<double> all;
  for (std::size_t d = 0; d < data.size(); ++d) {
    const auto part = squared_distances(data[d].pairs, states_of(stack, d), residuals_of(stack, d), noise[d]);
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

/// Student t weights (Lange, Little and Taylor, JASA 1989, eq. 4).
std::vector<double> robust_weights(const std::vector<double>& squared) {
  std::vector<double> weights;
  weights.reserve(squared.size());
  for (const double q : squared)
    weights.push_back(measurement::kStudentConsistency * (measurement::kStudentDof + 3.0) /
                      (measurement::kStudentDof + measurement::kStudentConsistency * q));
  return weights;
}

std::string parameter_names(const Eigen::VectorXd& direction) {
  static constexpr const char* kNames[] = {
      "left wheel diameter", "right wheel diameter", "track width", "lidar x", "lidar y", "lidar yaw"};
  std::string names;
  for (Eigen::Index k = 0; k < std::min<Eigen::Index>(direction.size(), vehicle::kBaseCount); ++k)
    if (std::abs(direction(k)) > settings::kNamedComponent)
      names += std::string(names.empty() ? "" : ", ") + kNames[k];
  return names.empty() ? "an effect's parameters" : names;
}

/// Columns scaled to unit norm; fixed parameters drop out.
struct NormalSystem {
  Eigen::VectorXd scale;
  Eigen::MatrixXd jacobian;  ///< whitened and scaled
  Eigen::MatrixXd matrix;    ///< of the pairs, without the prior
};

NormalSystem normal_system(Eigen::MatrixXd jacobian, const std::vector<bool>& fixed) {
  NormalSystem system;
  system.scale = jacobian.colwise().norm().transpose();
  for (Eigen::Index k = 0; k < system.scale.size(); ++k) {
    system.scale(k) =
        !fixed[static_cast<std::size_t>(k)] && system.scale(k) > 0.0 ? 1.0 / system.scale(k) : 0.0;
    jacobian.col(k) *= system.scale(k);
  }
  system.jacobian = std::move(jacobian);
  system.matrix = system.jacobian.transpose() * system.jacobian;
  return system;
}

/// Prior information of the parameters, those of the effects behind those of the base.
Eigen::MatrixXd prior_information(Eigen::Index parameters, const vehicle::EffectList& effects) {
  if (parameters < vehicle::kBaseCount + static_cast<Eigen::Index>(vehicle::count_parameters(effects)))
    throw std::invalid_argument("a fit needs a start of the base and of each effect");
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(parameters, parameters);
  Eigen::Index first = vehicle::kBaseCount;
  for (const auto& effect : effects) {
    const auto& own = effect->parameters();
    for (std::size_t k = 0; k < own.size(); ++k)
      if (own[k].prior > 0.0)
        information.diagonal()(first + static_cast<Eigen::Index>(k)) = 1.0 / (own[k].prior * own[k].prior);
    const auto count = static_cast<Eigen::Index>(own.size());
    for (const std::vector<double>& row : effect->expected_zeros()) {
      const Eigen::Map<const Eigen::VectorXd> factors(row.data(), count);
      information.block(first, first, count, count) += factors * factors.transpose();
    }
    first += count;
  }
  return information;
}

Eigen::MatrixXd with_prior(const NormalSystem& system, const Eigen::MatrixXd& information) {
  return system.matrix + system.scale.asDiagonal() * information * system.scale.asDiagonal();
}

/// @param normal with the prior
/// @param data tells which motion is missing
std::optional<Error> check_rank(const NormalSystem& system, const Eigen::MatrixXd& normal,
                                const std::vector<bool>& fixed, std::span<const measurement::FitData> data) {
  std::vector<Eigen::Index> free;
  // The shape of an effect of size zero changes nothing yet; it joins in as soon as the size does.
  for (Eigen::Index k = 0; k < system.scale.size(); ++k)
    if (!fixed[static_cast<std::size_t>(k)] && (k < vehicle::kBaseCount || system.scale(k) > 0.0))
      free.push_back(k);
  const Eigen::MatrixXd matrix = normal(free, free);
  const math::Eigensystem eigen = math::eigensystem(matrix);
  if (eigen.values(0) > kMinRelativePivot) return std::nullopt;
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(system.scale.size());
  for (std::size_t i = 0; i < free.size(); ++i)
    direction(free[i]) = eigen.vectors(static_cast<Eigen::Index>(i), 0);
  return Error{ErrorCode::refused, "the motion does not determine: " + parameter_names(direction),
               "joint estimate", classical::record_more(measurement::wheel_motions(data, 0.0))};
}

double prior_cost(const Eigen::MatrixXd& information, const Eigen::VectorXd& p) {
  return p.dot(information * p);
}

/// The problem near one point, whitened: what does not change from step to step.
struct Linear {
  StackWhitener whiten;
  NormalSystem system;
  Eigen::MatrixXd matrix;  ///< with the prior
};

/// Levenberg-Marquardt. The model is so nearly linear that a Jacobian, and with it what the noise depends on,
/// serves for all steps that stay within a deviation of where it was taken, also when weights or noise have
/// changed since.
class Descent {
 public:
  Descent(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
          const std::vector<bool>& fixed, const Eigen::MatrixXd& prior, Eigen::VectorXd start)
      : data_(data), effects_(effects), fixed_(fixed), prior_(prior), p_(std::move(start)) {
    linearise();
  }

  [[nodiscard]] const Eigen::VectorXd& parameters() const { return p_; }
  [[nodiscard]] const Stack& stack() const { return stack_; }

  /// On fixed weights; returns whether it settled.
  Result<bool> settle(const std::vector<measurement::NoiseModel>& noise, const std::vector<double>& weights,
                      int iterations) {
    damping_ = 1e-9;
    std::optional<Linear> linear;
    for (int i = 0; i < iterations; ++i) {
      if (moved_ > settings::kLinearReach) linearise(), linear.reset();
      if (!linear) {
        linear = whitened(noise, weights);
        if (auto error = check_rank(linear->system, linear->matrix, fixed_, data_)) return *error;
      }
      const auto length = descend(*linear);
      if (length && *length < settings::kFitSettled) return true;
      if (!length && moved_ == 0.0) return true;
      if (length)
        moved_ += *length;
      else
        linearise(), linear.reset();
    }
    return false;
  }

 private:
  void linearise() {
    stack_ = make_stack(data_, effects_, p_, true);
    moved_ = 0.0;
  }

  [[nodiscard]] Linear whitened(const std::vector<measurement::NoiseModel>& noise,
                                const std::vector<double>& weights) const {
    StackWhitener whiten(data_, stack_, noise, weights);
    NormalSystem system = normal_system(whiten(stack_.jacobian), fixed_);
    Eigen::MatrixXd matrix = with_prior(system, prior_);
    return {std::move(whiten), std::move(system), std::move(matrix)};
  }

  /// Takes the first step that does not make it worse, more damped from one to the next. One that is short
  /// enough to end with is not damped further.
  /// @return its length, sigma
  std::optional<double> descend(const Linear& linear) {
    const NormalSystem& system = linear.system;
    const Eigen::VectorXd residual = linear.whiten(stack_.residual);
    const double before = residual.squaredNorm() + prior_cost(prior_, p_);
    const Eigen::VectorXd right_side =
        system.jacobian.transpose() * residual - system.scale.cwiseProduct(prior_ * p_);
    for (int attempt = 0; attempt < settings::kMostDampings; ++attempt) {
      Eigen::MatrixXd damped = linear.matrix;
      for (Eigen::Index k = 0; k < damped.rows(); ++k)
        damped(k, k) = system.scale(k) > 0.0 ? damped(k, k) + damping_ : 1.0;
      const Eigen::VectorXd scaled_step = math::solve_symmetric(damped, right_side);
      const double length = (system.jacobian * scaled_step).norm();
      const Eigen::VectorXd there = p_ + system.scale.asDiagonal() * scaled_step;
      const Eigen::VectorXd residual_there = stacked_residual(data_, effects_, there);
      if (linear.whiten(residual_there).squaredNorm() + prior_cost(prior_, there) <= before * (1.0 + 1e-12)) {
        p_ = there;
        stack_.residual = residual_there;
        damping_ = std::max(damping_ * 0.1, 1e-12);
        return length;
      }
      if (length < settings::kFitSettled) return length;
      damping_ = std::max(damping_ * 10.0, 1e-6);
    }
    return std::nullopt;
  }

  std::span<const measurement::FitData> data_;
  const vehicle::EffectList& effects_;
  const std::vector<bool>& fixed_;
  const Eigen::MatrixXd& prior_;
  Eigen::VectorXd p_;
  Stack stack_;         ///< residual at p_, all else near it
  double moved_ = 0.0;  ///< sigma, since all else was taken
  double damping_ = 0.0;
};

math::ClusterRobust robust_covariance(std::span<const measurement::FitData> data, const Stack& stack,
                                      const FitResult& fit, const Eigen::MatrixXd& inverse) {
  math::ClusterRobust robust(inverse);
  for (std::size_t d = 0; d < data.size(); ++d) {
    for (std::size_t k = 0; k < data[d].pairs.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(3 * (stack.first[d] + k));
      robust.add(data[d].pairs[k].interval.begin, fit.whitened_jacobian.middleRows<3>(row).transpose() *
                                                      fit.whitened_residual.segment<3>(row));
    }
    robust.end_recording();
  }
  return robust;
}

/// Model covariance, each parameter's deviation raised to the robust one where that is larger.
void set_covariance(std::span<const measurement::FitData> data, const Stack& stack,
                    const std::vector<bool>& fixed, FitResult& fit) {
  const NormalSystem system = normal_system(fit.whitened_jacobian, fixed);
  Eigen::MatrixXd matrix = with_prior(system, fit.prior_information);
  for (Eigen::Index k = 0; k < matrix.rows(); ++k)
    if (!(system.scale(k) > 0.0)) matrix(k, k) = 1.0;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  const Eigen::MatrixXd inverse =
      system.scale.asDiagonal() * math::solve_symmetric(matrix, identity) * system.scale.asDiagonal();
  const double variance = std::max(1.0, fit.whitened_residual.squaredNorm() /
                                            std::max(static_cast<double>(fit.whitened_residual.size()), 1.0));
  fit.covariance = robust_covariance(data, stack, fit, inverse).inflated(variance);
}

void count_outliers(const std::vector<double>& squared, FitResult& fit) {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < fit.residuals.rows(); ++k) {
    fit.outlier.push_back(squared[static_cast<std::size_t>(k)] > settings::kOutlier * settings::kOutlier);
    if (fit.outlier.back()) {
      ++fit.discarded;
      continue;
    }
    ++fit.used;
    squares += fit.residuals.row(k).transpose().cwiseAbs2();
  }
  fit.rms = (squares / std::max(static_cast<double>(fit.used), 1.0)).cwiseSqrt();
}

void conclude(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
              const std::vector<bool>& fixed, FitResult& fit) {
  const Stack stack = make_stack(data, effects, fit.parameters, true);
  fit.residuals = stack.residual.reshaped(3, stack.residual.rows() / 3).transpose();
  const std::vector<double> squared = distances(data, stack, fit.noise);
  fit.weights = robust_weights(squared);
  const StackWhitener whiten(data, stack, fit.noise, fit.weights);
  fit.whitened_residual = whiten(stack.residual);
  fit.whitened_jacobian = whiten(stack.jacobian);
  fit.cost = 0.0;
  for (const double q : squared)
    fit.cost += (measurement::kStudentDof + 3.0) *
                std::log1p(measurement::kStudentConsistency * q / measurement::kStudentDof);
  count_outliers(squared, fit);
  set_covariance(data, stack, fixed, fit);
}

}  // namespace

Result<FitResult> fit_joint(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                            const Eigen::VectorXd& start, const FitOptions& options) {
  FitResult fit;
  std::vector<bool> fixed = options.fixed;
  fixed.resize(static_cast<std::size_t>(start.size()), false);
  fit.prior_information = prior_information(start.size(), effects);
  fit.noise = options.noise.empty() ? std::vector<measurement::NoiseModel>(data.size()) : options.noise;
  Descent descent(data, effects, fixed, fit.prior_information, start);
  if (descent.stack().states.empty())
    return Error{ErrorCode::empty, "no pair of scans or poses with ticks", "joint estimate",
                 "check the recording"};
  for (int round = 0; round < settings::kNoiseRounds; ++round) {
    if (options.noise.empty()) fit.noise = estimate_noise(data, descent.stack(), fit.noise);
    fit.weights = robust_weights(distances(data, descent.stack(), fit.noise));
    const auto settled =
        descent.settle(fit.noise, fit.weights, options.max_iterations / settings::kNoiseRounds);
    if (!settled) return settled.error();
    fit.converged = settled.value();
  }
  fit.parameters = descent.parameters();
  if (!fit.parameters.allFinite())
    return Error{ErrorCode::refused, "the fit diverged", "joint estimate", "check the nominal values"};
  conclude(data, effects, fixed, fit);
  return fit;
}

std::vector<measurement::NoiseModel> noise_shown(std::span<const measurement::FitData> data,
                                                 const vehicle::EffectList& effects, const FitResult& fit,
                                                 std::span<const Eigen::Vector3d> residuals) {
  Stack stack = make_stack(data, effects, fit.parameters, false);
  for (std::size_t k = 0; k < residuals.size(); ++k)
    stack.residual.block<3, 1>(static_cast<Eigen::Index>(3 * k), 0) = residuals[k];
  return estimate_noise(data, stack, fit.noise);
}

FitResult with_weights(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                       FitResult fit, const std::vector<double>& weights) {
  const Stack stack = make_stack(data, effects, fit.parameters, true);
  fit.weights = weights;
  const StackWhitener whiten(data, stack, fit.noise, fit.weights);
  fit.whitened_residual = whiten(stack.residual);
  fit.whitened_jacobian = whiten(stack.jacobian);
  return fit;
}

}  // namespace odomcalib::calib::estimation
