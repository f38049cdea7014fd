// What the recordings of one robot say about their lidar, and the recordings without its errors.
#pragma once

#include <span>
#include <vector>

#include "calib/estimation/fit.hpp"
#include "calib/measurement/scan_path.hpp"
#include "calib/selection/lidar_trace.hpp"

namespace odomcalib::calib::selection {

/// Pairs of scans with different headings, of all recordings. The fit's model guesses and de-skews.
std::vector<measurement::HeadingPair> heading_pairs(const estimation::Fit& fit);

/// Whether the scans of all recordings cover whole turns.
bool sees_all_round(const measurement::Dataset& dataset);

/// The recordings without the errors found; where none can be corrected, still new recordings, whose angles
/// are stated beam by beam.
ingest::Recordings corrected(const ingest::Recordings& recordings,
                             const std::vector<terms::LidarFinding>& findings);

/// Errors of the ranges that the maps of all recordings show, their values the means.
std::vector<terms::LidarFinding> common_findings(std::span<const measurement::ScanPath> paths);

/// Adds what scans still show after a first correction.
void refine(std::span<terms::LidarFinding> findings, const std::vector<measurement::HeadingPair>& pairs);

}  // namespace odomcalib::calib::selection
