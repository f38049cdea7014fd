// Parameters of the controller and what was written to it, as tables in mm.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

#include "daemon/cli/document.hpp"
#include "daemon/cli/write_backs.hpp"
#include "daemon/writeback/drive_proof.hpp"

namespace odomcalib::cli {

/// @param parameters as GetParameters answers
Document describe_parameters(const nlohmann::ordered_json& parameters);
/// @param entries newest first
/// @param not_understood entries that are in no form that is known here
Document describe_history(const std::vector<WriteBack>& entries, std::size_t not_understood = 0);
/// Rows of drive_figures(), with what odometry was off by against the lidar.
Table trial_table(const DriveTrial& trial);
/// "Written to the controller" and the drives that were to prove it, for a report; none where there is no
/// entry.
/// @param entries of the calibration's robot, newest first
/// @param sha256 that entries have as "calibration_sha256" where they wrote this calibration
std::vector<Section> write_back_sections(const std::vector<WriteBack>& entries, const std::string& sha256);
/// @param result of Apply or Rollback: outcome, steps, parameters
Document describe_write_back(const nlohmann::ordered_json& result);

/// Checks of what is possible: name, outcome, what was found, remedy.
Document describe_checks(const nlohmann::ordered_json& checks);

}  // namespace odomcalib::cli
