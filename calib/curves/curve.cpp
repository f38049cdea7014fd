#include "calib/curves/curve.hpp"

namespace odomcalib::calib {

bool concerns_sensor(const Curve& curve) { return curve.law.carrier == Carrier::sensor_yaw; }

bool is_of_one_drive(const Curve& curve) {
  return belongs_to_the_place(curve.law.variable) || curve.period > 0.0;
}

bool takes_an_event(const Curve& curve) {
  return curve.law.variable == Variable::since_stop || is_relay(curve.law.variable, curve.memory);
}

bool has_polynomials(const Curve& curve) {
  const Variable variable = curve.law.variable;
  const bool is_other = concerns_sensor(curve) || curve.period > 0.0 || is_angle(variable) ||
                        is_distance_since(variable) || is_relay(variable, curve.memory) ||
                        variable == Variable::position || is_signed_speed(variable) || has_splines(curve);
  return !is_other;
}

bool has_splines(const Curve& curve) { return curve.knots > kKnots; }

Curve strong(Curve curve) {
  curve.strong = true;
  return curve;
}

}  // namespace odomcalib::calib
