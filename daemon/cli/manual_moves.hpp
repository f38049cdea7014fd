// Results of straight lines, turns on the spot and squares: corrected lengths from the moves that the
// daemon reported, by its lidar or by what a person measured.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "proto/calibration/calibration.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// Answers of one or more motions: "moves", "robot", "rounds", "recording", "driven".
struct DrivenMoves {
  nlohmann::ordered_json moves = nlohmann::ordered_json::array();
  nlohmann::ordered_json rounds = nlohmann::ordered_json::array();
  nlohmann::ordered_json robot = nlohmann::ordered_json::object();
  std::vector<std::string> recordings;
  std::optional<Driven> driven;
  /// Error: format, when `result` is no answer of a motion, or of another robot than those before.
  Result<void> add(const nlohmann::ordered_json& result);
};

/// How a person states what was measured.
struct Measure {
  struct OtherUnit {
    const char* name;
    double in_this;  ///< one of it
  };
  const char* unit;
  double si;            ///< one of it in m, or in rad
  const char* example;  ///< as it is typed
  std::vector<OtherUnit> others;
};
const Measure& metres();
const Measure& degrees();

/// Refuses what cannot have been measured of this move, and names the unit that it would be right in.
/// @param measured, expected m, or rad: by the person, and by odometry or as it was asked for
std::optional<Error> implausible(double measured, double expected, const Measure& measure);

struct Proposal {
  ProposalEntry entry;     ///< as the calibration file has it
  RobotDescription robot;  ///< values in force during the motion
};

/// @param measured m, of the moves that go the way of the first one: one value for each, or one for all;
/// empty: by the lidar Errors: usage (another number of values than moves), refused (as propose_radii, or the
/// lidar saw nothing)
Result<Proposal> straight_proposal(const DrivenMoves& driven, const std::vector<double>& measured);
/// @param measured rad, positive, of every turn: one value for each, or one for all; empty: by the lidar
Result<Proposal> spin_proposal(const DrivenMoves& driven, const std::vector<double>& measured);
/// m, of the squares that were driven, by odometry.
double side_of(const DrivenMoves& driven);
/// @param side m. Error usage: no squares were driven.
Result<Proposal> square_proposal(const DrivenMoves& driven, double side);

std::vector<std::string> to_lines(const ProposalEntry& proposal);
/// Command that puts the proposal into force.
std::string next_command(const ProposalEntry& proposal);
/// A calibration of these lengths alone, for `apply`.
Calibration calibration_of(const Proposal& proposal, const DrivenMoves& driven);

}  // namespace odomcalib::cli
