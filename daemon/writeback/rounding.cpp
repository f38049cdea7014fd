#include "daemon/writeback/rounding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "proto/base_quantities.hpp"

namespace odomcalib {
namespace {

using Geometry = std::array<double, kDriveLengths.size()>;  // in that order

/// The two values of the controller's grid around the wanted one, or the wanted one where it has no step.
std::vector<double> candidates(double wanted, const drivers::StoredParameter* held) {
  if (held == nullptr || !(held->step > 0.0)) return {wanted};
  const double steps = (wanted - held->value) / held->step;
  const double below = held->value + std::floor(steps) * held->step;
  if (wanted - below < 1e-9 * held->step) return {below};
  return {below, below + held->step};
}

// With equal counts on both sides the robot goes straight on as far as (dr - dl) / b allows; with opposite
// ones it turns by (dl + dr) / (2 b) of the wheels' angle.
RoundingError error_of(const Geometry& held, const Geometry& wanted) {
  const auto mean = [](const Geometry& g) { return 0.5 * (g[0] + g[1]); };
  const auto heading = [&](const Geometry& g) { return (g[1] - g[0]) / (g[2] * mean(g)); };
  return {mean(held) / mean(wanted) - 1.0, heading(held) - heading(wanted),
          mean(held) / held[2] / (mean(wanted) / wanted[2]) - 1.0};
}

/// Error in m after 1 m straight on, along and across, and after 1 rad on the spot at 1 m from the axle.
double cost(const RoundingError& error) { return std::hypot(error.length, 0.5 * error.heading, error.turn); }

}  // namespace

RoundedParameters round_together(const std::map<std::string, double>& wanted,
                                 const std::vector<drivers::StoredParameter>& held) {
  std::array<std::vector<double>, kDriveLengths.size()> choices;
  Geometry exact{};
  for (std::size_t i = 0; i < kDriveLengths.size(); ++i) {
    const auto found = wanted.find(name_of(kDriveLengths[i]));
    const bool complete = found != wanted.end() && found->second > 0.0;
    if (!complete) return {wanted, {}};
    const auto stored = std::find_if(held.begin(), held.end(),
                                     [&](const auto& h) { return is_name_of(h.quantity, kDriveLengths[i]); });
    exact[i] = found->second;
    choices[i] = candidates(exact[i], stored == held.end() ? nullptr : &*stored);
  }
  RoundedParameters best;
  double least = std::numeric_limits<double>::infinity();
  for (const double left : choices[0])
    for (const double right : choices[1])
      for (const double track : choices[2]) {
        const RoundingError error = error_of({left, right, track}, exact);
        if (!(cost(error) < least)) continue;
        least = cost(error);
        best = {wanted, error};
        best.values[name_of(BaseQuantity::left_wheel_diameter)] = left;
        best.values[name_of(BaseQuantity::right_wheel_diameter)] = right;
        best.values[name_of(BaseQuantity::track_width)] = track;
      }
  return best;
}

}  // namespace odomcalib
