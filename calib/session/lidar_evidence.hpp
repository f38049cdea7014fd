// What the recordings of one robot say about their lidar, and the recordings without its errors.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/lidar/lidar_trace.hpp"
#include "calib/map/scan_path.hpp"
#include "calib/session/session.hpp"

namespace odomcalib::calib {

/// Pairs of scans with different headings, of all recordings. Parameters and effects guess and de-skew.
std::vector<HeadingPair> heading_pairs(const Session& session, const Eigen::VectorXd& parameters,
                                       const EffectList& effects);

/// Whether the scans of all recordings cover whole turns.
bool sees_all_round(const Session& session);

std::vector<Recording> corrected(std::span<const Recording> recordings,
                                 const std::vector<LidarFinding>& findings);

/// Errors of the ranges that the maps of all recordings show, their values the means.
std::vector<LidarFinding> common_findings(std::span<const ScanPath> paths);

/// Adds what scans still show after a first correction.
void refine(std::span<LidarFinding> findings, const std::vector<HeadingPair>& pairs);

}  // namespace odomcalib::calib
