// How long an update of the library takes: with no effect, with each, and with all of them at once; beside
// the formula of ros2_control's diff_drive_controller. Covariances are part of an update.
#include <benchmark/benchmark.h>
#include <odomcalib/odometry.hpp>

#include <cmath>
#include <string>
#include <utility>

#include "calib/odometry/correction.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/effects/reference_effect.hpp"
#include "proto/calibration/calibration.hpp"
#include "tests/unit/calib/some_drive.hpp"

namespace odomcalib {
namespace {

Calibration accepted() {
  Calibration calibration = calib::odometry::nominal_calibration(test_support::kRobot);
  calibration.verdict = Verdict::accepted;
  for (std::size_t k = 0; k < 3; ++k) {
    calibration.covariance_order.push_back(calibration.parameters[k].first);
    calibration.covariance.push_back({0.0, 0.0, 0.0});
    calibration.covariance[k][k] = 1e-8;
  }
  return calibration;
}

void add(const calib::vehicle::Effect& effect, Calibration& calibration) {
  EffectResult result;
  result.name = effect.name();
  for (const calib::vehicle::EffectParameter& p : effect.parameters())
    result.parameters.push_back(
        {p.name, {p.start + (p.fixed ? 0.0 : p.scale), p.fixed ? -1.0 : 1e-4, p.unit}});
  calibration.effects.push_back(result);
}

/// A drive again and again, its stamps and counts going on.
void update(benchmark::State& state, const Calibration& calibration) {
  const Recording drive = test_support::some_drive();
  auto opened = Odometry::from_text(to_json(calibration));
  Odometry odometry = std::move(*opened);
  double begin = 0.0;
  std::size_t k = 0;
  for (auto _ : state) {
    const TickSample& sample = drive.ticks[k];
    benchmark::DoNotOptimize(odometry.update_counts(begin + sample.t, sample.left, sample.right));
    if (++k < drive.ticks.size()) continue;
    k = 0;
    begin += 100.0;
    odometry.restart();
  }
}

/// Two wheel positions to a pose, by the exact arc (ros2_controllers, diff_drive_controller/src/odometry.cpp,
/// update() and integrateExact()).
void diff_drive_controller(benchmark::State& state) {
  const Recording drive = test_support::some_drive();
  constexpr double kRadius = 0.075, kSeparation = 0.4;
  const double per_count = 2.0 * M_PI / test_support::kRobot.ticks_per_rev;
  double x = 0.0, y = 0.0, heading = 0.0, left_before = 0.0, right_before = 0.0;
  std::size_t k = 0;
  for (auto _ : state) {
    const double left = kRadius * per_count * static_cast<double>(drive.ticks[k].left),
                 right = kRadius * per_count * static_cast<double>(drive.ticks[k].right);
    const double linear = 0.5 * (left - left_before + right - right_before),
                 angular = (right - right_before - left + left_before) / kSeparation;
    left_before = left;
    right_before = right;
    if (std::abs(angular) < 1e-6) {
      x += linear * std::cos(heading + 0.5 * angular);
      y += linear * std::sin(heading + 0.5 * angular);
      heading += angular;
    } else {
      const double before = heading, radius = linear / angular;
      heading += angular;
      x += radius * (std::sin(heading) - std::sin(before));
      y += -radius * (std::cos(heading) - std::cos(before));
    }
    benchmark::DoNotOptimize(x + y + heading);
    k = (k + 1) % drive.ticks.size();
  }
}
BENCHMARK(diff_drive_controller);

/// Those that move the base, each under its name.
const int kRegistered = [] {
  Calibration all = accepted();
  benchmark::RegisterBenchmark("update/no_effect", update, accepted());
  for (const auto& effect : calib::terms::effect_catalogue()) {
    Calibration one = accepted();
    add(*effect, one);
    if (calib::odometry::correction_of(one, false).effects.empty()) continue;
    add(*effect, all);
    benchmark::RegisterBenchmark(("update/" + effect->name()).c_str(), update, one);
  }
  benchmark::RegisterBenchmark("update/all_effects", update, all);
  return 0;
}();

}  // namespace
}  // namespace odomcalib
