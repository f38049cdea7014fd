#include "calib/terms/basis.hpp"

namespace odomcalib::calib::terms {

Basis usual_basis(const vehicle::Law& law, std::size_t memory) {
  if (law.carrier == vehicle::Carrier::sensor_yaw) return Sway{};
  if (is_angle(law.variable)) return Harmonics{};
  if (is_distance_since(law.variable)) return FadingSince{};
  if (is_relay(law.variable, memory)) return Relay{};
  if (law.variable == vehicle::Variable::position) return Surface{};
  if (!is_signed_speed(law.variable)) return Polynomials{};
  return law.carrier == vehicle::Carrier::turn_path ? Basis(TurnPath{}) : Basis(SpeedHats{});
}

}  // namespace odomcalib::calib::terms
