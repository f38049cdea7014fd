// Smooth terms in the calibration file: member "curves", a list of {variable, carrier, low, high,
// coefficients, ...}.
#pragma once

#include <string>
#include <vector>

#include "calib/terms/smooth_term.hpp"

namespace odomcalib::calib::terms {

inline constexpr const char* kSmoothTermsMember = "curves";

struct FittedSmoothTerm {
  SmoothTerm smooth;
  std::vector<double> coefficients;
  std::string
      named_term;  ///< named effect whose function it completes; empty: nothing in the catalogue explains it
};

std::string smooth_terms_to_json(const std::vector<FittedSmoothTerm>& smooths);

/// Entries that are not understood are left out: a newer program's smooth term must not stop odometry.
std::vector<FittedSmoothTerm> smooth_terms_from_json(const std::string& text);

}  // namespace odomcalib::calib::terms
