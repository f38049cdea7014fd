#include "calib/terms/bases/speed_hats.hpp"

namespace odomcalib::calib::terms {
namespace {

/// Whether direction times the channel's unsigned way is the signed one, which the base parameters scale.
bool goes_the_way_of(const vehicle::Dependence& dependence) {
  switch (dependence.channel) {
    case vehicle::Channel::left_path:
      return dependence.covariate == vehicle::Covariate::left_speed;
    case vehicle::Channel::right_path:
      return dependence.covariate == vehicle::Covariate::right_speed;
    case vehicle::Channel::both_path:
    case vehicle::Channel::sideways_path:
    case vehicle::Channel::yaw_path:
      return dependence.covariate == vehicle::Covariate::speed;
    default:
      return false;
  }
}

}  // namespace

double direction_of(double relative) { return std::tanh(relative / 0.03); }

void add_direction(const Argument& at, BasisValues& functions) {
  const double relative = at.relative();
  functions.push_back(goes_the_way_of(at.dependence) ? 1.0 : direction_of(relative));
  functions.push_back(relative);
}

BasisValues SpeedHats::values(const Argument& at) const {
  const double place = kKnots * std::abs(at.relative());
  BasisValues functions;
  for (int k = 1; k <= kKnots; ++k) functions.push_back(hat(place - k));
  add_direction(at, functions);
  return functions;
}

}  // namespace odomcalib::calib::terms
