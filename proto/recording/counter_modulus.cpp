#include "proto/recording/counter_modulus.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace odomcalib {
namespace {

// Share of the span of the counts: a larger step from one sample to the next is a wrap, or a reset. Derived:
// half of what a counter can hold.
constexpr double kWrap = 0.5;
// Wraps that show at which number. Chosen: a single one may be a reset.
constexpr std::size_t kFewestWraps = 3;
// Share of the number by which a wrap may miss it, of one sample's motion. Chosen.
constexpr double kMiss = 0.1;
// Counts by which the mean of all wraps may lie above a usual number and below it, besides three standard
// errors: a step that holds a wrap is longer than those beside it, by a count where wheels are slow.
constexpr double kAbove = 0.5, kBelow = 1.5, kMeanErrors = 3.0;
// Counts of any other number: below it, an error of one count matters (0.02 %).
constexpr double kLeastUnusual = 5000.0;
// Counts of usual encoders and controllers: bits, lines, degrees, decimal digits.
constexpr std::array<std::int64_t, 21> kUsual = {200,  256,  360,   400,   512,   720,   1000,
                                                 1024, 2000, 2048,  3600,  4000,  4096,  8000,
                                                 8192, 9000, 10000, 16384, 32768, 36000, 100000};

struct Wraps {
  std::vector<double> moduli;    ///< what each wrap says
  double low = 0.0, high = 0.0;  ///< of all counts
};

/// Exact for counts below 2^53, which is all that a recording has.
double step(const std::vector<TickSample>& ticks, std::size_t k, std::int64_t TickSample::*side) {
  return static_cast<double>(ticks[k].*side) - static_cast<double>(ticks[k - 1].*side);
}

void collect(const std::vector<TickSample>& ticks, std::int64_t TickSample::*side, Wraps& wraps) {
  const double limit = kWrap * (wraps.high - wraps.low);
  for (std::size_t k = 2; k + 1 < ticks.size(); ++k) {
    const double jump = step(ticks, k, side);
    if (std::abs(jump) <= limit) continue;
    const double before = step(ticks, k - 1, side), after = step(ticks, k + 1, side);
    if (std::abs(before) > limit || std::abs(after) > limit) continue;
    // Where a count that grows wraps, the jump is the motion less the number.
    wraps.moduli.push_back(std::abs(0.5 * (before + after) - jump));
  }
}

Wraps wraps_of(const std::vector<TickSample>& ticks) {
  Wraps wraps;
  wraps.low = wraps.high = static_cast<double>(ticks.front().left);
  for (const TickSample& tick : ticks) {
    wraps.low = std::min({wraps.low, static_cast<double>(tick.left), static_cast<double>(tick.right)});
    wraps.high = std::max({wraps.high, static_cast<double>(tick.left), static_cast<double>(tick.right)});
  }
  collect(ticks, &TickSample::left, wraps);
  collect(ticks, &TickSample::right, wraps);
  return wraps;
}

struct Mean {
  double value = 0.0, error = 0.0;  ///< counts
};

Mean mean_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  const double mean = sum / n;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, std::sqrt(squares / (n - 1.0) / n)};
}

bool holds(const Wraps& wraps, double modulus) {
  const double low = wraps.low >= 0.0 ? 0.0 : -0.5 * modulus;
  return wraps.low >= low && wraps.high < low + modulus;
}

}  // namespace

std::optional<std::int64_t> counter_modulus(const std::vector<TickSample>& ticks) {
  if (ticks.size() < 4) return std::nullopt;
  const Wraps wraps = wraps_of(ticks);
  if (wraps.moduli.size() < kFewestWraps) return std::nullopt;
  const Mean mean = mean_of(wraps.moduli);
  if (std::any_of(wraps.moduli.begin(), wraps.moduli.end(),
                  [&](double one) { return std::abs(one - mean.value) > kMiss * mean.value; }))
    return std::nullopt;
  const double spread = kMeanErrors * mean.error;
  const auto is_near = [&](double number) {
    return mean.value - number <= kAbove + spread && number - mean.value <= kBelow + spread &&
           holds(wraps, number);
  };
  for (const std::int64_t usual : kUsual)
    if (is_near(static_cast<double>(usual))) return usual;
  const double nearest = std::max(std::round(mean.value), wraps.low >= 0.0 ? wraps.high + 1.0 : 0.0);
  if (nearest < kLeastUnusual || !is_near(nearest) || spread > kAbove) return std::nullopt;
  return std::llround(nearest);
}

}  // namespace odomcalib
