// A figure as inline SVG; colours come from the page's style, so that they follow light and dark.
#pragma once

#include <string>

#include "daemon/cli/document.hpp"

namespace odomcalib::cli {

/// Text for HTML and SVG: markup characters replaced.
std::string escaped(const std::string& text);

/// Class of the page's style that has the colour of a curve.
const char* class_of(Curve::Tone tone);

/// The names of the curves stand beside the drawing: the page sets them in letters that do not shrink with
/// it. Empty when there is nothing finite to draw.
std::string to_svg(const Figure& figure);

/// Round values that divide [low, high] into about `wanted` parts.
std::vector<double> axis_marks(double low, double high, int wanted);

}  // namespace odomcalib::cli
