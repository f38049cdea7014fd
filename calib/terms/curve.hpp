// The non-parametric fallback: a defect that depends on one observed variable, whatever the law.
#pragma once

#include <span>
#include <vector>

#include "calib/terms/basis.hpp"

namespace odomcalib::calib::terms {

/// f(z) = sum of coefficients times the basis' functions of the variable z.
/// Functions are zero at rest where the variable has a rest. Any other constant is a base parameter's, except
/// on carriers of the unsigned way in drives both ways, and on the turn path, where it is the first function.
struct Curve {
  vehicle::Law law;
  double low = -1.0, high = 1.0;  ///< range of the variable, in its unit; of a position, of both x and y
  std::size_t memory = vehicle::kUsualMemory;  ///< which way to understand what happened before
  bool with_motion =
      false;  ///< of an acceleration, the growth of the pace instead, so that braking is negative
  Basis basis = usual_basis(law, memory);
  /// Subtracted from the functions; none: 0. Functions that are zero at rest leave the base parameters the
  /// meaning of slow motion; functions without a mean leave them that of the drive they were fitted to.
  std::vector<double> mean = {};
  bool strong = false;  ///< a tenth and more, which few robots do and only plain data should be believed
  bool operator==(const Curve&) const = default;
};

/// The curve's basis if it is such a one, else null.
template <typename Kind>
const Kind* basis_as(const Curve& curve) {
  return std::get_if<Kind>(&curve.basis);
}
/// The same curve as a sum of other functions.
Curve on_basis(Curve curve, Basis basis);
/// The same curve, expected to be large.
Curve strong(Curve curve);

/// The carriers that a curve acts on: its own, or, of a variable that each wheel has for itself, the travel
/// of the left and of the right wheel with the same coefficients, or, of an event, with one for each; of a
/// sensor that was moved, its three.
std::span<const vehicle::Carrier> acts_on(const Curve& curve);
/// Whether the function is one of that carrier's; otherwise it is zero there.
bool belongs_to(const Curve& curve, std::size_t function, std::size_t part);

/// Values of the curve's functions.
/// @param part index of the carrier among those it acts on
BasisValues functions_of(const Curve& curve, const vehicle::StepContext& context, std::size_t part = 0);
/// What the coefficients are multiplied by in an interval: the functions, or on the sensor's yaw their
/// growth.
BasisValues functions_in(const Curve& curve, const vehicle::StepContext& context, std::size_t part = 0);
std::size_t function_count(const Curve& curve);

/// A mast that sways: the sensor turns on the base.
bool is_sway(const Curve& curve);
/// A sensor that was moved on the base at some moment.
bool is_bump(const Curve& curve);
/// A change of the sensor's place on the base.
bool concerns_sensor(const Curve& curve);
/// That, a metre that changes as a lidar warms up, or a sideways motion that goes with time or with the last
/// turn: no base begins to crab, but a mount gives way. None of odometry's.
bool is_the_lidars(const Curve& curve);

/// Has a phase or an origin that the next drive does not share.
bool is_of_one_drive(const Curve& curve);

/// Begins with a stop or a push, of which it is not known how long or how hard it has to be.
bool takes_an_event(const Curve& curve);

/// All of it at one moment: no law that bends, but an event.
bool happens_at_once(const Curve& curve);

}  // namespace odomcalib::calib::terms
