#include "calib/selection/event_text.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <variant>

namespace odomcalib::calib::selection {
namespace {

std::string signed_number(double value, int digits) {
  std::ostringstream out;
  out << std::showpos << std::fixed << std::setprecision(digits) << value;
  return out.str();
}

std::string percent(double share) { return signed_number(1e2 * share, 2) + " %"; }
std::string millimetres(double metres) { return signed_number(1e3 * metres, 1) + " mm"; }

/// The smooth term's coefficients move the base as the sensor sees it, the other way round.
math::Pose moved_by(const std::vector<double>& coefficients, const math::Pose& mount) {
  const math::Pose before = compose({-coefficients[0], -coefficients[1], -coefficients[2]}, mount);
  return {mount.x - before.x, mount.y - before.y, coefficients[2]};
}

std::string change_of_place(const std::vector<double>& coefficients, const math::Pose& mount) {
  const math::Pose by = moved_by(coefficients, mount);
  return "the lidar was moved on the robot (x " + millimetres(by.x) + ", y " + millimetres(by.y) + ", yaw " +
         signed_number(by.yaw * 180.0 / math::kPi, 2) + " deg); its pose is the one since then: fasten it";
}

std::string change_of_wheels(const std::vector<double>& c) {
  return "the wheels changed at once (left " + percent(c[0]) + ", right " + percent(c[1]) +
         "), as when a load is taken up or a tyre loses air; the diameters are those over the whole drive: "
         "calibrate again as the robot will work";
}

std::string change_of_track(const std::vector<double>& c) {
  return "the track width changed at once (" + percent(c[0]) +
         "); the one stated is that over the whole drive: calibrate again as the robot will work";
}

}  // namespace

std::string event_to_text(const FittedSmoothTerm& event, const math::Pose& mount) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(1) << std::get<terms::ChangePoint>(event.smooth.basis).moment
      << " s after the beginning ";
  if (is_bump(event.smooth))
    out << change_of_place(event.coefficients, mount);
  else if (event.smooth.dependence.channel == vehicle::Channel::track)
    out << change_of_track(event.coefficients);
  else
    out << change_of_wheels(event.coefficients);
  return out.str();
}

}  // namespace odomcalib::calib::selection
