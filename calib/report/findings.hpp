// Findings of a solve, as the calibration file states them: parameters, effects with their evidence, what
// stays unexplained, the held-out residual, and the verdict.
#pragma once

#include <string>
#include <vector>

#include "calib/classical/closed_form_options.hpp"
#include "calib/estimation/fit.hpp"
#include "calib/selection/search_result.hpp"
#include "calib/terms/lidar_effect.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::report {

struct Findings {
  const estimation::Fit& fit;  ///< before terms were selected, of the same dataset
  const selection::SearchResult& outcome;
  const std::vector<terms::LidarFinding>& lidar;
  bool was_searched = false;       ///< for effects that nobody named
  bool every_scan_placed = false;  ///< the parameters come from the whole path, not from matches of keyframes
  std::vector<std::string> remarks = {};  ///< on what was taken out of the recordings
  classical::ClosedFormOptions cuts = {};
};

Calibration calibrated(const Findings& found);

/// Nothing was measured.
Calibration refused(const ingest::Recordings& recordings, const Error& error);

/// Nothing was fitted.
Calibration refused(const measurement::Dataset& dataset, const Error& error);

/// The fit failed; classical methods may have not.
Calibration refused(const estimation::Fit& failed, const classical::ClosedFormOptions& cuts);

}  // namespace odomcalib::calib::report
