// Smooth terms in the calibration file: member "curves".
#pragma once

#include <string>
#include <vector>

#include "calib/terms/smooth_term.hpp"
#include "proto/calibration/members.hpp"

namespace odomcalib::calib::terms {

struct FittedSmoothTerm {
  SmoothTerm smooth;
  std::vector<double> coefficients;
  std::string
      named_term;  ///< named effect whose function it completes; empty: nothing in the catalogue explains it
};

std::vector<SmoothTermEntry> entries_of(const std::vector<FittedSmoothTerm>& smooths);

/// Entries that are not understood are left out: a newer program's smooth term must not stop odometry.
std::vector<FittedSmoothTerm> smooth_terms_of(const std::vector<SmoothTermEntry>& entries);

}  // namespace odomcalib::calib::terms
