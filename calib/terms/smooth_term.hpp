// The non-parametric fallback: a defect that depends on one observed covariate, whatever the function.
#pragma once

#include <span>
#include <vector>

#include "calib/terms/basis.hpp"

namespace odomcalib::calib::terms {

/// f(z) = sum of coefficients times the basis' functions of the covariate z.
/// Functions are zero at rest where the covariate has a rest. Any other constant is a base parameter's,
/// except on channels of the unsigned way in drives both ways, and on the turn path, where it is the first
/// function.
struct SmoothTerm {
  vehicle::Dependence dependence;
  double low = -1.0, high = 1.0;  ///< range of the covariate, in its unit; of a position, of both x and y
  std::size_t memory = vehicle::kUsualMemory;  ///< which way to understand what happened before
  bool with_motion =
      false;  ///< of an acceleration, the growth of the speed magnitude instead, so that braking is negative
  Basis basis = usual_basis(dependence, memory);
  /// Subtracted from the functions; none: 0. Functions that are zero at rest leave the base parameters the
  /// meaning of slow motion; functions without a mean leave them that of the drive they were fitted to.
  std::vector<double> mean = {};
  bool strong = false;  ///< a tenth and more, which few robots do and only plain data should be believed
  bool operator==(const SmoothTerm&) const = default;
};

/// The smooth term's basis if it is such a one, else null.
template <typename Kind>
const Kind* basis_as(const SmoothTerm& smooth) {
  return std::get_if<Kind>(&smooth.basis);
}
/// The same smooth term as a sum of other functions.
SmoothTerm on_basis(SmoothTerm smooth, Basis basis);
/// The same smooth term, expected to be large.
SmoothTerm strong(SmoothTerm smooth);

/// The channels that a smooth term acts on: its own, or, of a covariate that each wheel has for itself, the
/// travel of the left and of the right wheel with the same coefficients, or, of an event, with one for each;
/// of a sensor that was moved, its three.
std::span<const vehicle::Channel> acts_on(const SmoothTerm& smooth);
/// Whether the function is one of that channel's; otherwise it is zero there.
bool belongs_to(const SmoothTerm& smooth, std::size_t function, std::size_t part);

/// Values of the smooth term's functions.
/// @param part index of the channel among those it acts on
BasisValues functions_of(const SmoothTerm& smooth, const vehicle::StepContext& context, std::size_t part = 0);
/// Factors of the coefficients in an interval: the functions, or on the sensor's yaw their growth.
BasisValues functions_in(const SmoothTerm& smooth, const vehicle::StepContext& context, std::size_t part = 0);
std::size_t function_count(const SmoothTerm& smooth);
/// Whether the functions are the same on whichever channel, but for their mean.
bool has_functions_of_covariate(const SmoothTerm& smooth);
/// Whether both have the same functions but for their means, so that they need be computed only once.
bool differ_in_channel_only(const SmoothTerm& a, const SmoothTerm& b);

/// A mast that sways: the sensor turns on the base.
bool is_sway(const SmoothTerm& smooth);
/// A sensor that was moved on the base at some moment.
bool is_bump(const SmoothTerm& smooth);
/// A change of the sensor's place on the base.
bool concerns_sensor(const SmoothTerm& smooth);
/// A change of the sensor's place, a metre that changes as a lidar warms up, or a sideways motion that goes
/// with time or with the last turn: no base begins to crab, but a mount gives way. None of odometry's.
bool belongs_to_lidar(const SmoothTerm& smooth);

/// Has a phase or an origin that the next drive does not share.
bool is_of_one_drive(const SmoothTerm& smooth);

/// All of it at one moment: no function that bends, but an event.
bool happens_at_once(const SmoothTerm& smooth);

}  // namespace odomcalib::calib::terms
