// Derivatives of predicted sensor motions by the parameters, by the chain rule: parameters act on the twists
// of tick intervals and on the times at which the trajectory is read; the trajectory carries both on.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::vehicle {

/// Response of each motion to an effect of one parameter, tick interval by tick interval.
class StepResponse {
 public:
  /// Tick intervals of a motion.
  struct Span {
    std::size_t first, count;
  };
  /// @param spans of each motion
  /// @param rows one motion after the other: by the parameter as it acts in its first interval, its second,
  /// ...
  StepResponse(std::vector<Span> spans, Eigen::Matrix3Xd rows)
      : spans_(std::move(spans)), rows_(std::move(rows)) {}

  /// Derivatives of the motions by coefficients of functions that the parameter is the sum of.
  /// @param functions tick intervals x coefficients
  /// @param mean of each function, which is subtracted; empty: zero
  /// @return 3 n x coefficients
  [[nodiscard]] Eigen::MatrixXd by_coefficients(const Eigen::MatrixXd& functions,
                                                const Eigen::RowVectorXd& mean = {}) const;

 private:
  std::vector<Span> spans_;
  Eigen::Matrix3Xd rows_;
};

/// Derivatives of the sensor's motions along a trajectory.
class Sensitivity {
 public:
  /// @param along must outlive this, as must its model
  Sensitivity(const DriveModel& model, const Trajectory& along, std::span<const Interval> intervals);
  ~Sensitivity();
  Sensitivity(const Sensitivity&) = delete;
  Sensitivity& operator=(const Sensitivity&) = delete;

  /// 3 n x parameters: rows x, y, yaw of each interval's sensor motion, in m and rad, by the parameters of
  /// the trajectory.
  [[nodiscard]] Eigen::MatrixXd by_all() const;
  /// The same by the parameters of more effects at values that leave the trajectory as it is.
  [[nodiscard]] Eigen::MatrixXd by_more(const EffectList& effects, std::span<const double> parameters) const;
  /// For each parameter of more effects (kJetSize of them at most) at values that leave the trajectory as it
  /// is.
  [[nodiscard]] std::vector<StepResponse> by_steps(const EffectList& effects,
                                                   std::span<const double> parameters) const;

 private:
  struct Path;
  struct More {
    PlacedEffects effects;
    std::vector<double> parameters;
  };
  [[nodiscard]] More with(const EffectList& effects, std::span<const double> parameters) const;
  [[nodiscard]] Eigen::MatrixXd by(std::span<const double> parameters, const PlacedEffects& effects,
                                   std::size_t first) const;

  const DriveModel& model_;
  const Trajectory& along_;
  std::vector<Interval> intervals_;
  std::vector<Path> paths_;
};

}  // namespace odomcalib::calib::vehicle
