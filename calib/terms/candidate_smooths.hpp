// Smooth terms that are worth asking for, and the other shapes of one that was found.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calib/terms/smooth_term.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::terms {

/// Channels that may repeat themselves in time.
inline constexpr std::array kPeriodicChannels = {vehicle::Channel::both_travel, vehicle::Channel::left_travel,
                                                 vehicle::Channel::right_travel, vehicle::Channel::yaw_path};

/// Smooth terms worth trying on this data: every sensible (covariate, channel) whose covariate varies, on its
/// 0.5 to 99.5 % range, higher harmonics of the wheels, and periods of time between 8 s and two thirds of the
/// recording, as far as they are no more than settings::kMostCycles in it.
std::vector<SmoothTerm> candidate_smooths(std::span<const vehicle::DriveModel* const> models);

/// The same term in other shapes: splines more or less smooth, other ways to understand what happened before.
std::vector<SmoothTerm> other_shapes(const SmoothTerm& smooth,
                                     std::span<const vehicle::DriveModel* const> models);

/// Floors that repeat themselves: waves of 0.2 to 1.25 m in all directions of the plane, as far apart as the
/// place that was driven on can tell them (its Fourier transform's resolution). None where wheels are scored
/// on more than one recording, whose places have no common origin.
std::vector<SmoothTerm> periodic_smooths(std::span<const vehicle::DriveModel* const> models);

}  // namespace odomcalib::calib::terms
