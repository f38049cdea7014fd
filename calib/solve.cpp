#include "calib/solve.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "calib/effects/catalogue.hpp"
#include "calib/estimators/path_fit.hpp"
#include "calib/gate.hpp"
#include "calib/lidar/lidar_report.hpp"
#include "calib/report.hpp"
#include "calib/report_data.hpp"
#include "calib/session/lidar_evidence.hpp"
#include "calib/session/start_values.hpp"
#include "calib/tracing/search.hpp"
#include "calib/tracing/tracing_json.hpp"
#include "calib/validation/held_out.hpp"

namespace odomcalib::calib {
namespace {

/// A time offset counts as present when its estimate is this many standard deviations from zero ...
constexpr double kOffsetSignificance = 4.0;
/// ... and longer than what a careful driver leaves, s.
constexpr double kNegligibleOffset = 3e-3;
/// Two estimates from the same scans agree within this many standard deviations of both together.
constexpr double kAgreement = 4.0;

/// What stays without a name, put together from its parts.
class UnnamedSummary {
 public:
  void mention(const std::string& variable) {
    auto& names = all_.depends_on;
    if (std::find(names.begin(), names.end(), variable) == names.end()) names.push_back(variable);
  }
  void add(const std::string& variable, double p_value, double before, double after) {
    if (all_.depends_on.empty()) all_.p_value = p_value;
    mention(variable);
    const double ratio = before > 0.0 ? after / before : 1.0;
    left_ *= std::min(ratio * ratio, 1.0);
  }
  [[nodiscard]] std::optional<Unexplained> result() const {
    if (all_.depends_on.empty()) return std::nullopt;
    Unexplained out = all_;
    out.share = 1.0 - left_;
    return out;
  }

 private:
  Unexplained all_;
  double left_ = 1.0;  // of the squared error
};

class Solver {
 public:
  Solver(std::span<const Recording> recordings, const SolveOptions& options, Progress progress)
      : recordings_(recordings), options_(options), progress_(std::move(progress)) {}

  Calibration run() {
    if (!recordings_.empty()) calibration_.robot = recordings_.front().robot;
    auto session = Session::open(recordings_);
    if (!session) return refuse(session.error());
    session_ = std::make_unique<Session>(std::move(session).value());
    if (auto error = choose_effects()) return refuse(*error);
    start();
    auto fit = settle();
    if (fit) fit = correct_lidar(std::move(fit));
    calibration_.data = data_use(*session_);
    calibration_.methods = classical_methods(*session_, delay(), calibration_);
    if (!fit) {
      MethodResult joint;
      joint.name = "joint";
      joint.refused = fit.error().what;
      calibration_.methods.push_back(joint);
      return refuse(fit.error());
    }
    if (automatic_ && recordings_.front().increments.empty())
      search(fit.value());
    else
      outcome_ = {effects_, fit.value(), {}, {}, {}};
    place_every_scan();
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
    if (calibration_.data.empty() && session_) calibration_.data = data_use(*session_);
    return calibration_;
  }

  /// "auto" and "none" stand alone; otherwise every name must be known.
  std::optional<Error> choose_effects() {
    automatic_ = options_.effects == std::vector<std::string>{"auto"};
    if (automatic_ || options_.effects == std::vector<std::string>{"none"}) return std::nullopt;
    for (const std::string& name : options_.effects) {
      if (const auto of_lidar = find_lidar_effect(name)) {
        asked_of_lidar_.push_back(of_lidar);
        continue;
      }
      const EffectList found = find_effects(name);
      if (found.empty())
        return Error{ErrorCode::usage, "there is no effect named \"" + name + "\"", "--effects",
                     "see odomcalibctl(1)"};
      effects_.insert(effects_.end(), found.begin(), found.end());
    }
    return std::nullopt;
  }

  [[nodiscard]] bool has_offset() const {
    return std::any_of(effects_.begin(), effects_.end(),
                       [](const auto& e) { return e->name() == "time_offset"; });
  }

  [[nodiscard]] double delay() const { return has_offset() ? parameters_(offset_index()) : 0.0; }

  [[nodiscard]] Eigen::Index offset_index() const {
    Eigen::Index index = kBaseCount;
    for (const auto& effect : effects_) {
      if (effect->name() == "time_offset") return index;
      index += static_cast<Eigen::Index>(effect->parameters().size());
    }
    return index;
  }

  /// First matches with nominal values; then the clocks' delay and what the recording does not state.
  void start() {
    report("matching", 0.0);
    parameters_ = to_vector(session_->nominal());
    session_->measure(parameters_, {}, PairOptions{});
    if (automatic_ && recordings_.front().increments.empty()) effects_.push_back(find_effect("time_offset"));
    const double delay = has_offset() ? search_delay(session_->data()) : 0.0;
    parameters_ = to_vector(start_values(*session_, delay), count_parameters(effects_));
    const std::vector<double> own = start_of(effects_);
    parameters_.tail(static_cast<Eigen::Index>(own.size())) =
        Eigen::Map<const Eigen::VectorXd>(own.data(), static_cast<Eigen::Index>(own.size()));
    if (has_offset()) parameters_(offset_index()) = delay;
  }

  /// Fits, matches again with the fitted parameters (guess and de-skew), and fits again. Noise of a match
  /// made with wrong parameters must not reach the result.
  Result<FitResult> settle() {
    report("fitting", 0.0);
    auto fit = fit_now();
    for (int pass = 0; pass < 2 && fit; ++pass) {
      parameters_ = fit.value().parameters;
      if (pass == 0) drop_idle_offset(fit.value());
      report("matching", 0.33 * (pass + 1));
      session_->measure(parameters_, effects_, PairOptions{});
      report("fitting", 0.5 * (pass + 1));
      fit = fit_now();
    }
    if (fit) parameters_ = fit.value().parameters;
    return fit;
  }

  Result<FitResult> fit_now() {
    FitOptions options;
    options.fixed = fixed_with(session_->fixed(0), effects_);
    return fit_joint(session_->data(), effects_, parameters_, options);
  }

  static bool is_idle(const FitResult& fit, Eigen::Index k) {
    const double deviation = std::sqrt(fit.covariance(k, k));
    return std::abs(fit.parameters(k)) <= std::max(kOffsetSignificance * deviation, kNegligibleOffset);
  }

  void drop_idle_offset(const FitResult& fit) {
    if (!automatic_ || !has_offset()) return;
    if (!is_idle(fit, offset_index())) return;
    effects_.clear();
    parameters_ = parameters_.head(kBaseCount).eval();
  }

  [[nodiscard]] bool may_trace_lidar() const {
    const Recording& first = recordings_.front();
    return (automatic_ || !asked_of_lidar_.empty()) && first.increments.empty() && !first.scans.empty() &&
           !session_->reference_is_base();
  }

  [[nodiscard]] std::vector<HeadingPair> lidar_pairs() const {
    return heading_pairs(*session_, parameters_, effects_);
  }

  /// Errors of the lidar show between scans, before any wheel is asked. They are taken out of the scans, and
  /// everything is measured and fitted anew; a second look settles their values.
  Result<FitResult> correct_lidar(Result<FitResult> fit) {
    if (!may_trace_lidar()) return fit;
    report("tracing the lidar", 0.0);
    lidar_ = asked_of_lidar_.empty() ? trace_lidar(lidar_pairs(), sees_all_round(*session_))
                                     : fit_lidar(lidar_pairs(), asked_of_lidar_);
    if (std::none_of(lidar_.begin(), lidar_.end(), [](const auto& f) { return f.effect->is_correctable(); }))
      return fit;
    const auto before = held_out_now(fit.value());
    const auto uncorrected = std::pair(parameters_, effects_);
    auto better = fit_corrected();
    if (better) refine(lidar_, lidar_pairs());
    if (better) better = fit_corrected();
    if (better && !(asked_of_lidar_.empty() && is_worse(before, held_out_now(better.value())))) return better;
    return without_correction(uncorrected);
  }

  [[nodiscard]] std::optional<HeldOut> held_out_now(const FitResult& fit) const {
    return held_out_residual(session_->data(), effects_, fit, fixed_with(session_->fixed(0), effects_));
  }

  /// A correction of the lidar that the wheels contradict is none.
  static bool is_worse(const std::optional<HeldOut>& before, const std::optional<HeldOut>& after) {
    constexpr double kTolerated = 1.05;
    if (!before || !after) return !after && before;
    for (std::size_t k = 0; k < before->rms.size(); ++k)
      if (after->rms[k] > kTolerated * before->rms[k]) return true;
    return false;
  }

  Result<FitResult> without_correction(const std::pair<Eigen::VectorXd, EffectList>& uncorrected) {
    lidar_.clear();
    std::tie(parameters_, effects_) = uncorrected;
    return fit_on(recordings_);
  }

  Result<FitResult> fit_corrected() {
    corrected_ = corrected(recordings_, lidar_, session_->pair_sets());
    return fit_on(corrected_);
  }

  Result<FitResult> fit_on(std::span<const Recording> recordings) {
    auto session = Session::open(recordings);
    if (!session) return session.error();
    session_ = std::make_unique<Session>(std::move(session).value());
    session_->measure(parameters_, effects_, PairOptions{});
    return settle();
  }

  /// What is missing beyond the delay: stepwise, each step proved on held-out data.
  void search(const FitResult& fit) {
    outcome_ = search_effects(session_->data(), effects_, fit, session_->fixed(0),
                              [&](double fraction) { report("tracing the residual", fraction); });
    effects_ = outcome_.effects;
    parameters_ = outcome_.fit.parameters;
    retire_idle_offset();
  }

  /// The delay was fitted before anything else was known; what it stood for may have got its own name.
  void retire_idle_offset() {
    if (outcome_.findings.empty() && outcome_.curves.empty()) return;
    if (!has_offset() || !is_idle(outcome_.fit, offset_index())) return;
    const auto offset = std::find_if(effects_.begin(), effects_.end(),
                                     [](const auto& e) { return e->name() == "time_offset"; });
    const Eigen::Index k = offset_index(), after = parameters_.size() - k - 1;
    Eigen::VectorXd fewer(parameters_.size() - 1);
    fewer << parameters_.head(k), parameters_.tail(after);
    effects_.erase(offset);
    parameters_ = fewer;
    auto fit = fit_now();
    if (fit) outcome_.fit = std::move(fit).value();
    if (fit) outcome_.effects = effects_, parameters_ = outcome_.fit.parameters;
    if (!fit) effects_ = outcome_.effects, parameters_ = outcome_.fit.parameters;
  }

  /// The same parameters from every scan instead of keyframes, where the room has walls enough to place all
  /// of them.
  void place_every_scan() {
    if (session_->reference_is_base() || recordings_.front().scans.empty()) return;
    report("placing every scan", 0.0);
    const auto paths = paths_of_all();
    if (!paths) return;
    const auto fit = fit_path(*paths, effects_, parameters_,
                              {fixed_with(session_->fixed(0), effects_), outcome_.fit.prior_information});
    if (!fit || !improves(fit.value())) return;
    parameters_ = outcome_.fit.parameters = fit.value().parameters;
    outcome_.fit.covariance = fit.value().covariance;
    every_scan_placed_ = true;
  }

  [[nodiscard]] std::optional<std::vector<PathData>> paths_of_all() const {
    const std::span<const double> p(parameters_.data(), static_cast<std::size_t>(parameters_.size()));
    std::vector<PathData> paths;
    for (std::size_t i = 0; i < session_->recordings().size(); ++i) {
      const DriveModel* model = session_->data()[i].model;
      ScanPath path =
          place_scans(session_->recordings()[i], *model, p, effects_, session_->pair_sets()[i].range_noise);
      if (!path.is_usable()) return std::nullopt;
      paths.push_back({model, std::move(path.scans)});
    }
    return paths;
  }

  /// Places are believed where they confirm the matches and know better: a map may be wrong as a whole.
  [[nodiscard]] bool improves(const PathFit& path) const {
    double gain = 0.0;  // logarithm of the ratio of variances, summed
    for (Eigen::Index k = 0; k < parameters_.size(); ++k) {
      const double before = outcome_.fit.covariance(k, k), after = path.covariance(k, k);
      if (!(before > 0.0) || !(after > 0.0)) continue;
      const double apart = path.parameters(k) - parameters_(k);
      if (apart * apart > kAgreement * kAgreement * (before + after)) return false;
      if (k < kBaseCount) gain += std::log(before / after);
    }
    return gain > 0.0;
  }

  void fill() {
    const FitResult& fit = outcome_.fit;
    const std::span<const double> p(fit.parameters.data(), static_cast<std::size_t>(fit.parameters.size()));
    const Eigen::MatrixXd covariance =
        lengths_may_be_scaled() ? with_matcher_scale(fit.covariance, to_base(p)) : fit.covariance;
    calibration_.parameters = base_quantities(to_base(p), covariance);
    calibration_.covariance_order = base_quantity_names();
    calibration_.covariance = diameter_covariance(covariance);
    calibration_.methods.push_back(joint_method(fit));
    report("validating", 0.0);
    fit_plain();
    fill_residual();
    fill_effects();
    fill_unnamed();
    if (!outcome_.considered.empty())
      calibration_.extensions["considered"] = considered_to_json(outcome_.considered);
    store_report_data(make_report_data(*session_, effects_, outcome_.fit, plain_), calibration_);
    const GateResult gate = judge(calibration_, fit.converged);
    calibration_.verdict = gate.verdict;
    calibration_.reasons = gate.reasons;
    report("validating", 1.0);
  }

  /// Matches of keyframes are not free of bias; neither is a model with a law that was found to fit, whose
  /// true shape nobody knows. Places in a map are, as far as fifty simulated drives tell.
  [[nodiscard]] bool lengths_may_be_scaled() const {
    if (recordings_.front().scans.empty() || session_->reference_is_base()) return false;
    const bool only_delay = std::all_of(effects_.begin(), effects_.end(),
                                        [](const auto& e) { return e->name() == "time_offset"; });
    return !every_scan_placed_ || !only_delay || !lidar_.empty();
  }

  /// The six base parameters alone, on the same pairs: what the effects are measured against.
  void fit_plain() {
    if (effects_.empty()) {
      plain_ = outcome_.fit;
      return;
    }
    FitOptions options;
    options.fixed = session_->fixed(0);
    auto plain = fit_joint(session_->data(), {}, parameters_.head(kBaseCount), options);
    if (plain) plain_ = std::move(plain).value();
  }

  void fill_residual() {
    const auto after =
        held_out_residual(session_->data(), effects_, outcome_.fit, fixed_with(session_->fixed(0), effects_));
    calibration_.residual.held_out = after.has_value();
    if (!after) return;
    calibration_.residual.after = after->rms;
    calibration_.residual.noise_floor = after->noise_floor;
    calibration_.residual.before = after->rms;
    if (effects_.empty() || !plain_) return;
    const auto before = held_out_residual(session_->data(), {}, *plain_, session_->fixed(0));
    if (before) calibration_.residual.before = before->rms;
  }

  [[nodiscard]] const Finding* finding_of(const Effect* effect) const {
    for (const Finding& finding : outcome_.findings)
      if (finding.effect.get() == effect) return &finding;
    return nullptr;
  }

  /// Evidence for an effect that the search did not add: the delay found before it, or what the user asked
  /// for.
  [[nodiscard]] Evidence evidence_against_plain(double z) const {
    Evidence evidence;
    evidence.p_value = std::erfc(z / std::sqrt(2.0));
    if (!plain_) return evidence;
    const std::vector<bool> trusted = trusted_pairs(*plain_, outcome_.fit);
    const auto before = horizon_error(session_->data(), {}, *plain_, session_->fixed(0), trusted);
    const auto after = horizon_error(session_->data(), effects_, outcome_.fit,
                                     fixed_with(session_->fixed(0), effects_), trusted);
    if (before) evidence.held_out_before = before->rms_position();
    if (after) evidence.held_out_after = after->rms_position();
    return evidence;
  }

  void fill_effects() {
    calibration_.effects = effect_results(lidar_);
    Eigen::Index index = kBaseCount;
    for (const auto& effect : effects_) {
      const auto curve = std::find_if(outcome_.curves.begin(), outcome_.curves.end(),
                                      [&](const AddedCurve& c) { return c.effect == effect; });
      if (curve == outcome_.curves.end())
        calibration_.effects.push_back(describe(*effect, index));
      else
        fitted_curves_.push_back(fitted(*curve, index));
      index += static_cast<Eigen::Index>(effect->parameters().size());
    }
    if (!fitted_curves_.empty()) calibration_.extensions[kCurvesMember] = curves_to_json(fitted_curves_);
  }

  [[nodiscard]] FittedCurve fitted(const AddedCurve& added, Eigen::Index index) const {
    FittedCurve curve{added.curve, {}, added.law_of ? added.law_of->name() : ""};
    for (std::size_t k = 0; k < basis_size(added.curve); ++k)
      curve.coefficients.push_back(outcome_.fit.parameters(index++));
    return curve;
  }

  /// @param index of the effect's first parameter in the parameter vector
  [[nodiscard]] EffectResult describe(const Effect& effect, Eigen::Index index) const {
    EffectResult result;
    result.name = effect.name();
    double z = 0.0;
    for (const EffectParameter& parameter : effect.parameters()) {
      const double value = outcome_.fit.parameters(index);
      const double deviation = std::sqrt(std::max(outcome_.fit.covariance(index, index), 0.0));
      result.parameters.push_back(
          {parameter.name, {value, parameter.fixed ? -1.0 : deviation, parameter.unit}});
      if (deviation > 0.0 && parameter.start == 0.0) z = std::max(z, std::abs(value) / deviation);
      ++index;
    }
    const Finding* finding = finding_of(&effect);
    result.aliases = finding != nullptr ? finding->aliases : effect.always_alike();
    result.evidence = finding != nullptr ? Evidence{finding->proof.family_p_value, finding->proof.before,
                                                    finding->proof.after}
                                         : evidence_against_plain(z);
    return result;
  }

  /// Curves without a name: variables they depend on, in the order found.
  void fill_unnamed() {
    UnnamedSummary summary;
    for (const LidarFinding& finding : lidar_)
      if (!finding.effect->is_named() && !completes(finding, lidar_))
        summary.add(finding.effect->name(), finding.family_p_value, finding.before, finding.after);
    for (const AddedCurve& added : outcome_.curves)
      if (!added.law_of)
        summary.add(to_string(added.curve.law.variable), added.proof.family_p_value, added.proof.before,
                    added.proof.after);
    for (const AddedCurve& added : outcome_.curves)
      for (const Variable variable : added.law_of ? std::vector<Variable>{} : added.alike)
        summary.mention(to_string(variable));
    calibration_.unexplained = summary.result();
    const auto has_no_name = [](const LidarFinding& finding) { return !finding.effect->is_named(); };
    if (std::any_of(lidar_.begin(), lidar_.end(), has_no_name))
      calibration_.extensions[kLidarCurvesMember] = lidar_curves_to_json(lidar_);
  }

  std::span<const Recording> recordings_;
  const SolveOptions& options_;
  Progress progress_;
  Calibration calibration_;
  std::unique_ptr<Session> session_;
  bool automatic_ = false;
  bool every_scan_placed_ =
      false;  ///< the parameters come from the whole path, not from matches of keyframes
  EffectList effects_;
  SearchResult outcome_;
  std::optional<FitResult> plain_;
  std::vector<FittedCurve> fitted_curves_;
  Eigen::VectorXd parameters_;
  std::vector<LidarEffectPtr> asked_of_lidar_;
  std::vector<LidarFinding> lidar_;
  std::vector<Recording> corrected_;  ///< without the lidar's errors; what the session measures then
};

}  // namespace

Calibration solve(std::span<const Recording> recordings, const SolveOptions& options,
                  const Progress& progress) {
  return Solver(recordings, options, progress).run();
}

}  // namespace odomcalib::calib
