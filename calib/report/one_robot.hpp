// Whether several recordings are of one robot in one state: what the calibration file and the verdict say.
#pragma once

#include <optional>
#include <span>

#include "calib/report/gate.hpp"
#include "calib/selection/homogeneity.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::report {

/// Recordings that state different robots; nullopt where all that state one state the same. Error: refused.
std::optional<Error> different_robots(std::span<const Recording> recordings);

/// What speaks against one set of lengths; nullopt where chance explains the differences.
std::optional<Apart> recordings_apart(const selection::Homogeneity& found,
                                      std::span<const Recording> recordings);

/// The members `recordings` and `homogeneity` of the calibration file.
void store_homogeneity(const selection::Homogeneity& found, std::span<const Recording> recordings,
                       Calibration& calibration);

}  // namespace odomcalib::calib::report
