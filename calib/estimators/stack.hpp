// Residuals and Jacobians of all recordings of a fit in one column, and their whitening.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/estimators/joint.hpp"
#include "calib/noise/whitening.hpp"

namespace odomcalib::calib {

/// Stacked residuals and Jacobians of all recordings, before weighting.
struct Stack {
  Eigen::MatrixXd residual;        ///< 3 n x 1
  Eigen::MatrixXd jacobian;        ///< 3 n x parameters
  std::vector<std::size_t> first;  ///< first pair of each recording, and the total
  std::vector<PairState> states;   ///< what each pair's noise depends on
};

std::vector<Interval> intervals_of(const std::vector<SensorPair>& pairs);

/// @param derivatives whether the Jacobian is wanted
Stack make_stack(std::span<const FitData> data, const EffectList& effects, const Eigen::VectorXd& p,
                 bool derivatives);

/// Those of the stack alone, 3 n.
Eigen::VectorXd stacked_residual(std::span<const FitData> data, const EffectList& effects,
                                 const Eigen::VectorXd& p);

/// Of recording d.
std::vector<Eigen::Vector3d> residuals_of(const Stack& stack, std::size_t d);
std::span<const PairState> states_of(const Stack& stack, std::size_t d);
Whitener whitener_of(std::span<const FitData> data, const Stack& stack, const NoiseModel& noise,
                     const std::vector<double>& weights, std::size_t d);

/// The whiteners of all recordings.
class StackWhitener {
 public:
  /// @param noise one per recording
  /// @param weights robust weight of each pair
  StackWhitener(std::span<const FitData> data, const Stack& stack, const std::vector<NoiseModel>& noise,
                const std::vector<double>& weights);

  /// @param rows 3 n x any
  [[nodiscard]] Eigen::MatrixXd operator()(Eigen::MatrixXd rows) const;

 private:
  std::vector<Whitener> whiteners_;
  std::vector<std::size_t> first_;  ///< pair of each recording, and the total
};

}  // namespace odomcalib::calib
