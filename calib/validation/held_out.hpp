// The residual on data that the parameters were not fitted to.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"

namespace odomcalib::calib::estimation {
struct Fit;
}

namespace odomcalib::calib::validation {

struct HeldOut {
  std::array<double, 3> rms{};  ///< measured - predicted sensor motion per pair: m, m, rad; outliers left out
  std::array<double, 3> noise_floor{};  ///< what the noise model expects there
  /// The same of all pairs, outliers counted as what is just no outlier: a model that makes fewer is better.
  std::array<double, 3> bounded{};
  std::size_t pairs = 0;
};

/// Measured - predicted sensor motion of one pair, m, m, rad, and its variance by the noise model.
struct HeldOutError {
  Eigen::Vector3d error, variance;
};

/// One per pair. Cross-validation over five folds of whole blocks of 20 s: each block is predicted with
/// parameters fitted to the others (one Gauss-Newton step from the full fit, which for a nearly linear
/// problem is the refit). None where all pairs lie in one block, so that nothing is left to fit to.
std::vector<HeldOutError> held_out_errors(std::span<const measurement::FitData> data,
                                          const vehicle::EffectList& effects,
                                          const estimation::FitResult& fit, const std::vector<bool>& fixed);

/// Two models are compared on the same pairs: left out is what is an outlier for both. nullopt when too few
/// are left.
std::optional<HeldOut> held_out_residual(const std::vector<HeldOutError>& errors,
                                         const std::vector<HeldOutError>& other);

/// Held-out residual of one model alone.
std::optional<HeldOut> held_out_residual(std::span<const measurement::FitData> data,
                                         const vehicle::EffectList& effects, const estimation::FitResult& fit,
                                         const std::vector<bool>& fixed);

/// Held-out residual of a fit to its own dataset; nullopt also where it failed.
std::optional<HeldOut> held_out_residual(const estimation::Fit& fit);

}  // namespace odomcalib::calib::validation
