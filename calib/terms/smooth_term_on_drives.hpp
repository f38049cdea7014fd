// Properties of a smooth term over drives: the range of its covariate, its mean, its spread.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "calib/terms/smooth_term.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::terms {

/// 0.5 and 99.5 % quantiles of the covariate while the wheels turn; equal when it does not vary.
std::pair<double, double> range_of(vehicle::Covariate covariate,
                                   std::span<const vehicle::DriveModel* const> models,
                                   std::size_t memory = vehicle::kUsualMemory);

/// Drives that go only one way cannot separate an unsigned way's addition to a signed one from the wheels.
bool goes_both_ways(std::span<const vehicle::DriveModel* const> models);

/// The rest of a wheel's or the track's term about its mean is a term of the same kind; a constant that
/// pushes the same way whichever way the wheel turns is none.
bool may_be_centred(const SmoothTerm& smooth);
/// The same smooth term about its mean over these drives.
SmoothTerm centred(SmoothTerm smooth, std::span<const vehicle::DriveModel* const> models);

/// Odometry does without what belongs to the place or the day: then the base must be that of the whole drive.
/// A sensor that was moved is where it is, a lidar that warmed up is warm.
SmoothTerm as_of_the_drive(SmoothTerm smooth, std::span<const vehicle::DriveModel* const> models);
/// Many of them in one pass over the drives.
std::vector<SmoothTerm> as_of_the_drive(std::vector<SmoothTerm> smooths,
                                        std::span<const vehicle::DriveModel* const> models);

/// Root mean square of the smooth term over the motion of its channel in these drives.
double spread_of(const SmoothTerm& smooth, std::span<const double> coefficients,
                 std::span<const vehicle::DriveModel* const> models);

/// Half of what lies between the least and the most of the smooth term in these drives, where their wheels
/// turn.
double half_span_of(const SmoothTerm& smooth, std::span<const double> coefficients,
                    std::span<const vehicle::DriveModel* const> models);

/// Driven one way only, the mean of a pull over the headings is a difference of the wheels.
bool leaves_mean_to_wheels(const SmoothTerm& smooth, std::span<const vehicle::DriveModel* const> models);

}  // namespace odomcalib::calib::terms
