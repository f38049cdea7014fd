// The motion that would teach most, after a first calibration.
#pragma once

#include <optional>
#include <string>

#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::report {

struct NextTest {
  std::string manoeuvre;  ///< straights, slow_straights, turns, arcs, accelerations, reversals or headings
  std::string why;        ///< a sentence for people
};

/// In this order: the motion that separates an effect from those that the data cannot separate from it; more
/// of the motion that an unnamed defect depends on; the motion that determines the least certain dimension,
/// unless it is certain to what scan matching allows. nullopt: nothing to gain.
std::optional<NextTest> next_test(const Calibration& calibration);

}  // namespace odomcalib::calib::report
