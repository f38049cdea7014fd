#include "calib/terms/periodic_smooths.hpp"

#include <algorithm>
#include <cmath>

namespace odomcalib::calib::terms {
namespace {

constexpr double kShortest = 0.2;    ///< m
constexpr double kLongest = 1.25;    ///< m; what changes slower is left to the polynomials
constexpr double kStep = 0.7;        ///< cycles over the place's extent
constexpr double kSmallest = 0.5;    ///< m, least extent taken for separating waves
constexpr double kMostWaves = 1500;  ///< the shortest are left out where there would be more

struct Extent {
  double low = 1e300, high = -1e300;
  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Between neighbouring waves, cycles per m.
  [[nodiscard]] double step() const { return kStep / std::max(high - low, kSmallest); }
};

/// The highest frequency whose half disc holds no more than kMostWaves.
double highest_frequency(double x_step, double y_step) {
  return std::min(1.0 / kShortest, std::sqrt(2.0 * kMostWaves * x_step * y_step / math::kPi));
}

}  // namespace

std::vector<SmoothTerm> periodic_smooths(std::span<const vehicle::DriveModel* const> models) {
  std::vector<SmoothTerm> waves;
  if (models.size() != 1) return waves;
  Extent x, y;
  for (const vehicle::StepContext& c : models.front()->context()) {
    x.take(c.x);
    y.take(c.y);
  }
  if (!(x.high > x.low) && !(y.high > y.low)) return waves;
  const double highest = highest_frequency(x.step(), y.step());
  const SmoothTerm floor{{vehicle::Covariate::position, vehicle::Channel::both_travel},
                         std::min(x.low, y.low),
                         std::max(x.high, y.high)};
  for (double a = 0.0; a <= highest; a += x.step())
    for (double b = a > 0.0 ? -std::floor(highest / y.step()) * y.step() : y.step(); b <= highest;
         b += y.step()) {
      const double frequency = std::hypot(a, b);
      if (frequency < 1.0 / kLongest || frequency > highest) continue;
      waves.push_back(on_basis(floor, Wave{a, b}));
    }
  return waves;
}

}  // namespace odomcalib::calib::terms
