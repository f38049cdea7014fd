// Derivatives of predicted sensor motions by the parameters, by the chain rule: parameters act on the twists
// of tick intervals and on the times at which the trajectory is asked; the trajectory carries both on.
#pragma once

#include <Eigen/Core>
#include <span>

#include "calib/model/drive_model.hpp"

namespace odomcalib::calib {

/// The trajectory that sensitivities are taken along.
struct Linearisation {
  const WheelTrack& track;
  const std::vector<StepContext>& context;
  std::span<const Pose> poses;   ///< base at each sample
  std::span<const Pose> twists;  ///< of each interval between samples
};

/// 3 n x (parameters - first): rows x, y, yaw of each interval's sensor motion, in m and rad. The parameters
/// are those of the linearisation.
Eigen::MatrixXd sensitivity(const Linearisation& at, std::span<const double> parameters,
                            const EffectList& effects, std::span<const Interval> intervals,
                            std::size_t first);

}  // namespace odomcalib::calib
