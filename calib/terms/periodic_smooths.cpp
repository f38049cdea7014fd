#include "calib/terms/periodic_smooths.hpp"

#include <algorithm>
#include <cmath>

#include "calib/terms/settings.hpp"

namespace odomcalib::calib::terms {
namespace {

struct Extent {
  double low = 1e300, high = -1e300;
  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Between neighbouring waves, cycles per m.
  [[nodiscard]] double step() const {
    return settings::kWaveStep / std::max(high - low, settings::kSmallestPlace_m);
  }
};

/// The highest frequency whose half disc holds no more than settings::kMostWaves.
double highest_frequency(double x_step, double y_step) {
  return std::min(1.0 / settings::kShortestWave_m,
                  std::sqrt(2.0 * settings::kMostWaves * x_step * y_step / math::kPi));
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
      if (frequency < 1.0 / settings::kLongestWave_m || frequency > highest) continue;
      waves.push_back(on_basis(floor, Wave{a, b}));
    }
  return waves;
}

}  // namespace odomcalib::calib::terms
