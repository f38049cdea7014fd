// Recordings that are solved together are of one robot: whether what they state says that they are of two
// robots. What they show when they were fitted is judged later (report/homogeneity.hpp,
// report/one_robot.hpp).
#pragma once

#include <optional>
#include <span>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// Why these recordings are of two robots; nullopt where those that state a robot or its size state the same.
/// Errors: format (their nominal lengths or ticks per turn differ), refused (they name different robots).
/// @param same_robot somebody says that they are of one, whatever names they carry
std::optional<Error> two_robots(std::span<const Recording> recordings, bool same_robot);

}  // namespace odomcalib::calib::ingest
