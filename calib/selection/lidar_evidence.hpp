// What the recordings of one robot say about their lidar, and the recordings without its errors.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/measurement/scan_path.hpp"
#include "calib/measurement/session.hpp"
#include "calib/selection/lidar_trace.hpp"

namespace odomcalib::calib::selection {

/// Pairs of scans with different headings, of all recordings. Parameters and effects guess and de-skew.
std::vector<measurement::HeadingPair> heading_pairs(const measurement::Session& session,
                                                    const Eigen::VectorXd& parameters,
                                                    const vehicle::EffectList& effects);

/// Whether the scans of all recordings cover whole turns.
bool sees_all_round(const measurement::Session& session);

std::vector<Recording> corrected(std::span<const Recording> recordings,
                                 const std::vector<terms::LidarFinding>& findings);

/// Errors of the ranges that the maps of all recordings show, their values the means.
std::vector<terms::LidarFinding> common_findings(std::span<const measurement::ScanPath> paths);

/// Adds what scans still show after a first correction.
void refine(std::span<terms::LidarFinding> findings, const std::vector<measurement::HeadingPair>& pairs);

}  // namespace odomcalib::calib::selection
