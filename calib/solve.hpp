// Recordings in, calibration out: the one entry point of the estimators.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/classical/closed_form_options.hpp"
#include "calib/measurement/progress.hpp"
#include "calib/measurement/sample_pair.hpp"
#include "calib/selection/rules.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/scale.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib {

struct SolveOptions {
  /// "auto": look for missing effects; "none": six base parameters only; otherwise names of effects to fit.
  std::vector<std::string> effects = {"auto"};
  /// Recordings that state different robot_id are of one robot all the same.
  bool same_robot = false;
  /// Recordings whose lidars have different names, and nothing else that differs, are of one lidar.
  bool same_lidar = false;
  /// The lidar whose scans are used, of several that one topic carries; empty: that with most.
  std::string sensor = {};
  /// All of them but in an ablation.
  selection::RuleSet rules = {};
  /// Scale of the reference; without one a lidar's data sheet has to do.
  std::optional<Scale> scale = std::nullopt;
  /// Outliers of the closed form; the joint estimator weighs its own.
  classical::ClosedFormOptions cuts = {};
};

struct Solution {
  Calibration calibration;
  std::vector<measurement::SamplePair>
      pairs;  ///< that it was fitted to, in order of time; none when refused before a fit
};

using Progress = measurement::Progress;

/// Estimates wheel diameters, track width and lidar pose from the recordings of one robot, jointly.
/// Never fails: a recording that cannot be calibrated yields a Calibration with verdict refused, the reasons,
/// and what was measured. Deterministic: same input, same bytes.
Solution solve_with_pairs(std::span<const Recording> recordings, const SolveOptions& options,
                          const Progress& progress = {});

/// The calibration alone.
inline Calibration solve(std::span<const Recording> recordings, const SolveOptions& options,
                         const Progress& progress = {}) {
  return solve_with_pairs(recordings, options, progress).calibration;
}

}  // namespace odomcalib::calib
