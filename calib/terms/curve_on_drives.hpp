// What drives show of a curve: the range of its variable, its mean, its spread.
#pragma once

#include <span>
#include <utility>

#include "calib/terms/curve.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::terms {

/// 0.5 and 99.5 % quantiles of the variable while the wheels turn; equal when it does not vary.
std::pair<double, double> range_of(vehicle::Variable variable,
                                   std::span<const vehicle::DriveModel* const> models,
                                   std::size_t memory = vehicle::kUsualMemory);

/// What an unsigned way adds to a signed one, a drive that goes only one way cannot tell from the wheels.
bool goes_both_ways(std::span<const vehicle::DriveModel* const> models);

/// What is left of a wheel's or the track's law about its mean is a law of the same kind; a constant that
/// pushes the same way whichever way the wheel turns is none.
bool may_be_centred(const Curve& curve);
/// The same curve about its mean over these drives.
Curve centred(Curve curve, std::span<const vehicle::DriveModel* const> models);

/// Odometry does without what belongs to the place or the day: then the base must be that of the whole drive.
/// A sensor that was moved is where it is, a lidar that warmed up is warm.
Curve as_of_the_drive(Curve curve, std::span<const vehicle::DriveModel* const> models);

/// Root mean square of the curve over the motion of its carrier in these drives.
double spread_of(const Curve& curve, std::span<const double> coefficients,
                 std::span<const vehicle::DriveModel* const> models);

/// Half of what lies between the least and the most of the curve in these drives, where their wheels turn.
double half_span_of(const Curve& curve, std::span<const double> coefficients,
                    std::span<const vehicle::DriveModel* const> models);

/// Driven one way only, the mean of a pull over the headings is a difference of the wheels.
bool leaves_mean_to_wheels(const Curve& curve, std::span<const vehicle::DriveModel* const> models);

}  // namespace odomcalib::calib::terms
