// What wheels and floor add to a motion by chance, for whoever has to know how far odometry may be off.
#pragma once

#include <optional>

#include "calib/estimation/joint.hpp"
#include "calib/measurement/dataset.hpp"
#include "calib/odometry/uncertainty.hpp"

namespace odomcalib::calib::report {

/// By the noise of the fit: the part of the pairs' errors that is neither the reference's nor taken back by
/// the neighbours, over the way that the wheels rolled in them. Forward and sideways it is the same, as the
/// fit has it, less what the lever of the sensor makes of the heading's; forward no less than what wheels
/// that err by themselves add where they turn the base so much.
/// @return nullopt where no trusted pair rolled
std::optional<odometry::IncrementNoise> contact_noise(const measurement::Dataset& dataset,
                                                      const estimation::FitResult& fit);

}  // namespace odomcalib::calib::report
