// Two versions of the program on the recordings of one campaign.
#pragma once

#include <string>
#include <vector>

#include "tests/blind/blind_trial.hpp"

namespace odomcalib::blind {

/// In Markdown: of how many recordings each version is right, and whether chance explains how they differ
/// (exact two-sided sign test of those on which only one of them is right: McNemar, Psychometrika 1947).
/// @param one, other of the same recordings in any order; those that only one of them has are left out
std::string paired_table(const std::vector<Trial>& one, const std::vector<Trial>& other);

/// Two-sided: how probable so uneven a split is, or one more so, where both sides are equally likely.
double sign_test(std::size_t one, std::size_t other);

}  // namespace odomcalib::blind
