// What a solve found, as the calibration file states it: parameters, effects with their evidence, what stays
// unexplained, the held-out residual, and the verdict.
#pragma once

#include <vector>

#include "calib/lidar/lidar_trace.hpp"
#include "calib/session/session.hpp"
#include "calib/stamps/stamp_report.hpp"
#include "calib/tracing/search_result.hpp"
#include "proto/calibration.hpp"

namespace odomcalib::calib {

struct Findings {
  const Session& session;  ///< with the pairs that the outcome was fitted to
  const SearchResult& outcome;
  const std::vector<LidarFinding>& lidar;
  StampReport stamps;
  bool was_searched = false;       ///< for effects that nobody named
  bool every_scan_placed = false;  ///< the parameters come from the whole path, not from matches of keyframes
};

/// Fills in all that depends on the fit; data and classical methods are there already.
void fill_calibration(const Findings& found, Calibration& calibration);

}  // namespace odomcalib::calib
