// Noise that wheels and floor add to a motion, for whoever has to know how far odometry may be off.
#pragma once

#include <optional>
#include <span>

#include "calib/measurement/dataset.hpp"
#include "calib/odometry/uncertainty.hpp"
#include "calib/selection/fitted_model.hpp"
#include "calib/validation/held_out.hpp"

namespace odomcalib::calib::report {

/// By errors on data that was not fitted: their part that is neither the reference's nor taken back by the
/// neighbours, over the way that the wheels rolled in them. Forward and sideways it is the same, as the noise
/// model has it, less what the lever of the sensor makes of the heading's; forward no less than what wheels
/// that err by themselves add where they turn the base so much.
/// @param held_out see validation::held_out_errors
/// @return nullopt where nothing was held out or no trusted pair rolled
std::optional<odometry::IncrementNoise> contact_noise(const measurement::Dataset& dataset,
                                                      const selection::FittedModel& model,
                                                      std::span<const validation::HeldOutError> held_out);

}  // namespace odomcalib::calib::report
