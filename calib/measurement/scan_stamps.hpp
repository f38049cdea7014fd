// Scans whose stamps are uneven although they were taken evenly.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/ingest/even_stamps.hpp"
#include "calib/measurement/sensor_pair.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::measurement {

/// Even stamps of the scans, where the motion between them is that of even times and not of the stamps;
/// nothing where the stamps are right.
/// @param data of the same recording
/// @param parameters of the base, then of the effects: a fit to the data
std::optional<ingest::EvenStamps> even_scans(const Recording& recording, const FitData& data,
                                             const vehicle::EffectList& effects,
                                             const Eigen::VectorXd& parameters);

}  // namespace odomcalib::calib::measurement
