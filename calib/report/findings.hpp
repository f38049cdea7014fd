// What a solve found, as the calibration file states it: parameters, effects with their evidence, what stays
// unexplained, the held-out residual, and the verdict.
#pragma once

#include <string>
#include <vector>

#include "calib/ingest/stamp_report.hpp"
#include "calib/measurement/session.hpp"
#include "calib/selection/lidar_trace.hpp"
#include "calib/selection/search_result.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::report {

struct Findings {
  const measurement::Session& session;  ///< with the pairs that the outcome was fitted to
  const selection::SearchResult& outcome;
  const std::vector<terms::LidarFinding>& lidar;
  ingest::StampReport stamps;
  bool was_searched = false;       ///< for effects that nobody named
  bool every_scan_placed = false;  ///< the parameters come from the whole path, not from matches of keyframes
  std::vector<std::string> remarks = {};  ///< on what was taken out of the recordings
};

/// Fills in all that depends on the fit; data and classical methods are there already.
void fill_calibration(const Findings& found, Calibration& calibration);

}  // namespace odomcalib::calib::report
