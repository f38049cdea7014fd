#include "calib/terms/basis.hpp"

namespace odomcalib::calib::terms {

Basis usual_basis(const vehicle::Dependence& dependence, std::size_t memory) {
  if (dependence.channel == vehicle::Channel::sensor_yaw) return Sway{};
  if (is_angle(dependence.covariate)) return Harmonics{};
  if (is_distance_since(dependence.covariate)) return FadingSince{};
  if (is_relay(dependence.covariate, memory)) return Relay{};
  if (dependence.covariate == vehicle::Covariate::position) return Surface{};
  if (!is_signed_speed(dependence.covariate)) return Polynomials{};
  return dependence.channel == vehicle::Channel::turn_path ? Basis(TurnPath{}) : Basis(SpeedHats{});
}

}  // namespace odomcalib::calib::terms
