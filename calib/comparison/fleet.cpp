#include "calib/comparison/fleet.hpp"

#include <algorithm>
#include <cmath>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::comparison {
namespace {

Urgency urgency_of(const Calibration& newest, const std::optional<Difference>& since_last) {
  if (newest.verdict == Verdict::refused) return Urgency::refused;
  if (since_last && since_last->is_change()) return Urgency::changed;
  return newest.verdict == Verdict::accepted ? Urgency::none : Urgency::warnings;
}

double size_of(const Difference& difference) {
  const double metre = difference.metre_error ? std::abs(difference.metre_error->value) : 0.0;
  const double turn =
      difference.turn_error ? std::abs(difference.turn_error->value) / (2.0 * math::kPi) : 0.0;
  return std::max(metre, turn);
}

}  // namespace

const char* name_of(Urgency urgency) {
  switch (urgency) {
    case Urgency::refused:
      return "refused";
    case Urgency::changed:
      return "changed";
    case Urgency::warnings:
      return "warnings";
    case Urgency::none:
      break;
  }
  return "fine";
}

bool RobotStanding::is_before(const RobotStanding& other) const {
  return urgency != other.urgency ? urgency < other.urgency : size > other.size;
}

RobotStanding standing_of(const Calibration& newest, std::span<const Calibration* const> usable) {
  RobotStanding standing;
  if (usable.size() > 1) {
    standing.since_last = difference(*usable[usable.size() - 2], *usable.back());
    standing.size = size_of(*standing.since_last);
  }
  standing.urgency = urgency_of(newest, standing.since_last);
  return standing;
}

}  // namespace odomcalib::calib::comparison
