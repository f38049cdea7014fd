#include "proto/recording/wheel_joining.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace odomcalib {
namespace {

// Times the usual interval of a wheel, within which its value is known. Chosen: one message that got lost is
// bridged; where more are missing the wheel may have done anything.
constexpr double kKnownFor = 2.5;
constexpr double kOneTurn = 2.0 * std::numbers::pi;

double usual_interval(const std::vector<SideSample>& samples) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < samples.size(); ++k) intervals.push_back(samples[k].t - samples[k - 1].t);
  if (intervals.empty()) return 0.0;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

bool within_one_turn(const std::vector<SideSample>& samples) {
  constexpr double kRounding = 1e-5;  // rad, of single precision
  const auto [low, high] = std::minmax_element(
      samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return high->value - low->value <= kOneTurn + kRounding;
}

/// Between the last angle of a turn and the first of the next lies no way back.
void continue_turns(std::vector<SideSample>& samples) {
  if (samples.empty() || !within_one_turn(samples)) return;
  for (std::size_t k = 1; k < samples.size(); ++k)
    samples[k].value =
        samples[k - 1].value + std::remainder(samples[k].value - samples[k - 1].value, kOneTurn);
}

std::optional<double> value_at(const std::vector<SideSample>& samples, double t, double known_for,
                               Between between) {
  const auto after = std::lower_bound(samples.begin(), samples.end(), t,
                                      [](const SideSample& sample, double time) { return sample.t < time; });
  if (after != samples.end() && after->t == t) return after->value;
  if (after == samples.begin()) return std::nullopt;
  const SideSample& before = *std::prev(after);
  if (between == Between::held) return t - before.t <= known_for ? std::optional(before.value) : std::nullopt;
  if (after == samples.end() || after->t - before.t > known_for) return std::nullopt;
  return before.value + (after->value - before.value) * (t - before.t) / (after->t - before.t);
}

}  // namespace

JoinedWheels joined_wheels(std::vector<SideSample> left, std::vector<SideSample> right, Between between) {
  JoinedWheels out;
  if (between == Between::linear) {
    continue_turns(left);
    continue_turns(right);
  }
  out.kept = right.size() < left.size() ? Side::right : Side::left;
  const auto& kept = out.kept == Side::left ? left : right;
  const auto& other = out.kept == Side::left ? right : left;
  const double known_for = kKnownFor * usual_interval(other);
  for (const SideSample& sample : kept) {
    const auto value = value_at(other, sample.t, known_for, between);
    if (!value)
      ++out.alone;
    else if (out.kept == Side::left)
      out.wheels.push_back({sample.t, sample.value, *value});
    else
      out.wheels.push_back({sample.t, *value, sample.value});
  }
  return out;
}

}  // namespace odomcalib
