// Open-loop odometry error over ten seconds on data that was not fitted: what a user feels.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "calib/estimators/joint.hpp"
#include "calib/validation/folds.hpp"

namespace odomcalib::calib {

inline constexpr double kHorizonSeconds = 10.0;

struct HorizonError {
  std::vector<double> position;    ///< per window, m
  std::vector<double> heading;     ///< per window, rad
  std::vector<std::size_t> fold;   ///< that each window was held out in
  std::vector<std::size_t> block;  ///< block of 30 s each window belongs to
  [[nodiscard]] double rms_position() const;
  [[nodiscard]] double rms_heading() const;
};

/// A pair counts unless it is far out for both models: then its match has failed.
std::vector<bool> trusted_pairs(const FitResult& a, const FitResult& b);

/// Error of the predicted sensor motion over windows of kHorizonSeconds against the chained measured pairs.
/// Five folds of blocks of 20 s: the parameters for a window's fold come from all others (one Gauss-Newton
/// step from the full fit, which for a nearly linear problem is the refit). nullopt when fewer than ten
/// windows exist.
/// @param trusted one flag per pair; windows do not cross a pair whose match has failed. Two models are
/// compared on
///        the same windows, so the flags must not come from one of them alone
std::optional<HorizonError> horizon_error(std::span<const FitData> data, const EffectList& effects,
                                          const FitResult& fit, const std::vector<bool>& fixed,
                                          const std::vector<bool>& trusted);

/// Whether a candidate would have been chosen without the data of each fold.
using FoldFlags = std::array<bool, kFolds>;
inline FoldFlags all_folds() {
  FoldFlags flags;
  flags.fill(true);
  return flags;
}

/// `after` in the folds whose training data select the candidate, `before` in the others: so the choice
/// itself is held out too.
HorizonError where_selected(const HorizonError& before, const HorizonError& after, const FoldFlags& selected);

struct Improvement {
  double ratio = 1.0;  ///< rms after over rms before, position
  double upper = 1.0;  ///< 97.5 % bound of it
  double lower = 1.0;  ///< 2.5 % bound
};

/// Paired block bootstrap over the windows' blocks, 1000 draws with a fixed seed. Position and heading (times
/// the distance over which it acts, half a metre) count together.
Improvement compare(const HorizonError& before, const HorizonError& after);

/// Drop of the whitened squared residual on held-out folds, summed over the recording, and its 2.5 % bound by
/// block bootstrap.
struct HeldOutGain {
  double total = 0.0;
  double lower = 0.0;
};
/// Both fits must stand on one noise model and on the same weights.
HeldOutGain held_out_gain(std::span<const FitData> data, const FitResult& before,
                          const std::vector<bool>& fixed_before, const FitResult& after,
                          const std::vector<bool>& fixed_after, const FoldFlags& selected);

}  // namespace odomcalib::calib
