#include "calib/terms/bases/change_point.hpp"

namespace odomcalib::calib::terms {

std::size_t ChangePoint::parts(vehicle::Channel channel) {
  if (channel == vehicle::Channel::way_turned) return 3;
  return channel == vehicle::Channel::both_travel ? 2 : 1;
}

BasisValues ChangePoint::values(const Argument& at) const {
  const bool is_now = at.z >= moment, of_sensor = at.dependence.channel == vehicle::Channel::way_turned;
  BasisValues functions;
  for (std::size_t part = 0; part < parts(at.dependence.channel); ++part)
    functions.push_back(is_now == of_sensor ? 0.0 : 1.0);
  return functions;
}

}  // namespace odomcalib::calib::terms
