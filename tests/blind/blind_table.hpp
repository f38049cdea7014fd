// What a blind campaign says, as a table in Markdown.
#pragma once

#include <string>
#include <vector>

#include "tests/blind/blind_trial.hpp"

namespace odomcalib::blind {

/// The effect hurts enough to be seen: the plain fit's error on the fresh drive, or its held-out residual, is
/// at least 1.3 times what it is without the effect.
bool is_detectable(const Trial& trial);
/// Every effect that is in the catalogue is named, or is in the named set of those that look alike.
bool names_every_effect(const Trial& trial);
/// An effect outside the catalogue is flagged, and a variable that it depends on is among those named.
bool flags_right_variable(const Trial& trial);
/// Effects of the place, the day or the heading are reported but not compensated.
bool belongs_to_the_place(const Trial& trial);

std::string table(const std::vector<Trial>& trials);

}  // namespace odomcalib::blind
