// The forms in which a recording tells motion: of the wheels, one of the first four; of the robot, one of the
// rest.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

enum class Form { ticks, wheels, wheel_speeds, odometry, pose, scan };
inline constexpr std::size_t kForms = 6;

/// As the lines of JSON Lines are called, and as what the reader left out of them is listed.
const char* name_of(Form form);
/// In a sentence: "ticks", "wheel angles", "scans".
const char* many_of(Form form);

/// The form that told the motion of the wheels.
Form motion_of(const Recording& recording);

/// The form that tells where the robot was: poses push out scans.
Form reference_of(const Recording& recording);

/// s, sorted, as recorded: of what counts were made of, not of the counts. Empty where the recording does not
/// use that form.
std::vector<double> stamps_of(const Recording& recording, Form form);

/// Number of samples of that form that were left out for this reason.
std::size_t left_out(const Recording& recording, Form form, const char* reason);

}  // namespace odomcalib::calib::ingest
