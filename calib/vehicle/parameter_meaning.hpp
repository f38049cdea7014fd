// Meaning of a parameter, in words for who reads a report.
#pragma once

#include <string_view>

namespace odomcalib::calib::vehicle {

struct ParameterMeaning {
  std::string_view label = {};  ///< which of the effect's parameters it is, for a table; empty: the only one
  double factor = 1.0;          ///< from the SI unit to the one that people are shown
  std::string_view unit = {};   ///< that one; empty: a choice or a number without a unit
  std::string_view is = {};
  /// The finding, as a part of a sentence: {} is the value without its sign, with its unit; [a|b] is a where
  /// the value is positive and b where it is negative. Empty: a detail that no sentence needs.
  std::string_view said = {};
};

}  // namespace odomcalib::calib::vehicle
