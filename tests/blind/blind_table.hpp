// Results of a blind campaign, as a table in Markdown.
#pragma once

#include <string>
#include <vector>

#include "tests/blind/blind_trial.hpp"

namespace odomcalib::blind {

inline constexpr double kSigmas = 3.0;  ///< stated deviations within which a length is right

bool has_no_effect(const Trial& trial);
bool is_of_the_catalogue(const Trial& trial);
bool is_outside_the_catalogue(const Trial& trial);
/// Something beyond the six base parameters is reported.
bool claims_anything(const Trial& trial);
/// Odometry is worse than by the plain fit, beyond what a fresh drive can tell of that one's error.
bool worse_than_plain(const Trial& trial);
/// The effect hurts enough to be seen: the plain fit's error on the fresh drive, or its held-out residual, is
/// at least 1.3 times what it is without the effect.
bool is_detectable(const Trial& trial);
/// Every effect that is in the catalogue is named, or is in the named set of those that look alike.
bool names_every_effect(const Trial& trial);
/// An effect outside the catalogue is flagged, and a variable that it depends on is among those named.
bool flags_right_variable(const Trial& trial);
/// Effects of the place, the day or the heading are reported but not compensated.
bool belongs_to_the_place(const Trial& trial);

/// One line for each campaign, and one for all recordings: named, flagged, false findings with their exact
/// interval, lengths, and the error over that of the robot without the effect.
std::string campaign_table(const std::vector<Trial>& trials);

/// All recordings, and a line for each kind of effect.
std::string table(const std::vector<Trial>& trials);

}  // namespace odomcalib::blind
