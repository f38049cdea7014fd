#include "calib/terms/bases/wave.hpp"

#include <complex>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::terms {

BasisValues Wave::values(const Argument& at) const {
  const vehicle::StepContext& c = at.interval;
  const double waves = along_x * c.x + along_y * c.y;
  // More than a thousand waves are tried at every step; single precision of a turn is a ten millionth of one.
  const std::complex<float> here =
      std::polar(1.0F, static_cast<float>(2.0 * math::kPi * (waves - std::floor(waves))));
  const double across = (along_x * c.heading_cosine + along_y * c.heading_sine) /
                        std::sqrt(along_x * along_x + along_y * along_y);
  const double cosine = static_cast<double>(here.real()), sine = static_cast<double>(here.imag());
  return {cosine, sine, across * cosine, across * sine};
}

}  // namespace odomcalib::calib::terms
