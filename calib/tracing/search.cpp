#include "calib/tracing/search.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/effects/catalogue.hpp"
#include "calib/tracing/score.hpp"

namespace odomcalib::calib {
namespace {

/// Family-wise; a nominal 1 % test exceeds 1 % of robots in many campaigns.
constexpr double kNamedLevel = 0.0009;
/// A delay hardly shows in odometry and cannot spoil it; what changes odometry must be beyond doubt.
constexpr double kClockLevel = 0.003;
constexpr double kUnnamedLevel = 0.0025;
constexpr int kMaxFindings = 3;
constexpr int kMaxCurves = 3;
constexpr int kMaxSteps = 8;        ///< additions and failed proofs together
constexpr std::size_t kRefits = 4;  ///< candidates refitted jointly per step
constexpr double kAmbiguity = 6.0;  ///< units of BIC
constexpr double kAlias = 0.9;      ///< canonical correlation that counts as indistinguishable
constexpr double kSameLaw = 0.6;    ///< share of a curve's statistic that a name inside it must reach

struct Trial {
  std::size_t candidate = 0;
  FitResult fit;
  double gain = 0.0;  ///< drop of -2 log L minus q log(3 n)
};

class Search {
 public:
  Search(std::span<const FitData> data, const EffectList& given, const FitResult& fit,
         const std::vector<bool>& base_fixed, const std::function<void(double)>& progress)
      : data_(data), base_fixed_(base_fixed), progress_(progress) {
    result_.effects = given;
    result_.fit = fit;
    for (const FitData& d : data) models_.push_back(d.model);
  }

  SearchResult run() {
    named_ = remaining_names();
    curves_ = candidate_curves(models_);
    for (int step = 0; step < kMaxSteps; ++step) {
      progress_(static_cast<double>(step) / kMaxSteps);
      if (!advance()) break;
    }
    return std::move(result_);
  }

 private:
  EffectList remaining_names() const {
    EffectList names;
    for (const auto& effect : effect_catalogue())
      if (std::find(result_.effects.begin(), result_.effects.end(), effect) == result_.effects.end())
        names.push_back(effect);
    return names;
  }

  [[nodiscard]] std::vector<bool> fixed(const EffectList& effects) const {
    std::vector<bool> all = base_fixed_;
    all.resize(kBaseCount + count_parameters(effects), false);
    return all;
  }

  /// One step; false when nothing more is justified.
  bool advance() {
    EffectList candidates = named_;
    for (const Curve& curve : curves_) candidates.push_back(make_curve_effect(curve));
    const ScoreTable table =
        score_candidates(data_, result_.effects, result_.fit, fixed(result_.effects), candidates);
    const auto name = result_.findings.size() < kMaxFindings && !result_.unnamed
                          ? best_name(table, candidates)
                          : std::nullopt;
    const auto curve = best_curve(table);
    if (name && !(curve && curve_beats(table, *name, *curve))) {
      if (accept_name(table, candidates, *name)) return true;
    }
    return curve && accept_curve(table, *curve);
  }

  [[nodiscard]] double penalty(std::size_t degrees) const {
    return static_cast<double>(degrees) * std::log(static_cast<double>(result_.fit.whitened_residual.size()));
  }

  static double level(const Effect& effect) {
    return effect.storage() == Storage::driver ? kClockLevel : kNamedLevel;
  }

  /// Joint refits of the most promising names on the noise model of the current fit.
  std::optional<Trial> best_name(const ScoreTable& table, const EffectList& candidates) {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < named_.size(); ++k)
      if (table.scores[k].family_p_value <= level(*candidates[k])) order.push_back(k);
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return table.scores[a].statistic - penalty(table.scores[a].degrees) >
             table.scores[b].statistic - penalty(table.scores[b].degrees);
    });
    order.resize(std::min(order.size(), kRefits));
    trials_.clear();
    for (const std::size_t k : order)
      if (auto trial = refit(k, candidates[k], true)) trials_.push_back(std::move(*trial));
    const auto best = std::max_element(trials_.begin(), trials_.end(),
                                       [](const Trial& a, const Trial& b) { return a.gain < b.gain; });
    return best == trials_.end() ? std::nullopt : std::optional(*best);
  }

  std::optional<Trial> refit(std::size_t index, const std::shared_ptr<const Effect>& effect,
                             bool keep_noise) {
    EffectList effects = result_.effects;
    effects.push_back(effect);
    Eigen::VectorXd start =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kBaseCount + count_parameters(effects)));
    start.head(result_.fit.parameters.size()) = result_.fit.parameters;
    FitOptions options;
    options.fixed = fixed(effects);
    options.max_iterations = 24;
    if (keep_noise) options.noise = result_.fit.noise;
    auto fit = fit_joint(data_, effects, start, options);
    if (!fit) return std::nullopt;
    Trial trial{index, std::move(fit).value(), 0.0};
    trial.gain = result_.fit.cost - trial.fit.cost - penalty(effect->parameters().size());
    return trial;
  }

  [[nodiscard]] std::optional<std::size_t> best_curve(const ScoreTable& table) const {
    std::optional<std::size_t> best;
    for (std::size_t k = named_.size(); k < table.scores.size(); ++k) {
      const Score& score = table.scores[k];
      if (score.family_p_value > kUnnamedLevel) continue;
      if (!best || score.statistic - penalty(score.degrees) >
                       table.scores[*best].statistic - penalty(table.scores[*best].degrees))
        best = k;
    }
    return best;
  }

  /// A curve that contains the name's own law and explains little more is the same finding with a freer law.
  bool curve_beats(const ScoreTable& table, const Trial& name, std::size_t curve) const {
    const Score& free_form = table.scores[curve];
    const Score& named = table.scores[name.candidate];
    const double lead =
        (free_form.statistic - penalty(free_form.degrees)) - (named.statistic - penalty(named.degrees));
    if (lead <= kAmbiguity) return false;
    const double overlap =
        table.correlation(static_cast<Eigen::Index>(name.candidate), static_cast<Eigen::Index>(curve));
    return !(overlap > kAlias && named.statistic > kSameLaw * free_form.statistic);
  }

  /// Held-out proof on one noise model: error at the horizon, and whitened residual per block.
  bool proves_itself(const EffectList& effects, const FitResult& candidate, Finding& finding) const {
    const auto before = horizon_error(data_, result_.effects, result_.fit, fixed(result_.effects));
    const auto after = horizon_error(data_, effects, candidate, fixed(effects));
    const HeldOutGain gain =
        held_out_gain(data_, result_.fit, fixed(result_.effects), candidate, fixed(effects));
    if (before && after) {
      finding.before = before->rms_position();
      finding.after = after->rms_position();
      finding.improvement = compare(*before, *after);
      if (finding.improvement.upper < 1.0) return true;
      if (finding.improvement.lower > 1.0) return false;
    }
    return gain.lower > 0.0;
  }

  bool accept_name(const ScoreTable& table, const EffectList& candidates, const Trial& best) {
    const auto& effect = candidates[best.candidate];
    EffectList effects = result_.effects;
    effects.push_back(effect);
    Finding finding;
    finding.effect = effect;
    finding.family_p_value = table.scores[best.candidate].family_p_value;
    finding.aliases = aliases_of(table, candidates, best);
    if (implausible(*effect, best.fit) || spoils_base(best.fit) || !proves_itself(effects, best.fit, finding))
      return drop(best.candidate);
    auto settled = refit(best.candidate, effect, false);
    if (!settled) return drop(best.candidate);
    result_.fit = std::move(settled->fit);
    result_.effects = std::move(effects);
    result_.findings.push_back(std::move(finding));
    named_.erase(named_.begin() + static_cast<std::ptrdiff_t>(best.candidate));
    return true;
  }

  /// This drive cannot tell the addition from the wheels: it would trade a known geometry for a guess.
  [[nodiscard]] bool spoils_base(const FitResult& fit) const {
    constexpr double kMaxInflation = 3.0;  // of a standard deviation
    for (const auto k : {kLeftRadius, kRightRadius, kTrackWidth})
      if (fit.covariance(k, k) > kMaxInflation * kMaxInflation * result_.fit.covariance(k, k)) return true;
    return false;
  }

  /// Too small to matter (every parameter below a share of its typical size) or physically implausible.
  static bool implausible(const Effect& effect, const FitResult& fit) {
    const auto parameters = effect.parameters();
    const auto first = fit.parameters.size() - static_cast<Eigen::Index>(parameters.size());
    double largest = 0.0;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const double value = fit.parameters(first + static_cast<Eigen::Index>(k));
      if (value < parameters[k].lower || value > parameters[k].upper) return true;
      largest = std::max(largest, std::abs(value) / parameters[k].scale);
    }
    return largest < kNegligibleShare;
  }

  /// A candidate that failed its proof is not asked again; the search goes on with the others.
  bool drop(std::size_t candidate) {
    named_.erase(named_.begin() + static_cast<std::ptrdiff_t>(candidate));
    return true;
  }

  std::vector<std::string> aliases_of(const ScoreTable& table, const EffectList& candidates,
                                      const Trial& best) const {
    std::vector<std::string> aliases = candidates[best.candidate]->always_alike();
    const auto add = [&](std::size_t k) {
      const std::string name = candidates[k]->name();
      if (name != candidates[best.candidate]->name() &&
          std::find(aliases.begin(), aliases.end(), name) == aliases.end())
        aliases.push_back(name);
    };
    for (const Trial& trial : trials_)
      if (best.gain - trial.gain < kAmbiguity) add(trial.candidate);
    for (std::size_t k = 0; k < named_.size(); ++k)
      if (k != best.candidate && table.scores[k].family_p_value <= kNamedLevel &&
          table.correlation(static_cast<Eigen::Index>(best.candidate), static_cast<Eigen::Index>(k)) >
              kAlias &&
          too_close(table, best.candidate, k))
        add(k);
    return aliases;
  }

  /// The expected gap between the true and the wrong one is T (1 - rho^2); below 10 the data do not decide.
  [[nodiscard]] bool too_close(const ScoreTable& table, std::size_t a, std::size_t b) const {
    const double rho = table.correlation(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
    return table.scores[a].statistic * (1.0 - rho * rho) < 10.0;
  }

  bool accept_curve(const ScoreTable& table, std::size_t index) {
    if (result_.unnamed && result_.unnamed->curves.size() >= kMaxCurves) return false;
    const Curve curve = curves_[index - named_.size()];
    const auto effect = make_curve_effect(curve);
    EffectList effects = result_.effects;
    effects.push_back(effect);
    const auto trial = refit(index, effect, true);
    Finding proof;
    if (!trial || implausible(*effect, trial->fit) || spoils_base(trial->fit) ||
        !proves_itself(effects, trial->fit, proof))
      return drop_curve(index);
    auto settled = refit(index, effect, false);
    if (!settled) return drop_curve(index);
    if (!result_.unnamed) result_.unnamed = Unnamed{{}, table.scores[index].family_p_value, 0.0};
    result_.unnamed->curves.push_back(curve);
    const double ratio = proof.before > 0.0 ? proof.after / proof.before : 1.0;
    result_.unnamed->share = 1.0 - (1.0 - result_.unnamed->share) * std::min(ratio * ratio, 1.0);
    result_.fit = std::move(settled->fit);
    result_.effects = std::move(effects);
    return true;
  }

  bool drop_curve(std::size_t index) {
    curves_.erase(curves_.begin() + static_cast<std::ptrdiff_t>(index - named_.size()));
    return true;
  }

  std::span<const FitData> data_;
  std::vector<bool> base_fixed_;
  std::function<void(double)> progress_;
  std::vector<const DriveModel*> models_;
  EffectList named_;
  std::vector<Curve> curves_;
  std::vector<Trial> trials_;
  SearchResult result_;
};

}  // namespace

SearchResult search_effects(std::span<const FitData> data, const EffectList& given, const FitResult& fit,
                            const std::vector<bool>& base_fixed,
                            const std::function<void(double)>& progress) {
  return Search(data, given, fit, base_fixed, progress).run();
}

}  // namespace odomcalib::calib
