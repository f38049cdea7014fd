// How long calibration takes, beside the bounds it must keep: a five-minute recording solves in at most ten
// seconds on one core, and a pair of scans matches well within one sweep of the lidar.
#include <benchmark/benchmark.h>

#include "calib/match.hpp"
#include "calib/solve.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib {
namespace {

constexpr double kSolveBound = 10.0;  // s
constexpr double kMatchBound = 0.1;   // s, one turn of a 10 Hz lidar

const Recording& five_minutes() {
  static const Recording kRecording = sim::standard_run(1).recording;
  return kRecording;
}

void solve_five_minutes(benchmark::State& state, const std::string& effects) {
  const Recording& recording = five_minutes();
  calib::SolveOptions options;
  options.effects = {effects};
  for (auto _ : state) benchmark::DoNotOptimize(calib::solve({&recording, 1}, options));
  state.counters["bound_s"] = kSolveBound;
  state.counters["recorded_s"] = recording.ticks.back().t - recording.ticks.front().t;
}
BENCHMARK_CAPTURE(solve_five_minutes, none, std::string("none"))->Unit(benchmark::kSecond)->Iterations(3);
BENCHMARK_CAPTURE(solve_five_minutes, auto, std::string("auto")) -> Unit(benchmark::kSecond) -> Iterations(3);

void match_neighbouring_scans(benchmark::State& state) {
  const Recording& recording = five_minutes();
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        calib::match_scans(recording.scans[k], recording.scans[k + 3], {0, 0, 0}, 0.008));
    k = (k + 7) % (recording.scans.size() - 3);
  }
  state.counters["bound_s"] = kMatchBound;
}
BENCHMARK(match_neighbouring_scans)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace odomcalib
