// calibrate --apply: odometry is compared with the lidar before the write-back and, on fresh motion, with the
// new values before they are stored. What is not better goes back.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "daemon/cli/document.hpp"
#include "daemon/writeback/drive_proof.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// Runs a method of the daemon with its lease: name and parameters to "result" of the answer.
using RunMethod = std::function<Result<nlohmann::ordered_json>(const std::string& method,
                                                               nlohmann::ordered_json parameters)>;

/// Drives a straight and a spin, out and back each. Errors: those of the methods; refused where the lidar did
/// not recognise the place after one of the moves.
Result<DriveErrors> drive_errors(const RunMethod& run);

/// Why nobody but a person may have this written: a warning is for somebody who reads it.
std::optional<Error> needs_a_person(const Calibration& calibration);

/// Why a motion cannot prove what would be written. @param parameters those of GetParameters
std::optional<Error> unprovable(const nlohmann::ordered_json& parameters);

struct ProvenApply {
  enum class End {
    stored,      ///< new values in force, on fresh motion better
    not_stored,  ///< nothing was written, or it failed: old values in force
    taken_back,  ///< old values in force again, nothing was stored
    in_doubt     ///< what is in force could not be seen
  };
  End end = End::not_stored;
  DriveErrors before;
  std::optional<DriveErrors> after;
  std::optional<Error> error;  ///< why it was not stored
};

/// Writes the calibration without storing it, drives again, and has it stored when that has proven it, as the
/// daemon judges by the same drives.
/// @param before drive_errors() with the values that are in force
/// @param always runs what takes it back; unlike `run` it asks nobody and is not given up
ProvenApply apply_and_prove(const RunMethod& run, const RunMethod& always, const Calibration& calibration,
                            const DriveErrors& before);

/// As the calibration file has it.
ProofEntry entry_of(const ProvenApply& applied);
Document describe(const ProvenApply& applied);

}  // namespace odomcalib::cli
