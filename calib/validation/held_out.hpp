// The residual on data that the parameters were not fitted to.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "calib/estimators/joint.hpp"

namespace odomcalib::calib {

struct HeldOut {
  std::array<double, 3> rms{};  ///< measured - predicted sensor motion per pair: m, m, rad; outliers left out
  std::array<double, 3> noise_floor{};  ///< what the noise model expects there
  std::size_t pairs = 0;
};

/// Cross-validation over five folds of whole blocks of 20 s: each block is predicted with parameters fitted
/// to the others. nullopt when the recording is too short for it.
std::optional<HeldOut> held_out_residual(std::span<const FitData> data, const EffectList& effects,
                                         const FitResult& fit, const std::vector<bool>& fixed);

}  // namespace odomcalib::calib
