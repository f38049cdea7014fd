// What was left out on the way from the files to the values, and what was put right: as the calibration file
// lists it, and what of it the verdict weighs.
#pragma once

#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/ingest/recordings.hpp"
#include "calib/measurement/dataset.hpp"
#include "calib/report/gate.hpp"
#include "proto/discarded.hpp"

namespace odomcalib::calib::report {

/// Of the recordings, and the pairs that gave no motion.
/// @param pairs of each recording; none where no pair was measured
std::vector<Discarded> left_out(std::span<const Recording> recordings,
                                std::span<const measurement::PairSet> pairs);

/// The pairs that a fit does not believe, of each recording.
std::vector<Discarded> outlier_pairs(const measurement::Dataset& dataset, const estimation::FitResult& fit);

/// What the recordings say of themselves, and stamps that were not believed.
std::vector<Repair> repairs_of(const ingest::Recordings& recordings);

/// Of what the values stand on: wheels, and scans or poses.
std::vector<Loss> losses_of(std::span<const Recording> recordings);

}  // namespace odomcalib::calib::report
