// Parameters of the methods of the interface, read from its description.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace odomcalib::control {

/// Names of a method's parameters; empty: it has none, or there is no such method.
/// @param interface text of a Varlink interface
std::vector<std::string> parameters_of(std::string_view method, std::string_view interface);

}  // namespace odomcalib::control
