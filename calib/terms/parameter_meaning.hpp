// What the parameters of the effects are, in words for who reads a report.
#pragma once

#include <span>
#include <string_view>

namespace odomcalib::calib::terms {

struct ParameterMeaning {
  std::string_view effect, parameter;
  std::string_view is;
};

/// Of every effect of the catalogues, in their order.
std::span<const ParameterMeaning> parameter_meanings();

}  // namespace odomcalib::calib::terms
