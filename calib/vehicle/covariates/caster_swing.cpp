#include "calib/vehicle/covariates/caster_swing.hpp"

#include <cmath>

#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::vehicle {

/// A wheel that trails by t turns towards the way s of its pivot: tan(beta / 2) falls as exp(-s / t), beta
/// the angle between both (Campion, Bastin and D'Andrea-Novel 1996, eq. 4: no slip across the wheel). A lean
/// turns it on by lean * s / t.
CasterSines CasterSwing::advance(const math::Pose& step, double track_width) {
  CasterSines sines{};
  const double across = -settings::kCasterBehind * track_width * step.yaw;
  const double way = std::hypot(step.x, across);
  const double towards = std::atan2(across, step.x);
  std::size_t k = 0;
  for (const double trail : kCasterTrails) {
    if (!(way > 0.0)) break;
    const double turns = way / trail, fading = std::exp(-turns);
    for (const double lean : kCasterLeans) {
      const double before = math::wrap_angle(direction_[k] - towards);
      const double after = 2.0 * std::atan(std::tan(before / 2.0) * fading) + lean * turns;
      sines[k] = 0.5 * (std::sin(before) + std::sin(after));
      direction_[k++] = towards + after;
    }
  }
  for (double& direction : direction_) direction -= step.yaw;
  return sines;
}

}  // namespace odomcalib::calib::vehicle
