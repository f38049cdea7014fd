// Whether a drive has proven values: what odometry was off by against the lidar with the old ones, and is
// with the new ones. It looks at the answers of motions, whoever asked for them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "proto/calibration/members.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// One of the errors as people and programs have it.
struct DriveFigure {
  std::string_view name;  ///< in JSON, as in a calibration file
  const char* words;
  double DriveErrors::*value;
  double noise;   ///< what two drives differ by at least
  double factor;  ///< from SI to the unit that is shown
  const char* unit;
};

/// All of DriveErrors.
std::span<const DriveFigure> drive_figures();

/// An object with drive_figures() in SI units; null: not known.
template <typename Json>
Json json_of(const std::optional<DriveErrors>& errors) {
  if (!errors) return nullptr;
  Json body = Json::object();
  for (const DriveFigure& one : drive_figures()) body[std::string(one.name)] = (*errors).*one.value;
  return body;
}
/// nullopt: it is no such object.
template <typename Json>
std::optional<DriveErrors> drive_errors_from(const Json& body) {
  DriveErrors errors;
  for (const DriveFigure& one : drive_figures()) {
    const std::string name(one.name);
    if (!body.is_object() || !body.contains(name) || !body[name].is_number()) return std::nullopt;
    errors.*one.value = body[name].template get<double>();
  }
  return errors;
}

/// Errors of the drives before and after a write; nullopt: not driven, or not seen by the lidar.
struct DriveTrial {
  std::optional<DriveErrors> before, after;

  [[nodiscard]] bool is_empty() const { return !before && !after; }
  bool operator==(const DriveTrial&) const = default;
};

/// The errors of the newest straight and the newest turn on the spot.
class DrivenErrors {
 public:
  /// @param motion answer of Straight or Spin: "moves" with "lidar" [x, y, yaw] and "error"
  /// @return false, and nothing changes: the lidar did not recognise the place after every move, or the moves
  /// are shorter than settings::kLeastProofWay_m and kLeastProofTurn_rad
  bool add(const nlohmann::ordered_json& motion);
  /// nullopt: a straight or a turn is missing.
  [[nodiscard]] std::optional<DriveErrors> all() const;

 private:
  DriveErrors errors_;
  bool straight_ = false, turn_ = false;
};

/// Errors worse than before, by more than the comparison can resolve; nullopt: none.
std::optional<std::string> worse(const DriveErrors& before, const DriveErrors& after);

class DriveProof {
 public:
  /// A motion has ended, with the values in force.
  void driven(const nlohmann::ordered_json& motion) { (void)now_.add(motion); }
  /// Other values are in force, and wait for their proof.
  void other_values();
  /// The former ones are in force again.
  void taken_back();
  /// Values are stored: those that waited, and were driven with, or others.
  void committed();
  /// Nobody knows what was driven with the values in force.
  void forget();
  /// Why the values that wait are not proven: nothing was driven with them or before them, or it is worse.
  [[nodiscard]] std::optional<Error> lacking() const;
  /// Errors of the drives before and with the values that wait; empty: none wait.
  [[nodiscard]] DriveTrial trial() const;

 private:
  DrivenErrors now_;
  std::optional<DrivenErrors> before_;  // with the values that were in force before those that wait
};

}  // namespace odomcalib
