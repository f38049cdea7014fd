// What to add next, by the scores of one round.
#pragma once

#include <cstddef>
#include <optional>

#include "calib/selection/search_result.hpp"
#include "calib/selection/search_round.hpp"

namespace odomcalib::calib::selection {

/// Cannot spoil odometry.
bool is_clock(const Candidate& candidate);

/// Whether the score is significant at the candidate's own level.
bool passes(std::size_t candidate, const SearchRound& round, const SearchResult& found);

std::optional<std::size_t> best_smooth(const SearchRound& round, const SearchResult& found);

/// The best name, unless the smooth term is clearly better: then one on the smooth term's own ground, which
/// may be the second best of two effects.
/// @param smooth term index of the best one, if any
std::optional<Trial> best_name_beside(std::optional<std::size_t> smooth, SearchRound& round,
                                      const SearchResult& found);

}  // namespace odomcalib::calib::selection
