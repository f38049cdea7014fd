// Odometry error over windows of a drive on data that was not fitted, of one model beside another's.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/validation/evaluation_window.hpp"
#include "calib/validation/folds.hpp"

namespace odomcalib::calib::validation {

struct WindowErrors {
  std::vector<double> position;    ///< per window, m
  std::vector<double> heading;     ///< per window, rad
  std::vector<std::size_t> fold;   ///< that each window was held out in
  std::vector<std::size_t> block;  ///< see EvaluationWindow
  [[nodiscard]] double rms_position() const;
};

/// Error of the predicted sensor motion over each window. The parameters for a window's fold come from all
/// other folds (one Gauss-Newton step from the full fit, which for a nearly linear problem is the refit).
WindowErrors window_errors(std::span<const measurement::FitData> data,
                           const std::vector<EvaluationWindow>& windows, const vehicle::EffectList& effects,
                           const estimation::FitResult& fit, const std::vector<bool>& fixed);

/// Whether a candidate would have been chosen without the data of each fold.
using FoldFlags = std::array<bool, kFolds>;
inline FoldFlags all_folds() {
  FoldFlags flags;
  flags.fill(true);
  return flags;
}

/// `after` in the folds whose training data select the candidate, `before` in the others: so the choice
/// itself is held out too.
WindowErrors where_selected(const WindowErrors& before, const WindowErrors& after, const FoldFlags& selected);

struct Improvement {
  double ratio = 1.0;  ///< rms after over rms before, position
  double upper = 1.0;  ///< 97.5 % bound of it
  double lower = 1.0;  ///< 2.5 % bound
  /// Whether nine of ten such drives would show a gain.
  [[nodiscard]] bool is_plain() const;
};

/// Paired block bootstrap over the windows' blocks, 1000 draws with a fixed seed. Position and heading
/// (times the distance over which it acts, half a metre) count together.
Improvement compare(const WindowErrors& before, const WindowErrors& after);

/// Drop of the whitened squared residual on held-out folds, summed over the recording, and its 2.5 % bound by
/// block bootstrap.
struct HeldOutGain {
  double total = 0.0;
  double lower = 0.0;
};
/// Both fits must stand on one noise model and on the same weights.
HeldOutGain held_out_gain(std::span<const measurement::FitData> data, const estimation::FitResult& before,
                          const std::vector<bool>& fixed_before, const estimation::FitResult& after,
                          const std::vector<bool>& fixed_after, const FoldFlags& selected);

}  // namespace odomcalib::calib::validation
