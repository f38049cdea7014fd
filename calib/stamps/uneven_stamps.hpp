// Recordings whose stamps are uneven although what they stamp was sampled evenly.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/estimators/joint.hpp"
#include "calib/stamps/even_stamps.hpp"
#include "proto/recording.hpp"

namespace odomcalib::calib {

/// Even stamps of the ticks, where counts grow steadily by number and not by stamp; nothing where the stamps
/// are right, or where the wheels hardly turn. Counts that were sent twice get the same stamp.
std::optional<EvenStamps> even_ticks(const Recording& recording);

/// Even stamps of the scans, where the motion between them is that of even times and not of the stamps;
/// nothing where the stamps are right.
/// @param data of the same recording
/// @param parameters of the base, then of the effects: a fit to the data
std::optional<EvenStamps> even_scans(const Recording& recording, const FitData& data,
                                     const EffectList& effects, const Eigen::VectorXd& parameters);

}  // namespace odomcalib::calib
