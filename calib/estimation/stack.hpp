// Residuals and Jacobians of all recordings of a fit in one column, and their whitening.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/measurement/whitening.hpp"

namespace odomcalib::calib::estimation {

/// Stacked residuals and Jacobians of all recordings, before weighting.
struct Stack {
  Eigen::MatrixXd residual;                    ///< 3 n x 1
  Eigen::MatrixXd jacobian;                    ///< 3 n x parameters
  std::vector<std::size_t> first;              ///< first pair of each recording, and the total
  std::vector<measurement::PairState> states;  ///< what each pair's noise depends on
};

std::vector<vehicle::Interval> intervals_of(const std::vector<measurement::SensorPair>& pairs);

/// @param derivatives whether the Jacobian is wanted
Stack make_stack(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                 const Eigen::VectorXd& p, bool derivatives);

/// Those of the stack alone, 3 n.
Eigen::VectorXd stacked_residual(std::span<const measurement::FitData> data,
                                 const vehicle::EffectList& effects, const Eigen::VectorXd& p);

/// Residuals of recording d.
std::vector<Eigen::Vector3d> residuals_of(const Stack& stack, std::size_t d);
std::span<const measurement::PairState> states_of(const Stack& stack, std::size_t d);
measurement::Whitener whitener_of(std::span<const measurement::FitData> data, const Stack& stack,
                                  const measurement::NoiseModel& noise, const std::vector<double>& weights,
                                  std::size_t d);

/// The whiteners of all recordings.
class StackWhitener {
 public:
  /// @param noise one per recording
  /// @param weights robust weight of each pair
  StackWhitener(std::span<const measurement::FitData> data, const Stack& stack,
                const std::vector<measurement::NoiseModel>& noise, const std::vector<double>& weights);

  /// @param rows 3 n x any
  [[nodiscard]] Eigen::MatrixXd operator()(Eigen::MatrixXd rows) const;

 private:
  std::vector<measurement::Whitener> whiteners_;
  std::vector<std::size_t> first_;  ///< pair of each recording, and the total
};

}  // namespace odomcalib::calib::estimation
