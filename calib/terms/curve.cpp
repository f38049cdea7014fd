#include "calib/terms/curve.hpp"

#include "calib/terms/basis.hpp"

namespace odomcalib::calib::terms {

bool is_sway(const Curve& curve) { return curve.law.carrier == vehicle::Carrier::sensor_yaw; }

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
  return belongs_to_the_place(curve.law.variable) || curve.period > 0.0;
}

bool takes_an_event(const Curve& curve) {
  return curve.law.variable == vehicle::Variable::since_stop || is_relay(curve.law.variable, curve.memory);
}

bool happens_at_once(const Curve& curve) { return curve.moment > 0.0; }

bool has_polynomials(const Curve& curve) {
  Curve plain = curve, bent = curve;
  plain.mean = bent.mean = {};
  plain.degree = kPlainest;
  bent.degree = kDegrees;
  return basis_size(plain) != basis_size(bent);
}

bool has_splines(const Curve& curve) { return curve.knots > kKnots; }

Curve strong(Curve curve) {
  curve.strong = true;
  return curve;
}

}  // namespace odomcalib::calib::terms
