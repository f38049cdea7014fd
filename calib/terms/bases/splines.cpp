#include "calib/terms/bases/splines.hpp"

#include "calib/terms/bases/speed_hats.hpp"

namespace odomcalib::calib::terms {
namespace {

static_assert(kMostKnots + 3 == kMostFunctions);

/// Cubic B-spline with unit knots about zero (Schoenberg, Quart. Appl. Math. 4, 1946).
double cubic_bump(double x) {
  const double a = std::abs(x);
  if (a >= 2.0) return 0.0;
  const double tail = 2.0 - a, core = 1.0 - a;
  return (tail * tail * tail - (a < 1.0 ? 4.0 * core * core * core : 0.0)) / 6.0;
}

/// Four of the splines about knots 1 to one past the last differ from zero.
BasisValues cubic_splines(int knots, double place) {
  BasisValues functions(static_cast<std::size_t>(knots) + 1);
  const int before = static_cast<int>(place) - 1;
  for (int k = std::max(before, 1); k <= std::min(before + 3, knots + 1); ++k)
    functions[static_cast<std::size_t>(k) - 1] = cubic_bump(place - k);
  functions[0] -= cubic_bump(1.0);  // zero at rest
  return functions;
}

}  // namespace

BasisValues Splines::values(const Argument& at) const {
  BasisValues functions = cubic_splines(knots, knots * std::abs(at.relative()));
  add_direction(at, functions);
  return functions;
}

std::vector<std::vector<double>> Splines::penalty(double strength, double typical_size,
                                                  std::size_t count) const {
  std::vector<std::vector<double>> differences;
  for (std::size_t k = 0; k < roughness.size(); ++k) {
    const double weight = 1.0 / (roughness[k] * strength * typical_size);
    differences.emplace_back(count, 0.0);
    differences.back()[k] = differences.back()[k + 2] = weight;
    differences.back()[k + 1] = -2.0 * weight;
  }
  return differences;
}

}  // namespace odomcalib::calib::terms
