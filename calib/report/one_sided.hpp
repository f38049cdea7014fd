// Parts of a drive that only the counts tell of, or only the reference.
#pragma once

#include <vector>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::report {

/// Scans or poses of times of which there are no counts, and counts of what the wheels turned where there are
/// no scans or poses, each where it is a large part of the drive. A robot that stands may fall silent.
std::vector<Discarded> one_sided(const Recording& recording);

}  // namespace odomcalib::calib::report
