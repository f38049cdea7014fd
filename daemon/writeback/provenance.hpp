// Provenance of a write-back: whose wish it was, what its values were held to, and what speaks for them.
// Journal and history keep it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "daemon/writeback/drive_proof.hpp"

namespace odomcalib {

struct Provenance {
  std::string entry;                      ///< id in the history, given before it begins; empty: not known
  std::optional<std::uint32_t> user;      ///< number of the user who asked for it; nullopt: not known
  std::map<std::string, double> nominal;  ///< m, by quantity: the robot's own, see write_gate.hpp
  std::map<std::string, std::string> nominal_from;  ///< where each of these is stated
  std::string
      restores;         ///< of a rollback: entry whose former values it restores; empty: another controller's
  bool proven = false;  ///< a motion has shown odometry to be no worse with these values
  std::string robot_id;  ///< as the configuration named the robot; empty: it did not, or an earlier version
  std::string calibration_sha256;  ///< of an apply: of text_in_force(); empty: none, or an earlier version
  DriveTrial trial;                ///< drives that were to prove the values; empty: none

  bool operator==(const Provenance&) const = default;
};

/// Adds them to a record or an entry.
template <typename Json>
void write_provenance(const Provenance& from, Json& body) {
  body["entry"] = from.entry;
  body["user"] = from.user ? Json(*from.user) : Json(nullptr);
  body["nominal"] = from.nominal;
  body["nominal_from"] = from.nominal_from;
  body["restores"] = from.restores;
  body["proven"] = from.proven;
  body["robot_id"] = from.robot_id;
  body["calibration_sha256"] = from.calibration_sha256;
  if (from.trial.is_empty()) return;
  body["trial"] = {{"before", json_of<Json>(from.trial.before)}, {"after", json_of<Json>(from.trial.after)}};
}

/// Nothing is known of earlier versions. Throws what Json throws for members of another type.
template <typename Json>
Provenance read_provenance(const Json& body) {
  Provenance out;
  out.entry = body.value("entry", "");
  if (body.contains("user") && body["user"].is_number_unsigned())
    out.user = body["user"].template get<std::uint32_t>();
  out.nominal = body.value("nominal", out.nominal);
  out.nominal_from = body.value("nominal_from", out.nominal_from);
  out.restores = body.value("restores", "");
  out.proven = body.value("proven", false);
  out.robot_id = body.value("robot_id", "");
  out.calibration_sha256 = body.value("calibration_sha256", "");
  const Json trial = body.value("trial", Json::object());
  out.trial = {drive_errors_from(trial.value("before", Json())),
               drive_errors_from(trial.value("after", Json()))};
  return out;
}

}  // namespace odomcalib
