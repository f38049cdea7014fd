#include "tests/blind/blind_trial.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <numbers>
#include <utility>

#include "calib/math/bootstrap.hpp"
#include "calib/odometry/predict.hpp"
#include "calib/solve.hpp"

namespace odomcalib::blind {
namespace {

constexpr double kHorizon = 10.0;  // s
constexpr double kStride = 2.5;    // s between the beginnings of windows

struct Relative {
  double x = 0.0, y = 0.0, yaw = 0.0;
};

template <typename A>
Relative relative(const A& from, const A& to) {
  const double dx = to.x - from.x, dy = to.y - from.y, c = std::cos(from.yaw), s = std::sin(from.yaw);
  return {c * dx + s * dy, c * dy - s * dx, std::remainder(to.yaw - from.yaw, 2.0 * std::numbers::pi)};
}

/// The true pose at a time between two samples of the path.
sim::Pose true_pose(const std::vector<sim::TruthSample>& path, double t) {
  const auto after = std::lower_bound(path.begin(), path.end(), t,
                                      [](const sim::TruthSample& s, double time) { return s.t < time; });
  if (after == path.end()) return path.back().pose;
  if (after == path.begin()) return path.front().pose;
  const auto before = after - 1;
  const double share = (t - before->t) / (after->t - before->t);
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  const double turn = std::remainder(after->pose.yaw - before->pose.yaw, 2.0 * std::numbers::pi);
  return {mix(before->pose.x, after->pose.x), mix(before->pose.y, after->pose.y),
          before->pose.yaw + share * turn};
}

/// Mean of stamp minus true time, s.
template <typename Sample>
double mean_lateness(const std::vector<Sample>& samples, const std::vector<double>& times) {
  double sum = 0.0;
  for (std::size_t k = 0; k < samples.size(); ++k) sum += samples[k].t - times[k];
  return sum / std::max(1.0, static_cast<double>(samples.size()));
}

/// Time to add to the encoders' stamps to get the world's time, s. No data show which of two clocks is late,
/// so the reported delay is freed from what the scans of the solved recording were late.
double stamp_correction(const Calibration& calibration, const sim::SimulatedRun& solved) {
  for (const EffectResult& effect : calibration.effects)
    if (effect.name == "time_offset")
      return effect.parameters.front().second.value -
             mean_lateness(solved.recording.scans, solved.scan_times);
  return 0.0;
}

/// Sums over the windows that begin in the same span, by number of the span: neighbouring windows share a
/// part of the drive.
struct WindowErrors {
  std::map<std::size_t, calib::math::RatioOfSums> position, heading;

  void add(double t, const Relative& odometry, const Relative& truth) {
    const auto span = static_cast<std::size_t>(std::max(0.0, t) / (2.0 * kHorizon));
    const double turn = std::remainder(odometry.yaw - truth.yaw, 2.0 * std::numbers::pi);
    position[span] += {std::pow(odometry.x - truth.x, 2) + std::pow(odometry.y - truth.y, 2), 1.0};
    heading[span] += {turn * turn, 1.0};
  }
};

BoundedError rms_of(const std::map<std::size_t, calib::math::RatioOfSums>& by_span) {
  constexpr unsigned kSeed = 1;
  return {calib::math::total_of(by_span).root(),
          by_span.empty() ? 0.0 : calib::math::bootstrap_root(by_span, kSeed).upper};
}

/// A single stamp that is later or earlier than all others is no error of odometry; that all are late is.
/// @param correction to be added to the encoders' stamps, s
DriveError error_on(const sim::SimulatedRun& run, const Calibration& calibration, double correction = 0.0) {
  const std::vector<PoseSample> predicted = calib::odometry::predict(run.recording, calibration);
  const double late = mean_lateness(run.recording.ticks, run.tick_times) + correction;
  const auto truth_at = [&](std::size_t k) { return true_pose(run.path, run.tick_times[k] + late); };
  WindowErrors errors;
  std::size_t end = 0;
  double next = 0.0;
  for (std::size_t begin = 0; begin < predicted.size(); ++begin) {
    if (predicted[begin].t < next) continue;
    next = predicted[begin].t + kStride;
    while (end < predicted.size() && predicted[end].t < predicted[begin].t + kHorizon) ++end;
    if (end == predicted.size()) break;
    errors.add(predicted[begin].t, relative(predicted[begin], predicted[end]),
               relative(truth_at(begin), truth_at(end)));
  }
  return {rms_of(errors.position), rms_of(errors.heading)};
}

std::array<double, 3> sigmas_of(const Calibration& calibration, const sim::Geometry& truth) {
  const std::array<double, 3> values = {truth.left_diameter, truth.right_diameter, truth.track_width};
  std::array<double, 3> sigmas{};
  for (std::size_t k = 0; k < values.size() && k < calibration.parameters.size(); ++k) {
    const Quantity& q = calibration.parameters[k].second;
    sigmas[k] = (q.value - values[k]) / q.std;
  }
  return sigmas;
}

Calibration solve_plain(const Recording& recording) {
  calib::SolveOptions options;
  options.effects = {"none"};
  return calib::solve({&recording, 1}, options);
}

void copy_findings(const Calibration& calibration, Trial& trial) {
  trial.refused = calibration.verdict == Verdict::refused;
  for (const EffectResult& effect : calibration.effects) {
    trial.named.push_back(effect.name);
    trial.aliases.insert(trial.aliases.end(), effect.aliases.begin(), effect.aliases.end());
  }
  if (calibration.unexplained) trial.depends_on = calibration.unexplained->depends_on;
}

void copy_residual(const Calibration& plain, Trial& trial) {
  if (!plain.residual.after || !plain.residual.noise_floor) return;
  for (std::size_t k = 0; k < 3; ++k)
    trial.residual_over_floor[k] = (*plain.residual.after)[k] / (*plain.residual.noise_floor)[k];
}

}  // namespace

Examination make_examination(std::uint64_t campaign, unsigned number, const sim::BlindOptions& options,
                             Judged judged) {
  Examination made{sim::make_blind_case(campaign, number, options), judged};
  if (judged == Judged::by_its_findings) return made;
  made.proof = sim::make_blind_proof(campaign, number, options);
  made.plain = solve_plain(made.drawn.run.recording);
  made.before = error_on(made.proof.fresh, made.plain);
  made.twin = error_on(made.proof.fresh_twin, solve_plain(made.proof.twin.recording));
  return made;
}

Solution solution_of(const Examination& examination, const calib::selection::RuleSet& rules) {
  calib::SolveOptions options;
  options.rules = rules;
  const std::clock_t start = std::clock();
  Calibration found = calib::solve({&examination.drawn.run.recording, 1}, options);
  return {std::move(found), static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC};
}

Trial judge(const Examination& examination, const Solution& solution) {
  const sim::BlindCase& drawn = examination.drawn;
  const Calibration& found = solution.calibration;
  Trial trial;
  trial.answer = drawn.answer;
  trial.solve_seconds = solution.seconds;
  copy_findings(found, trial);
  trial.sigmas = sigmas_of(found, drawn.answer.truth);
  trial.judged = examination.judged;
  if (trial.judged == Judged::by_its_findings) return trial;
  copy_residual(examination.plain, trial);
  trial.plain_sigmas = sigmas_of(examination.plain, drawn.answer.truth);
  trial.before = examination.before;
  trial.after = error_on(examination.proof.fresh, found, stamp_correction(found, drawn.run));
  trial.twin = examination.twin;
  return trial;
}

Trial run_trial(std::uint64_t campaign, unsigned number, const sim::BlindOptions& options, Judged judged,
                const calib::selection::RuleSet& rules) {
  const Examination examination = make_examination(campaign, number, options, judged);
  return judge(examination, solution_of(examination, rules));
}

}  // namespace odomcalib::blind
