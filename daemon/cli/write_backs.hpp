// Write-backs as the service keeps them: read where they are, and chosen by robot.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "daemon/writeback/history.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// An entry of the history, and the name of the user who asked for it. The daemon knows numbers only, because
/// a directory service may take its time.
struct WriteBack {
  HistoryEntry entry;
  std::string user_name;  ///< empty: there is none on this machine, or it was not looked up
};

/// @param body an entry as docs/schema/history-1.json has it; nullopt: it is none
std::optional<WriteBack> write_back_from(const nlohmann::ordered_json& body);

/// Adds "user_name" to entries of the history whose user has a name on this machine.
void name_users(nlohmann::ordered_json& entries);

// Lists of write-backs have the newest first.

/// @param path what `history --json` printed, or the state folder of the service. Errors: io, format.
Result<std::vector<WriteBack>> read_history(const std::filesystem::path& path);

/// Entries of this machine: the service is asked, or where it does not run its state folder read; none where
/// neither may be.
/// @param socket of the daemon
std::vector<WriteBack> history_of_this_machine(const std::string& socket);

/// Entries of the calibration's robot: those that wrote this calibration, that name the same robot, or whose
/// controller is that of the calibration or of one of these entries.
std::vector<WriteBack> entries_of_robot(const std::vector<WriteBack>& entries,
                                        const Calibration& calibration);

/// SHA-256 by which an entry names the calibration that it wrote.
std::string digest_in_history(const Calibration& calibration);

}  // namespace odomcalib::cli
