#include "calib/terms/bases/change_point.hpp"

namespace odomcalib::calib::terms {

std::size_t ChangePoint::parts(vehicle::Carrier carrier) {
  if (carrier == vehicle::Carrier::way_turned) return 3;
  return carrier == vehicle::Carrier::both_travel ? 2 : 1;
}

BasisValues ChangePoint::values(const Argument& at) const {
  const bool is_now = at.z >= moment, of_sensor = at.law.carrier == vehicle::Carrier::way_turned;
  BasisValues functions;
  for (std::size_t part = 0; part < parts(at.law.carrier); ++part)
    functions.push_back(is_now == of_sensor ? 0.0 : 1.0);
  return functions;
}

}  // namespace odomcalib::calib::terms
