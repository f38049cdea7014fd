#include "calib/terms/smooth_term.hpp"

#include <array>
#include <utility>

namespace odomcalib::calib::terms {
namespace {

/// Speed or turn rate of what an acceleration is one of.
double motion_of(vehicle::Covariate covariate, const vehicle::StepContext& c) {
  switch (covariate) {
    case vehicle::Covariate::left_acceleration:
      return c.left_speed;
    case vehicle::Covariate::right_acceleration:
      return c.right_speed;
    case vehicle::Covariate::turn_acceleration:
      return c.turn_rate;
    default:
      return c.speed;
  }
}

/// The smooth term's covariate, as the smooth term understands it.
double argument_of(const SmoothTerm& smooth, const vehicle::StepContext& c, std::size_t part) {
  if (part > 0 && smooth.dependence == vehicle::kOfEachWheel) return c.right_speed;
  const double z = value_of(smooth.dependence.covariate, c, smooth.memory);
  return smooth.with_motion ? vehicle::growth_of_speed_magnitude(z, motion_of(smooth.dependence.covariate, c))
                            : z;
}

BasisValues values_at(const SmoothTerm& smooth, double z, const vehicle::StepContext& c) {
  const Argument at{z, smooth.low, smooth.high, smooth.dependence, c};
  return std::visit([&](const auto& basis) { return basis.values(at); }, smooth.basis);
}

/// Growth of each function over the interval.
BasisValues growth(const SmoothTerm& smooth, const vehicle::StepContext& c) {
  BasisValues after = values_at(smooth, c.turn_acceleration_after[smooth.memory], c);
  const BasisValues before = values_at(smooth, c.turn_acceleration_before[smooth.memory], c);
  for (std::size_t k = 0; k < after.size(); ++k) after[k] -= before[k];
  return after;
}

}  // namespace

SmoothTerm on_basis(SmoothTerm smooth, Basis basis) {
  smooth.basis = std::move(basis);
  return smooth;
}

SmoothTerm strong(SmoothTerm smooth) {
  smooth.strong = true;
  return smooth;
}

std::span<const vehicle::Channel> acts_on(const SmoothTerm& smooth) {
  static constexpr std::array kEachWheel = {vehicle::Channel::left_travel, vehicle::Channel::right_travel};
  // Levers first: the sensor's way is that of its place, seen by axes that were turned.
  static constexpr std::array kPlace = {vehicle::Channel::turn_side, vehicle::Channel::turn_ahead,
                                        vehicle::Channel::way_turned};
  if (is_bump(smooth)) return kPlace;
  const bool is_of_both_wheels =
      happens_at_once(smooth) && smooth.dependence.channel == vehicle::Channel::both_travel;
  if (smooth.dependence == vehicle::kOfEachWheel || is_of_both_wheels) return kEachWheel;
  return {&smooth.dependence.channel, 1};
}

bool belongs_to(const SmoothTerm& smooth, std::size_t function, std::size_t part) {
  return !happens_at_once(smooth) || function == part;
}

BasisValues functions_of(const SmoothTerm& smooth, const vehicle::StepContext& c, std::size_t part) {
  BasisValues functions = values_at(smooth, argument_of(smooth, c, part), c);
  for (std::size_t k = 0; k < smooth.mean.size(); ++k) functions[k] -= smooth.mean[k];
  if (happens_at_once(smooth))
    for (std::size_t k = 0; k < functions.size(); ++k)
      if (!belongs_to(smooth, k, part)) functions[k] = 0.0;
  return functions;
}

BasisValues functions_in(const SmoothTerm& smooth, const vehicle::StepContext& c, std::size_t part) {
  return is_sway(smooth) ? growth(smooth, c) : functions_of(smooth, c, part);
}

std::size_t function_count(const SmoothTerm& smooth) {
  return functions_of(smooth, vehicle::StepContext{}).size();
}

bool has_functions_of_covariate(const SmoothTerm& smooth) {
  return !basis_as<SpeedHats>(smooth) && !basis_as<ChangePoint>(smooth) && !basis_as<TurnPath>(smooth) &&
         !is_sway(smooth) && acts_on(smooth).size() == 1;
}

bool differ_in_channel_only(const SmoothTerm& a, const SmoothTerm& b) {
  if (!has_functions_of_covariate(a) || !has_functions_of_covariate(b)) return false;
  SmoothTerm other = b;
  other.dependence.channel = a.dependence.channel;
  other.mean = a.mean;
  other.strong = a.strong;
  return a == other;
}

bool is_sway(const SmoothTerm& smooth) { return basis_as<Sway>(smooth) != nullptr; }

bool is_bump(const SmoothTerm& smooth) {
  return happens_at_once(smooth) && smooth.dependence.channel == vehicle::Channel::way_turned;
}

bool concerns_sensor(const SmoothTerm& smooth) { return is_sway(smooth) || is_bump(smooth); }

bool belongs_to_lidar(const SmoothTerm& smooth) {
  const auto [covariate, channel] = smooth.dependence;
  const bool crabs = channel == vehicle::Channel::sideways || channel == vehicle::Channel::sideways_path;
  const bool gives_way =
      covariate == vehicle::Covariate::time || covariate == vehicle::Covariate::previous_turn;
  return concerns_sensor(smooth) || channel == vehicle::Channel::scale || (crabs && gives_way);
}

bool is_of_one_drive(const SmoothTerm& smooth) {
  return belongs_to_the_place(smooth.dependence.covariate) || basis_as<Cycle>(smooth) != nullptr;
}

bool happens_at_once(const SmoothTerm& smooth) { return basis_as<ChangePoint>(smooth) != nullptr; }

}  // namespace odomcalib::calib::terms
