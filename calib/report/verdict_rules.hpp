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
  std::string reason;  ///< a sentence: what was found, and what to do about it
};

struct VerdictRule {
  const char* name;
  std::vector<Objection> (*objections)(const Calibration& calibration, const Footing& footing);
};

/// How few pairs of scans gave a motion, or a whole one, where that alone undoes a fit; nothing where they
/// are enough.
std::optional<std::string> poor_matches(const Footing& footing);

/// In the order in which reasons are listed.
std::span<const VerdictRule> verdict_rules();

}  // namespace odomcalib::calib::report
