// What gyros said, for the calibration file and its reasons.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calib/estimation/gyro_witness.hpp"

namespace odomcalib::calib::report {

/// No gyro was held against anything.
bool is_silent(const estimation::GyroWitness& witness);

/// A list with an entry for each recording whose gyro was weighed.
/// @param recordings one for each of the gyros
std::string to_json(const estimation::GyroWitness& witness, std::span<const Recording> recordings);

/// A sentence for each gyro that was left out.
std::vector<std::string> remarks_on(const estimation::GyroWitness& witness,
                                    std::span<const Recording> recordings);

}  // namespace odomcalib::calib::report
