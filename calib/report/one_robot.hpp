// Whether several recordings are of one robot in one state: what the calibration file and the verdict say.
// Their own statements were compared before anything was measured (ingest/recording_check.hpp).
#pragma once

#include <optional>
#include <span>

#include "calib/report/gate.hpp"
#include "calib/report/homogeneity.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::report {

/// Evidence against one set of lengths; nullopt where chance explains the differences.
std::optional<Disagreement> recordings_apart(const report::Homogeneity& found,
                                             std::span<const Recording> recordings);

/// The members `recordings` and `homogeneity` of the calibration file.
void store_homogeneity(const report::Homogeneity& found, std::span<const Recording> recordings,
                       Calibration& calibration);

}  // namespace odomcalib::calib::report
