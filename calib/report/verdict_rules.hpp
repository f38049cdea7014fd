// The rules of the verdict: one table, one function per rule. Each reads figures of the calibration that the
// report prints too, and says what it objects to.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/report/gate.hpp"

namespace odomcalib::calib::report {

struct Objection {
  bool refuses = false;
  std::string reason;  ///< a sentence: what was found, then, after a colon or semicolon, what to do about it
  /// How many times the rule's limit was exceeded, of a sign that the model is wrong; 0: this is none.
  double weight = 0.0;
  bool is_said = false;   ///< by a remark already: it only weighs
  std::string next = {};  ///< what to do, where it differs from the rule's
};

struct VerdictRule {
  const char* name;
  const char* next;  ///< what to do where this rule weighs most
  std::vector<Objection> (*objections)(const Calibration& calibration, const VerdictEvidence& evidence);
};

/// How few pairs of scans gave a motion, or a whole one, where that alone undoes a fit; nothing where they
/// are enough.
std::optional<std::string> poor_matches(const VerdictEvidence& evidence);

/// The remedy for scans with too few readings beside each other, where most pairs failed for that.
std::optional<std::string> remedy_for_readings(const VerdictEvidence& evidence);

/// Remedy where a recording lost much.
inline constexpr const char* kMendLosses =
    "mend what sends these counts, stamps, scans or poses: a second program on the topic, a counter that "
    "wraps early, a clock without its last digits, a marker that was lost, an encoder that fails";

/// In the order in which reasons are listed: what weighs more first.
std::span<const VerdictRule> verdict_rules();

/// Why what was left out of a recording leaves too little to stand on; nullopt where it does not. Of scans or
/// poses fewer do as well, as long as pairs can be made of them.
std::optional<Objection> too_much_left_out(const Loss& loss);

}  // namespace odomcalib::calib::report
