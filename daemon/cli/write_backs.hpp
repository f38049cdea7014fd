// Write-backs as the service keeps them: read where they are, and chosen by robot.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "proto/calibration/calibration.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// Adds "user_name" to entries of the history whose user has a name on this machine: the daemon knows numbers
/// only, because a directory service may take its time.
void name_users(nlohmann::ordered_json& entries);

// Entries are an array, newest first, as docs/schema/history-1.json has them.

/// @param path what `history --json` printed, or the state folder of the service. Errors: io, format.
Result<nlohmann::ordered_json> read_history(const std::filesystem::path& path);

/// Entries of this machine: the service is asked, or where it does not run its state folder read; none where
/// neither may be.
/// @param socket of the daemon
nlohmann::ordered_json history_of_this_machine(const std::string& socket);

/// Entries of the calibration's robot: those that wrote this calibration, that name the same robot, or whose
/// controller is that of the calibration or of one of these entries.
nlohmann::ordered_json entries_of_robot(const nlohmann::ordered_json& entries,
                                        const Calibration& calibration);

/// SHA-256 by which an entry names the calibration that it wrote.
std::string digest_in_history(const Calibration& calibration);

}  // namespace odomcalib::cli
