// Common part of all drives of a robot: the effects it shows, and a value of every parameter. A
// DriveModel applies it to the wheels of one drive.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::vehicle {

struct VehicleModel {
  EffectList effects;
  Eigen::VectorXd parameters;  ///< of the base, then of each effect
};

/// Position of an effect's first parameter in the parameter vector.
Eigen::Index first_parameter(const EffectList& effects, std::size_t index);

/// Place of that part of the clock among the effects; nothing where they have none.
std::optional<std::size_t> place_of(const EffectList& effects, ClockPart part);

/// First parameter of that part of the clock; nothing where the effects have none.
std::optional<Eigen::Index> parameter_of(const EffectList& effects, ClockPart part);

/// Delay of the sensor's clock against that of the encoders in the middle of the recording, s; 0 where the
/// model has none.
double delay_of(const VehicleModel& model);

/// The first effects alone, with their parameters.
/// @param count of the effects
VehicleModel first_effects_of(const VehicleModel& model, std::size_t count);

}  // namespace odomcalib::calib::vehicle
