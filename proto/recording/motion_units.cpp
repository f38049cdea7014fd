#include "proto/recording/motion_units.hpp"

#include <array>
#include <numbers>

namespace odomcalib {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr auto kWheels = MotionSource::wheels;
constexpr auto kSpeeds = MotionSource::wheel_speeds;
constexpr auto kOdometry = MotionSource::odometry;

constexpr std::array kUnits = {MotionUnit{kWheels, "turns", kTurn},
                               MotionUnit{kWheels, "degrees", kTurn / 360.0},
                               MotionUnit{kWheels, "metres at the rim", 0.0, 1.0},
                               MotionUnit{kWheels, "centimetres at the rim", 0.0, 1e-2},
                               MotionUnit{kWheels, "millimetres at the rim", 0.0, 1e-3},
                               MotionUnit{kSpeeds, "rpm", kTurn / 60.0},
                               MotionUnit{kSpeeds, "rpm times 10", kTurn / 600.0},
                               MotionUnit{kSpeeds, "turns per second", kTurn},
                               MotionUnit{kSpeeds, "degrees per second", kTurn / 360.0},
                               MotionUnit{kSpeeds, "metres per second at the rim", 0.0, 1.0},
                               MotionUnit{kSpeeds, "centimetres per second at the rim", 0.0, 1e-2},
                               MotionUnit{kSpeeds, "millimetres per second at the rim", 0.0, 1e-3},
                               MotionUnit{kOdometry, "centimetres", 1e-2},
                               MotionUnit{kOdometry, "millimetres", 1e-3},
                               MotionUnit{kOdometry, "inches", 0.0254},
                               MotionUnit{kOdometry, "feet", 0.3048}};

}  // namespace

std::span<const MotionUnit> motion_units() { return kUnits; }

const char* si_unit_of(MotionSource source) {
  switch (source) {
    case MotionSource::wheels:
      return "rad";
    case MotionSource::wheel_speeds:
      return "rad/s";
    case MotionSource::odometry:
      return "m";
    case MotionSource::ticks:
      break;
  }
  return "counts";
}

double factor_of(const MotionUnit& unit, const RobotDescription& robot) {
  if (unit.of_rim == 0.0) return 1.0 / unit.size;
  const double radius = 0.25 * (robot.left_wheel_diameter + robot.right_wheel_diameter);
  return radius / unit.of_rim;
}

}  // namespace odomcalib
