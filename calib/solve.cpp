#include "calib/solve.hpp"

#include <algorithm>
#include <cmath>

#include "calib/effects/catalogue.hpp"
#include "calib/gate.hpp"
#include "calib/report.hpp"
#include "calib/session/start_values.hpp"
#include "calib/validation/held_out.hpp"

namespace odomcalib::calib {
namespace {

/// A time offset counts as present when its estimate is this many standard deviations from zero ...
constexpr double kOffsetSignificance = 4.0;
/// ... and longer than what a careful driver leaves, s.
constexpr double kNegligibleOffset = 2e-3;

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
    const auto fit = settle();
    calibration_.data = data_use(*session_);
    calibration_.methods = classical_methods(*session_, delay(), calibration_);
    if (!fit) {
      MethodResult joint;
      joint.name = "joint";
      joint.refused = fit.error().what;
      calibration_.methods.push_back(joint);
      return refuse(fit.error());
    }
    fill(fit.value());
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
      const auto effect = find_effect(name);
      if (!effect)
        return Error{ErrorCode::usage, "there is no effect named \"" + name + "\"", "--effects",
                     "see odomcalibctl(1)"};
      effects_.push_back(effect);
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
    if (has_offset()) parameters_(offset_index()) = delay;
  }

  /// Fits, matches again with the fitted parameters (guess and de-skew), and fits again. Noise of a match
  /// made with wrong parameters must not reach the result.
  Result<FitResult> settle() {
    report("fitting", 0.2);
    auto fit = fit_now();
    for (int pass = 0; pass < 2 && fit; ++pass) {
      parameters_ = fit.value().parameters;
      if (pass == 0) drop_idle_offset(fit.value());
      report("matching", 0.3 + 0.3 * pass);
      session_->measure(parameters_, effects_, PairOptions{});
      report("fitting", 0.5 + 0.3 * pass);
      fit = fit_now();
    }
    if (fit) parameters_ = fit.value().parameters;
    return fit;
  }

  Result<FitResult> fit_now() {
    FitOptions options;
    options.fixed = session_->fixed(count_parameters(effects_));
    return fit_joint(session_->data(), effects_, parameters_, options);
  }

  void drop_idle_offset(const FitResult& fit) {
    if (!automatic_ || !has_offset()) return;
    const Eigen::Index k = offset_index();
    const double deviation = std::sqrt(fit.covariance(k, k));
    if (std::abs(fit.parameters(k)) > std::max(kOffsetSignificance * deviation, kNegligibleOffset)) return;
    effects_.clear();
    parameters_ = parameters_.head(kBaseCount).eval();
  }

  void fill(const FitResult& fit) {
    const std::span<const double> p(fit.parameters.data(), static_cast<std::size_t>(fit.parameters.size()));
    calibration_.parameters = base_quantities(to_base(p), fit.covariance);
    calibration_.covariance_order = base_quantity_names();
    calibration_.covariance = diameter_covariance(fit.covariance);
    calibration_.methods.push_back(joint_method(fit));
    report("validating", 0.9);
    fill_residual(fit);
    fill_effects(fit);
    const GateResult gate = judge(calibration_, fit.converged);
    calibration_.verdict = gate.verdict;
    calibration_.reasons = gate.reasons;
    report("done", 1.0);
  }

  void fill_residual(const FitResult& fit) {
    const auto after =
        held_out_residual(session_->data(), effects_, fit, session_->fixed(count_parameters(effects_)));
    if (!after) {
      calibration_.residual.held_out = false;
      return;
    }
    calibration_.residual.after = after->rms;
    calibration_.residual.noise_floor = after->noise_floor;
    calibration_.residual.before = effects_.empty() ? after->rms : plain_held_out().value_or(after->rms);
  }

  /// Held-out residual of the six base parameters alone, on the same pairs.
  std::optional<std::array<double, 3>> plain_held_out() {
    FitOptions options;
    options.fixed = session_->fixed(0);
    const auto plain = fit_joint(session_->data(), {}, parameters_.head(kBaseCount), options);
    if (!plain) return std::nullopt;
    const auto before = held_out_residual(session_->data(), {}, plain.value(), options.fixed);
    return before ? std::optional(before->rms) : std::nullopt;
  }

  void fill_effects(const FitResult& fit) {
    Eigen::Index index = kBaseCount;
    for (const auto& effect : effects_) {
      EffectResult result;
      result.name = effect->name();
      result.aliases = effect->aliases();
      double z = 0.0;
      for (const EffectParameter& parameter : effect->parameters()) {
        const double deviation = std::sqrt(std::max(fit.covariance(index, index), 0.0));
        result.parameters.push_back({parameter.name, {fit.parameters(index), deviation, parameter.unit}});
        if (deviation > 0.0) z = std::max(z, std::abs(fit.parameters(index)) / deviation);
        ++index;
      }
      result.evidence.p_value = std::erfc(z / std::sqrt(2.0));
      calibration_.effects.push_back(result);
    }
  }

  std::span<const Recording> recordings_;
  const SolveOptions& options_;
  Progress progress_;
  Calibration calibration_;
  std::unique_ptr<Session> session_;
  bool automatic_ = false;
  EffectList effects_;
  Eigen::VectorXd parameters_;
};

}  // namespace

Calibration solve(std::span<const Recording> recordings, const SolveOptions& options,
                  const Progress& progress) {
  return Solver(recordings, options, progress).run();
}

}  // namespace odomcalib::calib
