// One recording of the blind test, solved with every rule of the search, and without each of them, or each
// group of them, in turn.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/blind/blind_trial.hpp"

namespace odomcalib::blind {

/// Unit of an ablation: a rule, or a group of rules, is left out at a time.
enum class AblationOf { rules, groups };

/// Without one rule or group, or with all of them.
struct Ablation {
  std::string rule;      ///< or group that was left out; empty: none
  bool changes = false;  ///< the calibration, in any byte
  Trial trial;
};

/// With all rules first, then without each rule or group that is consulted in this recording: without one
/// that is not, the calibration is the same.
std::vector<Ablation> ablate(std::uint64_t campaign, unsigned number, const sim::BlindOptions& options,
                             Judged judged, AblationOf of);

/// All rules but those, or those groups, of these names. Throws std::invalid_argument if there is none of a
/// name.
calib::selection::RuleSet rules_without(const std::vector<std::string>& names);

/// One line of JSON: the row, the rule, and what tests/blind/bed counts; of a calibration that does not
/// change, nothing else.
std::string to_json_line(const Ablation& ablation);

}  // namespace odomcalib::blind
