#include "calib/solve.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "calib/classical/sign_check.hpp"
#include "calib/estimation/first_look.hpp"
#include "calib/estimation/path_fit.hpp"
#include "calib/estimation/start_values.hpp"
#include "calib/ingest/phantom_return.hpp"
#include "calib/ingest/sweeps.hpp"
#include "calib/ingest/tick_stamps.hpp"
#include "calib/measurement/location.hpp"
#include "calib/measurement/placed_pairs.hpp"
#include "calib/measurement/placed_poses.hpp"
#include "calib/measurement/scan_stamps.hpp"
#include "calib/report/explain.hpp"
#include "calib/report/findings.hpp"
#include "calib/report/one_robot.hpp"
#include "calib/report/report.hpp"
#include "calib/selection/criterion.hpp"
#include "calib/selection/held_out.hpp"
#include "calib/selection/lidar_evidence.hpp"
#include "calib/selection/range_trace.hpp"
#include "calib/selection/search.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/effect_names.hpp"

namespace odomcalib::calib {
namespace {

using vehicle::ClockPart;

selection::Estimate estimate_of(const estimation::FitResult& fit, Eigen::Index parameter) {
  return {fit.parameters(parameter), fit.covariance(parameter, parameter)};
}

selection::Seat seat_of(const estimation::FitResult& fit) {
  return {estimate_of(fit, vehicle::kMountX), estimate_of(fit, vehicle::kMountY),
          estimate_of(fit, vehicle::kMountYaw)};
}

/// Where no scan matched, the fit has nothing to say but that.
Error cause_of(const Error& error, std::span<const measurement::PairSet> sets) {
  std::size_t unmatched = 0;
  for (const measurement::PairSet& set : sets) unmatched += set.unmatched;
  if (error.code != ErrorCode::empty || unmatched == 0) return error;
  return {ErrorCode::refused, "none of " + std::to_string(unmatched) + " pairs of scans could be matched",
          "scan matching", "drive where the lidar sees walls on all sides, not along a corridor"};
}

bool acts_in_places(const vehicle::Effect& effect) {
  const auto laws = effect.laws();
  return std::any_of(laws.begin(), laws.end(), [](const vehicle::Law& law) {
    return law.variable == vehicle::Variable::heading || law.variable == vehicle::Variable::position;
  });
}

class Solver {
 public:
  Solver(std::span<const Recording> recordings, const SolveOptions& options, Progress progress)
      : recordings_(recordings), options_(options), progress_(std::move(progress)) {}

  /// Whether a refusal has its cause, so that no other needs to be looked for.
  [[nodiscard]] bool cause_is_known() const { return cause_is_known_; }

  Calibration run() {
    if (!recordings_.empty()) calibration_.robot = recordings_.front().robot;
    drop_phantom_returns();
    even_out_ticks();
    cause_is_known_ = true;
    if (auto error = open(recordings_)) return refuse(*error);
    if (!options_.same_robot)
      if (auto error = report::different_robots(recordings_)) return refuse(*error);
    if (auto error = undirected_counts()) return refuse(*error);
    if (auto error = choose_effects()) return refuse(*error);
    cause_is_known_ = false;
    if (auto error = start()) return refuse(*error);
    auto fit = settle();
    if (fit) fit = seat_reference(std::move(fit));
    if (fit) fit = even_out_scans(std::move(fit));
    if (fit) fit = let_scans_sweep(std::move(fit));
    if (fit) fit = correct_lidar(std::move(fit));
    if (fit) fit = locate(std::move(fit));
    calibration_.data = data_in_use();
    calibration_.methods = report::classical_methods(*session_, delay(), calibration_);
    if (!fit) {
      MethodResult joint;
      joint.name = "joint";
      joint.refused = fit.error().what;
      calibration_.methods.push_back(joint);
      return refuse(cause_of(fit.error(), session_->pair_sets()));
    }
    if (automatic_ && recordings_.front().increments.empty())
      search(fit.value());
    else
      outcome_.model = {effects_, fit.value()};
    fit_whole_path();
    fill();
    return calibration_;
  }

 private:
  void report(const std::string& phase, double fraction) const {
    if (progress_) progress_(phase, fraction);
  }

  Calibration refuse(const Error& error) {
    calibration_.verdict = Verdict::refused;
    calibration_.reasons = {error.text()};
    calibration_.data = data_in_use();
    return calibration_;
  }

  /// A recording that cannot be used is told apart by its name and what it holds.
  [[nodiscard]] std::vector<DataUse> data_in_use() const {
    if (!session_) return report::data_use(recordings_, {});
    return report::data_use(recordings_, session_->pair_sets());
  }

  std::optional<Error> open(std::span<const Recording> recordings) {
    auto session = measurement::Session::open(recordings);
    if (!session) return session.error();
    const bool sits_anywhere = session_ && session_->reference_sits_anywhere();
    session_ = std::make_unique<measurement::Session>(std::move(session).value());
    session_->let_reference_sit_anywhere(sits_anywhere);
    return std::nullopt;
  }

  /// A copy of the recordings, made once, that stamps may be changed in.
  Recording& own(std::size_t recording) {
    if (evened_.empty()) evened_.assign(recordings_.begin(), recordings_.end());
    return evened_[recording];
  }

  /// Numbers that stand for no return are no walls.
  void drop_phantom_returns() {
    const auto given = recordings_;
    for (std::size_t i = 0; i < given.size(); ++i)
      if (const auto value = ingest::phantom_return(given[i])) {
        ingest::remove_readings(own(i), *value);
        remarks_.push_back(ingest::phantom_remark(*value));
      }
    if (!evened_.empty()) recordings_ = evened_;
  }

  /// Asked before scans are matched from where the counts say they are.
  [[nodiscard]] std::optional<Error> undirected_counts() const {
    for (const Recording& recording : recordings_)
      if (auto error = estimation::counts_without_direction(recording)) return error;
    return std::nullopt;
  }

  void even_out_ticks() {
    const auto given = recordings_;
    for (std::size_t i = 0; i < given.size(); ++i)
      if (const auto even = ingest::even_ticks(given[i])) {
        ingest::set_stamps(own(i).ticks, even->t);
        stamps_.ticks = std::max(stamps_.ticks, even->jitter);
      }
    if (!evened_.empty()) recordings_ = evened_;
  }

  /// Scans that were taken evenly and stamped unevenly are measured anew, at even times.
  Result<estimation::FitResult> even_out_scans(Result<estimation::FitResult> fit) {
    if (!session_->reference_is_scans()) return fit;
    const auto given = recordings_;
    for (std::size_t i = 0; i < given.size(); ++i) {
      const auto even = even_scans(given[i], session_->data()[i], effects_, parameters_);
      if (!even) continue;
      ingest::set_stamps(own(i).scans, even->t);
      stamps_.scans = std::max(stamps_.scans, even->jitter);
    }
    if (stamps_.scans == 0.0) return fit;
    recordings_ = evened_;
    return measure_anew(recordings_);
  }

  /// Scans that do not say when each beam was sent are taken for sweeps of a turning head if that explains
  /// the motion clearly better.
  Result<estimation::FitResult> let_scans_sweep(Result<estimation::FitResult> fit) {
    auto sweeping = ingest::with_sweeps(recordings_);
    if (sweeping.empty() || !session_->reference_is_scans()) return fit;
    const State before = state(fit.value(), lidar_.size());
    auto session = std::move(session_);
    auto better = begin_anew(sweeping);
    if (better && has(ClockPart::offset)) {
      ingest::take_stamps_for_middles(sweeping);
      better = measure_anew(sweeping);
    }
    const auto after = better ? held_out_now(better.value()) : std::nullopt;
    if (better && selection::is_clearly_better(before.held_out, after)) {
      evened_ = std::move(sweeping);
      recordings_ = evened_;
      stamps_.sweep = *evened_.front().scans.front().time_increment;
      stamps_.turn = ingest::turn_of_head(evened_.front());
      stamps_.sweep_p_value = selection::p_value_of(*before.held_out, *after);
      return better;
    }
    go_back_to(before);
    session_ = std::move(session);
    return fit;
  }

  /// From nominal values: what was fitted to scans taken otherwise is no start.
  Result<estimation::FitResult> begin_anew(std::span<const Recording> recordings) {
    if (auto error = open(recordings)) return *error;
    effects_ = given_;
    if (auto error = start()) return *error;
    return settle();
  }

  std::optional<Error> open_and_measure(std::span<const Recording> recordings) {
    auto error = open(recordings);
    if (!error) measure();
    return error;
  }

  Result<estimation::FitResult> measure_anew(std::span<const Recording> recordings) {
    if (auto error = open_and_measure(recordings)) return *error;
    return settle();
  }

  std::optional<Error> choose_effects() {
    if (auto wrong = terms::wrong_effects(options_.effects)) return wrong;
    automatic_ = options_.effects == std::vector<std::string>{"auto"};
    if (automatic_ || options_.effects == std::vector<std::string>{"none"}) return std::nullopt;
    for (const std::string& name : options_.effects) {
      if (const auto of_lidar = terms::find_lidar_effect(name)) {
        asked_of_lidar_.push_back(of_lidar);
        continue;
      }
      const vehicle::EffectList found = terms::find_effects(name);
      effects_.insert(effects_.end(), found.begin(), found.end());
    }
    given_ = effects_;
    return std::nullopt;
  }

  /// Among the effects; as many as there are when it is none of them.
  [[nodiscard]] std::size_t place_of(ClockPart part) const {
    const auto place = std::find_if(effects_.begin(), effects_.end(),
                                    [&](const auto& e) { return e->clock_part() == part; });
    return static_cast<std::size_t>(place - effects_.begin());
  }

  [[nodiscard]] bool has(ClockPart part) const { return place_of(part) < effects_.size(); }

  [[nodiscard]] double delay() const {
    return has(ClockPart::offset) ? parameters_(first_of(ClockPart::offset)) : 0.0;
  }

  [[nodiscard]] Eigen::Index first_of(ClockPart part) const {
    return selection::first_parameter(effects_, place_of(part));
  }

  /// First matches with nominal values; then the clocks' delay, and what the recording does not state. Signs
  /// are asked before anything is fitted.
  std::optional<Error> start() {
    report("matching", 0.0);
    parameters_ = vehicle::to_vector(session_->nominal());
    session_->measure(parameters_, {}, measurement::PairOptions{.rough = true});
    if (automatic_ && recordings_.front().increments.empty())
      effects_.push_back(terms::clock_effect(ClockPart::offset));
    const estimation::ClockStart clock =
        has(ClockPart::offset) ? estimation::search_clock(session_->data()) : estimation::ClockStart{};
    if (auto error = check_signs(clock.delay)) return error;
    if (automatic_ && clock.rate != 0.0) effects_.push_back(terms::clock_effect(ClockPart::rate));
    parameters_ = vehicle::to_vector(estimation::start_values(*session_, clock.delay),
                                     vehicle::count_parameters(effects_));
    const std::vector<double> own = vehicle::start_of(effects_);
    parameters_.tail(static_cast<Eigen::Index>(own.size())) =
        Eigen::Map<const Eigen::VectorXd>(own.data(), static_cast<Eigen::Index>(own.size()));
    if (has(ClockPart::offset)) parameters_(first_of(ClockPart::offset)) = clock.delay;
    if (has(ClockPart::rate)) parameters_(first_of(ClockPart::rate)) = clock.rate;
    return std::nullopt;
  }

  /// Of each recording alone first: one with exchanged wires beside sound ones is outvoted.
  [[nodiscard]] std::optional<Error> check_signs(double delay) const {
    const std::span<const measurement::FitData> data(session_->data());
    const bool of_base = session_->reference_is_base();
    for (std::size_t i = 0; data.size() > 1 && i < data.size(); ++i)
      if (auto error = classical::check_signs(wheel_motions(data.subspan(i, 1), delay), calibration_.robot, of_base)) {
        error->where = recordings_[i].name;
        return error;
      }
    return classical::check_signs(wheel_motions(data, delay), calibration_.robot, of_base);
  }

  /// Fits, matches again with the fitted parameters (guess and de-skew), and fits again. Noise of a match
  /// made with wrong parameters must not reach the result; a clock far off takes a few more passes.
  Result<estimation::FitResult> settle() {
    constexpr int kPasses = 2, kMostPasses = 5;
    report("fitting", 0.0);
    auto fit = fit_now();
    for (int pass = 0; pass < kMostPasses && fit; ++pass) {
      const double delay_before = delay();
      parameters_ = fit.value().parameters;
      const bool clock_moves = std::abs(delay() - delay_before) > selection::settings::kNegligibleOffset_s;
      if (pass == 0 || clock_moves) drop_idle_clocks(fit.value());
      if (is_as_measured() || (pass >= kPasses && !clock_moves)) break;
      report("matching", std::min(0.33 * (pass + 1), 1.0));
      measure();
      report("fitting", std::min(0.5 * (pass + 1), 1.0));
      fit = fit_now();
    }
    if (fit) parameters_ = fit.value().parameters;
    return fit;
  }

  /// Poses of the base may be those of a marker beside the middle of the axle, which in turns looks like a
  /// base that moves sideways.
  Result<estimation::FitResult> seat_reference(Result<estimation::FitResult> fit) {
    if (!session_->reference_is_base()) return fit;
    const State before = state(fit.value(), lidar_.size());
    session_->let_reference_sit_anywhere(true);
    auto better = settle();
    if (better && selection::sits_elsewhere(seat_of(better.value()))) return better;
    session_->let_reference_sit_anywhere(false);
    go_back_to(before);
    return settle();
  }

  void measure() {
    session_->measure(parameters_, effects_, measurement::PairOptions{});
    measured_with_ = parameters_;
  }

  /// With parameters so near matches begin at the same guess and scans are de-skewed alike.
  [[nodiscard]] bool is_as_measured() const {
    constexpr double kNear = 1e-4;  // m, rad, s
    return parameters_.size() == measured_with_.size() &&
           (parameters_ - measured_with_).cwiseAbs().maxCoeff() < kNear;
  }

  Result<estimation::FitResult> fit_now() {
    estimation::FitOptions options;
    options.fixed = vehicle::fixed_with(session_->fixed(0), effects_);
    return fit_joint(session_->data(), effects_, parameters_, options);
  }

  /// Any parameter of the effect is many standard deviations from zero.
  [[nodiscard]] bool is_plain(ClockPart part, const estimation::FitResult& fit) const {
    const std::size_t count = effects_[place_of(part)]->parameters().size();
    const Eigen::Index first = first_of(part);
    for (Eigen::Index k = first; k < first + static_cast<Eigen::Index>(count); ++k)
      if (selection::is_plain(estimate_of(fit, k))) return true;
    return false;
  }

  [[nodiscard]] bool is_idle(ClockPart part, const estimation::FitResult& fit) const {
    const double negligible = part == ClockPart::offset ? selection::settings::kNegligibleOffset_s : 0.0;
    return selection::is_idle(estimate_of(fit, first_of(part)), negligible);
  }

  /// Clocks that run apart need a delay to run apart from.
  void drop_idle_clocks(const estimation::FitResult& fit) {
    if (!automatic_) return;
    if (has(ClockPart::rate) && is_idle(ClockPart::rate, fit)) drop_last();
    if (!has(ClockPart::rate) && has(ClockPart::offset) && is_idle(ClockPart::offset, fit)) drop_last();
  }

  void drop_last() {
    effects_.pop_back();
    parameters_ =
        parameters_.head(static_cast<Eigen::Index>(vehicle::kBaseCount + vehicle::count_parameters(effects_)))
            .eval();
  }

  [[nodiscard]] bool may_trace_lidar() const {
    return (automatic_ || !asked_of_lidar_.empty()) && session_->reference_is_scans();
  }

  [[nodiscard]] std::vector<measurement::HeadingPair> lidar_pairs() const {
    return selection::heading_pairs(*session_, parameters_, effects_);
  }

  /// Errors of the lidar show between scans, before any wheel is asked: those of the ranges in a map of
  /// walls, the others, and these too where there is no map, in pairs of scans. They are taken out of the
  /// scans.
  Result<estimation::FitResult> correct_lidar(Result<estimation::FitResult> fit) {
    if (!may_trace_lidar()) return fit;
    fit = take_out(wrong_angles(), std::move(fit), true);
    if (!fit) return fit;
    place_every_scan(asked_of_lidar_.empty());
    fit = take_out(selection::common_findings(paths_), std::move(fit), false);
    if (!fit) return fit;
    report("tracing the lidar", 0.0);
    const auto found =
        asked_of_lidar_.empty()
            ? selection::trace_lidar(lidar_pairs(), selection::sees_all_round(*session_), !paths_.empty())
            : selection::fit_lidar(lidar_pairs(), asked_of_lidar_);
    return take_out(found, std::move(fit), true);
  }

  /// Asked before the map: beams spread too wide bend its walls, as ranges that are too short would.
  [[nodiscard]] std::vector<terms::LidarFinding> wrong_angles() const {
    if (!asked_of_lidar_.empty()) return {};
    std::vector<terms::LidarFinding> found =
        selection::trace_lidar(lidar_pairs(), selection::sees_all_round(*session_), true);
    if (found.empty() || found.front().effect->name() != terms::make_angle_scale()->name()) return {};
    found.resize(1);
    return found;
  }

  /// Without the errors found everything is measured and fitted anew, and scans have to be placed again.
  /// @param refined by a second look, at pairs of the corrected scans
  Result<estimation::FitResult> take_out(const std::vector<terms::LidarFinding>& found,
                                         Result<estimation::FitResult> fit, bool refined) {
    const std::size_t first = lidar_.size();
    lidar_.insert(lidar_.end(), found.begin(), found.end());
    if (std::none_of(found.begin(), found.end(), [](const auto& f) { return f.effect->is_correctable(); }))
      return fit;
    const State before = state(fit.value(), first);
    placed_with_.resize(0);
    if (refined && look_through_correction())
      selection::refine(std::span(lidar_).subspan(first), lidar_pairs());
    return unless_worse(fit_corrected(), before);
  }

  /// What is gone back to when a correction turns out to be none.
  struct State {
    Eigen::VectorXd parameters;
    vehicle::EffectList effects;
    std::vector<terms::LidarFinding> lidar;
    std::optional<selection::HeldOut> held_out;
  };

  /// @param known of the lidar's findings, those that stay
  [[nodiscard]] State state(const estimation::FitResult& fit, std::size_t known) const {
    return {parameters_,
            effects_,
            {lidar_.begin(), lidar_.begin() + static_cast<std::ptrdiff_t>(known)},
            held_out_now(fit)};
  }

  /// A correction that was not asked for and that the wheels contradict is taken back.
  Result<estimation::FitResult> unless_worse(Result<estimation::FitResult> better, const State& before) {
    const bool asked = !asked_of_lidar_.empty();
    if (better && (asked || !selection::is_worse(before.held_out, held_out_now(better.value()))))
      return better;
    go_back_to(before);
    return fit_corrected();
  }

  void go_back_to(const State& before) {
    parameters_ = before.parameters;
    effects_ = before.effects;
    lidar_ = before.lidar;
  }

  [[nodiscard]] std::optional<selection::HeldOut> held_out_now(const estimation::FitResult& fit) const {
    return selection::held_out_residual(session_->data(), effects_, fit,
                                        vehicle::fixed_with(session_->fixed(0), effects_));
  }

  /// Measures corrected scans, well enough for a second look at what is left of their errors.
  bool look_through_correction() {
    corrected_ = selection::corrected(recordings_, lidar_);
    if (open_and_measure(corrected_)) return false;
    const auto fit = fit_now();
    if (fit) parameters_ = fit.value().parameters;
    return static_cast<bool>(fit);
  }

  Result<estimation::FitResult> fit_corrected() {
    corrected_ = selection::corrected(recordings_, lidar_);
    return measure_anew(corrected_);
  }

  /// From here on effects of the floor know the place, and matches that slide are replaced. What depends on
  /// either is fitted once more.
  Result<estimation::FitResult> locate(Result<estimation::FitResult> fit) {
    if (placed_with_.size() == 0) place_every_scan(false);
    std::vector<std::vector<vehicle::Fix>> fixes;
    for (std::size_t i = 0; i < recordings_.size(); ++i)
      fixes.push_back(paths_.empty() ? measurement::fixes_of(recordings_[i])
                                     : measurement::fixes_of(paths_[i], mount()));
    session_->locate(fixes, parameters_, effects_);
    const bool in_places =
        std::any_of(effects_.begin(), effects_.end(), [](const auto& e) { return acts_in_places(*e); });
    if (!measure_by_places() && !in_places) return fit;
    auto better = fit_now();
    if (better) parameters_ = better.value().parameters;
    return better;
  }

  /// Matches that slide in a loose room look like a carpet; places in the map take their part then.
  bool measure_by_places() {
    bool any = false;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      const auto& [model, pairs, places] = session_->data()[i];
      const vehicle::Trajectory trajectory = model->trajectory(vehicle::as_span(parameters_), effects_);
      const measurement::PathOfWheels wheels = measurement::path_of_wheels(trajectory);
      const bool slides = selection::is_sliding(drift_of_matches(pairs, paths_[i], wheels));
      if (slides) session_->set_pairs(i, pairs_of_places(pairs, paths_[i], wheels));
      session_->set_places(i, paths_[i].scans);
      any = any || slides;
    }
    return any;
  }

  [[nodiscard]] math::Pose mount() const { return vehicle::to_base(vehicle::as_span(parameters_)).mount; }

  /// What is missing beyond the delay: stepwise, each step proved on held-out data.
  void search(const estimation::FitResult& fit) {
    outcome_ = selection::search_effects(session_->data(), effects_, fit, session_->fixed(0),
                                         [&](double fraction) { report("tracing the residual", fraction); });
    effects_ = outcome_.model.effects;
    parameters_ = outcome_.model.fit.parameters;
    retire_idle_offset();
  }

  /// The delay was fitted before anything else was known; what it stood for may have got its own name. One
  /// that is plain but short stays without being told.
  void retire_idle_offset() {
    if (outcome_.findings.empty() && outcome_.curves.empty()) return;
    if (!has(ClockPart::offset) || !is_idle(ClockPart::offset, outcome_.model.fit)) return;
    if (is_plain(ClockPart::offset, outcome_.model.fit)) {
      outcome_.quiet.push_back(effects_[place_of(ClockPart::offset)]);
      return;
    }
    const selection::FitTask task{session_->data(), session_->fixed(0)};
    if (auto fewer = without_effect(task, outcome_.model, place_of(ClockPart::offset), {}))
      outcome_.model = std::move(*fewer);
    effects_ = outcome_.model.effects;
    parameters_ = outcome_.model.fit.parameters;
  }

  void place_every_scan(bool trace_ranges) {
    paths_.clear();
    placed_with_ = parameters_;
    if (!session_->reference_is_scans() && !session_->reference_is_base()) return;
    paths_.resize(recordings_.size());
    place_again(0.0, trace_ranges);
  }

  /// All or none: without walls enough to place nearly every scan of every recording there are no paths.
  void place_again(double done, bool trace_ranges = false) {
    if (!paths_.empty()) report("placing every scan", done);
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      paths_[i] = path_of(i, trace_ranges);
      if (!paths_[i].is_usable()) return paths_.clear();
    }
  }

  [[nodiscard]] measurement::ScanPath path_of(std::size_t recording, bool trace_ranges) const {
    const Recording& given = session_->recordings()[recording];
    const vehicle::DriveModel& model = *session_->data()[recording].model;
    if (session_->reference_is_base()) {
      const vehicle::Trajectory trajectory = model.trajectory(vehicle::as_span(parameters_), effects_);
      measurement::ScanPath path;
      path.scans = measurement::placed_poses(given.poses, measurement::path_of_wheels(trajectory));
      return path;
    }
    const measurement::PathOptions options{
        session_->pair_sets()[recording].range_noise,
        trace_ranges ? measurement::RangeTracer(odomcalib::calib::selection::trace_ranges) : nullptr};
    return place_scans(given, model, vehicle::as_span(parameters_), effects_, options, paths_[recording]);
  }

  /// The same parameters from every scan instead of keyframes.
  void fit_whole_path() {
    const bool is_new = parameters_.size() != placed_with_.size() || parameters_ != placed_with_;
    if (is_new) place_again(0.5);
    if (paths_.empty()) return;
    std::vector<estimation::PathData> data;
    for (std::size_t i = 0; i < paths_.size(); ++i)
      data.push_back({session_->data()[i].model, paths_[i].scans});
    const auto fit =
        fit_path(data, effects_, parameters_,
                 {vehicle::fixed_with(session_->fixed(0), effects_), outcome_.model.fit.prior_information});
    if (!fit || !improves(fit.value())) return;
    parameters_ = outcome_.model.fit.parameters = fit.value().parameters;
    outcome_.model.fit.covariance = fit.value().covariance;
    every_scan_placed_ = true;
  }

  /// Places are believed where they confirm the matches and know better: a map may be wrong as a whole. What
  /// is too small to be told, as a millisecond's delay, is too small to speak against it.
  [[nodiscard]] bool improves(const estimation::PathFit& path) const {
    const std::vector<bool> quiet = quiet_parameters();
    std::vector<selection::Comparison> compared;
    for (Eigen::Index k = 0; k < parameters_.size(); ++k)
      if (!quiet[static_cast<std::size_t>(k)])
        compared.push_back({{parameters_(k), outcome_.model.fit.covariance(k, k)},
                            {path.parameters(k), path.covariance(k, k)},
                            k < vehicle::kBaseCount});
    return selection::confirms_and_knows_better(compared);
  }

  [[nodiscard]] std::vector<bool> quiet_parameters() const {
    std::vector<bool> quiet(vehicle::kBaseCount, false);
    for (const auto& effect : effects_) {
      const bool is_quiet =
          std::find(outcome_.quiet.begin(), outcome_.quiet.end(), effect) != outcome_.quiet.end();
      quiet.insert(quiet.end(), effect->parameters().size(), is_quiet);
    }
    return quiet;
  }

  void fill() {
    report("validating", 0.0);
    report::fill_calibration({*session_, outcome_, lidar_, stamps_, automatic_, every_scan_placed_, remarks_},
                             calibration_);
    report("validating", 1.0);
  }

  std::span<const Recording> recordings_;
  const SolveOptions& options_;
  Progress progress_;
  Calibration calibration_;
  std::unique_ptr<measurement::Session> session_;
  bool cause_is_known_ = false;
  bool automatic_ = false;
  bool every_scan_placed_ =
      false;                   ///< the parameters come from the whole path, not from matches of keyframes
  vehicle::EffectList given_;  ///< asked for by name
  vehicle::EffectList effects_;
  selection::SearchResult outcome_;
  Eigen::VectorXd parameters_;
  std::vector<measurement::ScanPath> paths_;  ///< one per recording, or none
  Eigen::VectorXd measured_with_;             ///< parameters of the pairs
  Eigen::VectorXd placed_with_;  ///< parameters that the paths were made with; empty: they are to be made
  std::vector<terms::LidarEffectPtr> asked_of_lidar_;
  std::vector<terms::LidarFinding> lidar_;
  std::vector<Recording> evened_;  ///< with other times; empty where those given are right
  ingest::StampReport stamps_;
  std::vector<std::string> remarks_;  ///< on what was taken out of the recordings
  std::vector<Recording> corrected_;  ///< without the lidar's errors; what the session measures then
};

}  // namespace

Calibration solve(std::span<const Recording> recordings, const SolveOptions& options,
                  const Progress& progress) {
  Solver solver(recordings, options, progress);
  Calibration calibration = solver.run();
  if (!solver.cause_is_known()) report::explain(recordings, calibration);
  return calibration;
}

}  // namespace odomcalib::calib
