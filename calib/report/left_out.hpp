// Data left out and data put right on the way from the files to the values: as the calibration file lists
// them, and what of them the verdict weighs.
#pragma once

#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/ingest/recordings.hpp"
#include "calib/measurement/dataset.hpp"
#include "calib/report/gate.hpp"
#include "proto/discarded.hpp"

namespace odomcalib::calib::report {

/// Samples left out of the recordings, and the pairs that gave no motion.
/// @param pairs of each recording; none where no pair was measured
std::vector<Discarded> left_out(std::span<const Recording> recordings,
                                std::span<const measurement::PairSet> pairs);

/// The pairs that a fit does not believe, of each recording.
std::vector<Discarded> outlier_pairs(const measurement::Dataset& dataset, const estimation::FitResult& fit);

/// Repairs that the recordings state themselves, and stamps that were not believed.
std::vector<Repair> repairs_of(const ingest::Recordings& recordings);

/// Losses of what the values stand on: wheels, and scans or poses.
std::vector<Loss> losses_of(std::span<const Recording> recordings);

}  // namespace odomcalib::calib::report
