#include "calib/terms/bases/speed_hats.hpp"

namespace odomcalib::calib::terms {
namespace {

/// Whether direction times the carrier's unsigned way is the signed one, which the base parameters scale.
bool goes_the_way_of(const vehicle::Law& law) {
  switch (law.carrier) {
    case vehicle::Carrier::left_path:
      return law.variable == vehicle::Variable::left_speed;
    case vehicle::Carrier::right_path:
      return law.variable == vehicle::Variable::right_speed;
    case vehicle::Carrier::both_path:
    case vehicle::Carrier::sideways_path:
    case vehicle::Carrier::yaw_path:
      return law.variable == vehicle::Variable::speed;
    default:
      return false;
  }
}

}  // namespace

double direction_of(double relative) { return std::tanh(relative / 0.03); }

void add_direction(const Argument& at, BasisValues& functions) {
  const double relative = at.relative();
  functions.push_back(goes_the_way_of(at.law) ? 1.0 : direction_of(relative));
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
