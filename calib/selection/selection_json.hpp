// Smooth terms in the calibration file: member "smooth terms", a list of {covariate, channel, low, high,
// coefficients}.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "calib/selection/search_result.hpp"
#include "calib/terms/smooth_term.hpp"

namespace odomcalib::calib::selection {

inline constexpr const char* kSmoothTermsMember = "curves";

struct FittedSmoothTerm {
  terms::SmoothTerm smooth;
  std::vector<double> coefficients;
  std::string
      named_term;  ///< named effect whose function it completes; empty: nothing in the catalogue explains it
};

std::string considered_to_json(const std::vector<Considered>& considered);

std::string smooth_terms_to_json(const std::vector<FittedSmoothTerm>& smooths);

/// Entries that are not understood are left out: a newer program's smooth term must not stop odometry.
std::vector<FittedSmoothTerm> smooth_terms_from_json(const std::string& text);

}  // namespace odomcalib::calib::selection
