// The known word that somebody meant.
#pragma once

#include <optional>
#include <set>
#include <string>

namespace odomcalib {

/// The known word nearest to `word`: the same last part of a dotted path ("track_width" for
/// "robot.track_width"), the first words of it ("track"), or at most a third of the letters inserted, left
/// out, changed or exchanged. Nothing when none is near enough. Among equals the one with the fewest other
/// letters counts, then the first in alphabetical order.
std::optional<std::string> near_miss(const std::string& word, const std::set<std::string>& known);

}  // namespace odomcalib
