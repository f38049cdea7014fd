// Meanings of the parameters of the effects, in words for who reads a report.
#pragma once

#include <span>
#include <string_view>

namespace odomcalib::calib::terms {

struct ParameterMeaning {
  std::string_view effect, parameter;
  std::string_view label;  ///< which of the effect's parameters it is, for a table; empty: the only one
  double factor;           ///< from the SI unit to the one that people are shown
  std::string_view unit;   ///< that one; empty: a choice or a number without a unit
  std::string_view is;
  /// The finding, as a part of a sentence: {} is the value without its sign, with its unit; [a|b] is a where
  /// the value is positive and b where it is negative. Empty: a detail that no sentence needs.
  std::string_view said;
};

/// Meanings of the parameters of every effect of the catalogues, in their order.
std::span<const ParameterMeaning> parameter_meanings();
/// nullptr where there is none, as for a parameter of a file from another version.
const ParameterMeaning* meaning_of(std::string_view effect, std::string_view parameter);

}  // namespace odomcalib::calib::terms
