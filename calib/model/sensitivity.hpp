// Derivatives of predicted sensor motions by the parameters, by the chain rule: parameters act on the twists
// of tick intervals and on the times at which the trajectory is asked; the trajectory carries both on.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/model/drive_model.hpp"

namespace odomcalib::calib {

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

 private:
  struct Path;
  [[nodiscard]] Eigen::MatrixXd by(std::span<const double> parameters, const PlacedEffects& effects,
                                   std::size_t first) const;

  const DriveModel& model_;
  const Trajectory& along_;
  std::vector<Interval> intervals_;
  std::vector<Path> paths_;
};

}  // namespace odomcalib::calib
