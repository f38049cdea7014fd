// Candidates that the data cannot separate.
#pragma once

#include <string>
#include <vector>

#include "calib/selection/candidate.hpp"
#include "calib/selection/score.hpp"

namespace odomcalib::calib::selection {

/// Those of the others for which the gap of -2 log L that this data would show is too small to separate them
/// from the candidate that is believed to be there.
std::vector<std::size_t> too_close(const ScoreTable& table, std::size_t candidate,
                                   const std::vector<std::size_t>& others);

/// Covariates, other than the smooth term's own, whose smooth terms would have explained most of what it
/// explains.
/// @param index of a smooth term
std::vector<vehicle::Covariate> covariates_like(const std::vector<Candidate>& candidates,
                                                const ScoreTable& table, std::size_t index);

/// Names that may be meant instead of a candidate's: those of its competitors, and those that no motion
/// separates from it.
std::vector<std::string> aliases_among(const std::vector<Candidate>& candidates, std::size_t candidate,
                                       const std::vector<std::size_t>& competitors);

}  // namespace odomcalib::calib::selection
