#include "calib/curves/curve.hpp"

namespace odomcalib::calib {

bool concerns_sensor(const Curve& curve) { return curve.law.carrier == Carrier::sensor_yaw; }

Curve strong(Curve curve) {
  curve.strong = true;
  return curve;
}

}  // namespace odomcalib::calib
