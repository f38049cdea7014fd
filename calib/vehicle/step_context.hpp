// Observed quantities of each tick interval.
#pragma once

#include <cstddef>
#include <vector>

#include "calib/vehicle/covariates.hpp"
#include "calib/vehicle/drive_context.hpp"
#include "calib/vehicle/motion_step.hpp"
#include "calib/wheels/wheel_motion.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::vehicle {

/// Observable covariates of each tick interval, from smoothed wheel angles and a geometry that is nearly
/// right; but for what depends on the drive before.
/// @param first interval that is wanted; the first of them takes its acceleration's change from itself alone
std::vector<StepContext> make_context_of_moment(const wheels::WheelTrack& track,
                                                const wheels::BaseParameters& base,
                                                CovariateGroups groups = kAllCovariateGroups,
                                                std::size_t first = 0);
/// The same in place of what `contexts` held: for the last intervals of a track it takes no memory.
void make_context_of_moment(const wheels::WheelTrack& track, const wheels::BaseParameters& base,
                            CovariateGroups groups, std::size_t first, std::vector<StepContext>& contexts);

/// Where the last interval of the track is the present, changes of its acceleration come from what was
/// before: half of a window about it would be missing, and their sum over a drive would grow with the noise.
void fill_past_covariates(StepContext& last, const wheels::WheelTrack& track,
                          const wheels::BaseParameters& base, CovariateGroups groups);

/// With what depends on the drive before.
DriveContext make_context(const wheels::WheelTrack& track, const wheels::BaseParameters& base,
                          CovariateGroups groups = kAllCovariateGroups);

}  // namespace odomcalib::calib::vehicle
