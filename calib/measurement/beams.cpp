#include "calib/measurement/beams.hpp"

#include <cmath>

namespace odomcalib::calib::measurement {

std::vector<Beam> make_beams(const Scan& scan, const matching::BeamMotion& motion) {
  std::vector<Beam> beams;
  beams.reserve(scan.ranges.size());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (!matching::is_usable(scan, i)) continue;
    const math::Pose pose = motion(matching::beam_time(scan, i));
    const double angle = pose.yaw + scan.angle(i);
    beams.push_back(
        {{pose.x, pose.y}, {std::cos(angle), std::sin(angle)}, static_cast<double>(scan.ranges[i])});
  }
  return beams;
}

}  // namespace odomcalib::calib::measurement
