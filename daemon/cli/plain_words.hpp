// Findings of a calibration, in words and numbers for people who do not know its parameters by name.
// Terminal, page, mechanic's sheet and certificate say it alike.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/cli/display.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::cli {

/// A size for a sentence, without its sign: "152", "16.1", "0.5", "0.08".
std::string plain_number(double value);

/// How a parameter of an effect is shown, and what it is called in a table: "backlash: left gear".
Display display_of(const std::string& effect, const std::string& parameter, const Quantity& quantity);
std::string label_of(const std::string& effect, const std::string& parameter);

/// Error over a metre or over a full turn, on data that was not fitted.
struct Gain {
  std::string what;              ///< "a metre", "a full turn"
  std::string unit;              ///< "mm", "degrees"
  std::optional<double> before;  ///< in the unit; absent without nominal values
  std::optional<double> after;
  std::string way;  ///< which way it was off: "too long"; empty where that is not plain
};

/// The metre, then the full turn; without what the recording does not show. Where it shows neither, ten
/// seconds of whatever was driven.
std::vector<Gain> gains_of(const Calibration& calibration, const ReportData& data);
/// "A metre read 16.1 mm too short, now 0.5 mm off; a full turn ..."; empty without gains.
std::string gain_sentence(const Calibration& calibration, const ReportData& data);

/// Where on the robot something is.
enum class Spot { left_wheel, right_wheel, axle, caster, lidar, clocks, floor };

struct Finding {
  Spot spot = Spot::axle;
  std::string what;     ///< "left wheel 1.5 mm off centre, 2.0 % of its radius"
  std::string look_at;  ///< what a mechanic looks at; empty: nothing
  std::string remedy;   ///< what the software does about it
};

/// Dimensions that differ from those that were stated, by more than two deviations.
std::vector<Finding> dimension_findings(const Calibration& calibration);
/// The effects, in the order of the file.
std::vector<Finding> effect_findings(const Calibration& calibration);
/// The same as sentences, one for neighbours that have one remedy.
std::vector<std::string> effect_lines(const Calibration& calibration);

}  // namespace odomcalib::cli
