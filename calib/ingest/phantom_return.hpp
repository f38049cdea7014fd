// Readings that are no distances: a lidar or its driver that writes a fixed number where nothing came back.
#pragma once

#include <optional>
#include <string>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// The number, m, that far more readings equal to the last digit than any of its neighbours, all the way
/// through the recording: what stands for no return, or a part of the robot. nullopt where none does.
std::optional<double> phantom_return(const Recording& recording);

/// Turns readings of that number into no reading, and counts them as discarded beams.
void remove_readings(Recording& recording, double value);

/// What a user should know of it.
std::string phantom_remark(double value);

}  // namespace odomcalib::calib::ingest
