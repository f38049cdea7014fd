#include "calib/classical/missing_motion.hpp"

#include "calib/classical/settings.hpp"

namespace odomcalib::calib::classical {

std::optional<std::string> missing_motion(std::span<const wheels::WheelMotion> motions) {
  double straight = 0.0, turning = 0.0, both = 0.0;  // second moments
  for (const wheels::WheelMotion& motion : motions) {
    const double sum = motion.right + motion.left, difference = motion.right - motion.left;
    straight += sum * sum;
    turning += difference * difference;
    both += sum * difference;
  }
  constexpr double kShare = settings::kHardlyAny * settings::kHardlyAny;
  if (straight <= 0.0 && turning <= 0.0) return "straight lines, arcs and turns on the spot, both ways";
  if (turning < kShare * straight) return "turns on the spot, both ways";
  if (straight < kShare * turning) return "straight lines, forward and backward";
  if (straight * turning - both * both < kShare * straight * turning)
    return "straight lines and turns on the spot in one drive";
  return std::nullopt;
}

std::string record_more(std::span<const wheels::WheelMotion> motions) {
  return "record " +
         missing_motion(motions).value_or("more of each motion: straight lines, arcs and turns on the spot");
}

}  // namespace odomcalib::calib::classical
