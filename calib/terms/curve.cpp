#include "calib/terms/curve.hpp"

#include <array>
#include <utility>

namespace odomcalib::calib::terms {
namespace {

/// Speed or turn rate of what an acceleration is one of.
double motion_of(vehicle::Variable variable, const vehicle::StepContext& c) {
  switch (variable) {
    case vehicle::Variable::left_acceleration:
      return c.left_speed;
    case vehicle::Variable::right_acceleration:
      return c.right_speed;
    case vehicle::Variable::turn_acceleration:
      return c.turn_rate;
    default:
      return c.speed;
  }
}

/// The curve's variable, as the curve understands it.
double argument_of(const Curve& curve, const vehicle::StepContext& c, std::size_t part) {
  if (part > 0 && curve.law == vehicle::kOfEachWheel) return c.right_speed;
  const double z = value_of(curve.law.variable, c, curve.memory);
  return curve.with_motion ? vehicle::growth_of_pace(z, motion_of(curve.law.variable, c)) : z;
}

BasisValues values_at(const Curve& curve, double z, const vehicle::StepContext& c) {
  const Argument at{z, curve.low, curve.high, curve.law, c};
  return std::visit([&](const auto& basis) { return basis.values(at); }, curve.basis);
}

/// Of each function over the interval.
BasisValues growth(const Curve& curve, const vehicle::StepContext& c) {
  BasisValues after = values_at(curve, c.turn_acceleration_after[curve.memory], c);
  const BasisValues before = values_at(curve, c.turn_acceleration_before[curve.memory], c);
  for (std::size_t k = 0; k < after.size(); ++k) after[k] -= before[k];
  return after;
}

}  // namespace

Curve on_basis(Curve curve, Basis basis) {
  curve.basis = std::move(basis);
  return curve;
}

Curve strong(Curve curve) {
  curve.strong = true;
  return curve;
}

std::span<const vehicle::Carrier> acts_on(const Curve& curve) {
  static constexpr std::array kEachWheel = {vehicle::Carrier::left_travel, vehicle::Carrier::right_travel};
  // Levers first: the sensor's way is that of its place, seen by axes that were turned.
  static constexpr std::array kPlace = {vehicle::Carrier::turn_side, vehicle::Carrier::turn_ahead,
                                        vehicle::Carrier::way_turned};
  if (is_bump(curve)) return kPlace;
  const bool is_of_both_wheels = happens_at_once(curve) && curve.law.carrier == vehicle::Carrier::both_travel;
  if (curve.law == vehicle::kOfEachWheel || is_of_both_wheels) return kEachWheel;
  return {&curve.law.carrier, 1};
}

bool belongs_to(const Curve& curve, std::size_t function, std::size_t part) {
  return !happens_at_once(curve) || function == part;
}

BasisValues functions_of(const Curve& curve, const vehicle::StepContext& c, std::size_t part) {
  BasisValues functions = values_at(curve, argument_of(curve, c, part), c);
  for (std::size_t k = 0; k < curve.mean.size(); ++k) functions[k] -= curve.mean[k];
  if (happens_at_once(curve))
    for (std::size_t k = 0; k < functions.size(); ++k)
      if (!belongs_to(curve, k, part)) functions[k] = 0.0;
  return functions;
}

BasisValues functions_in(const Curve& curve, const vehicle::StepContext& c, std::size_t part) {
  return is_sway(curve) ? growth(curve, c) : functions_of(curve, c, part);
}

std::size_t function_count(const Curve& curve) { return functions_of(curve, vehicle::StepContext{}).size(); }

bool is_sway(const Curve& curve) { return basis_as<Sway>(curve) != nullptr; }

bool is_bump(const Curve& curve) {
  return happens_at_once(curve) && curve.law.carrier == vehicle::Carrier::way_turned;
}

bool concerns_sensor(const Curve& curve) { return is_sway(curve) || is_bump(curve); }

bool is_the_lidars(const Curve& curve) {
  const auto [variable, carrier] = curve.law;
  const bool crabs = carrier == vehicle::Carrier::sideways || carrier == vehicle::Carrier::sideways_path;
  const bool gives_way = variable == vehicle::Variable::time || variable == vehicle::Variable::previous_turn;
  return concerns_sensor(curve) || carrier == vehicle::Carrier::scale || (crabs && gives_way);
}

bool is_of_one_drive(const Curve& curve) {
  return belongs_to_the_place(curve.law.variable) || basis_as<Cycle>(curve) != nullptr;
}

bool takes_an_event(const Curve& curve) {
  return curve.law.variable == vehicle::Variable::since_stop || basis_as<Relay>(curve) != nullptr;
}

bool happens_at_once(const Curve& curve) { return basis_as<ChangePoint>(curve) != nullptr; }

}  // namespace odomcalib::calib::terms
