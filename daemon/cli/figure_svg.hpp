// A figure as inline SVG; colours come from the page's style, so that they follow light and dark.
#pragma once

#include <string>

#include "daemon/cli/document.hpp"

namespace odomcalib::cli {

/// Text for HTML and SVG: markup characters replaced.
std::string escaped(const std::string& text);

/// Empty when there is nothing finite to draw.
std::string to_svg(const Figure& figure);

/// Round values that divide [low, high] into about `wanted` parts.
std::vector<double> axis_marks(double low, double high, int wanted);

}  // namespace odomcalib::cli
