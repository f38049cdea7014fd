#include "proto/recording/second_writer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace odomcalib {
namespace {

// Runs of the value with others on both sides, far from them. Chosen: a value that was read wrong does not
// come that often.
constexpr std::size_t kFewestRuns = 5;
// Samples of it in a row. Chosen: a robot that stops, and whose speeds are told, stops for longer.
constexpr std::size_t kLongestRun = 4;
// Share of the samples. Chosen: below it single samples are mended or left out one by one.
constexpr double kLeastShare = 0.01;
// Times the usual step from one sample to the next, of a value that is no motion. Chosen.
constexpr double kFar = 5.0;
// Share of the steps without the value that are no longer than the usual one.
constexpr double kUsualStep = 0.95;
// Share of its runs that lie between others and far from them. Chosen: the robot may pass through the value.
constexpr double kFarRuns = 0.5;

double distance(const Values& a, const Values& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

Values most_frequent(std::span<const Values> samples, std::size_t& count) {
  std::map<Values, std::size_t> counts;
  for (const Values& sample : samples) ++counts[sample];
  const auto most = std::max_element(counts.begin(), counts.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  count = most->second;
  return most->first;
}

double usual_step(const std::vector<Values>& rest) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < rest.size(); ++k) steps.push_back(distance(rest[k - 1], rest[k]));
  const auto place =
      steps.begin() + static_cast<std::ptrdiff_t>(kUsualStep * static_cast<double>(steps.size() - 1));
  std::nth_element(steps.begin(), place, steps.end());
  return *place;
}

struct Run {
  std::size_t begin = 0, end = 0;
  bool is_far = false;      ///< from a neighbour: no motion
  bool is_between = false;  ///< others that lie near each other
};

std::vector<Run> runs_of(std::span<const Values> samples, const Values& value, double far) {
  std::vector<Run> runs;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (samples[k] != value) continue;
    Run run{k, k};
    while (run.end < samples.size() && samples[run.end] == value) ++run.end;
    const Values* before = k > 0 ? &samples[k - 1] : nullptr;
    const Values* after = run.end < samples.size() ? &samples[run.end] : nullptr;
    run.is_far = (before != nullptr && distance(*before, value) > far) ||
                 (after != nullptr && distance(*after, value) > far);
    run.is_between = before != nullptr && after != nullptr && distance(*before, *after) <= far;
    runs.push_back(run);
    k = run.end;
  }
  return runs;
}

bool is_written_between(const Run& run) {
  return run.is_far && run.is_between && run.end - run.begin <= kLongestRun;
}

}  // namespace

std::vector<std::size_t> of_second_writer(std::span<const Values> samples) {
  if (samples.size() < 2 * kFewestRuns) return {};
  std::size_t count = 0;
  const Values value = most_frequent(samples, count);
  if (static_cast<double>(count) < kLeastShare * static_cast<double>(samples.size())) return {};
  std::vector<Values> rest;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(rest),
               [&](const Values& v) { return v != value; });
  if (rest.size() < 2 * kFewestRuns) return {};
  const std::vector<Run> runs = runs_of(samples, value, kFar * usual_step(rest));
  const auto written = static_cast<std::size_t>(std::count_if(runs.begin(), runs.end(), is_written_between));
  if (written < kFewestRuns || static_cast<double>(written) < kFarRuns * static_cast<double>(runs.size()))
    return {};
  std::vector<std::size_t> found;
  for (const Run& run : runs)
    // Where the recording begins or ends, the robot may well stand at the value.
    if (run.is_far || (run.begin > 0 && run.end < samples.size()))
      for (std::size_t k = run.begin; k < run.end; ++k) found.push_back(k);
  return found;
}

}  // namespace odomcalib
