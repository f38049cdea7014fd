#include "calib/tracing/search.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "calib/effects/catalogue.hpp"
#include "calib/noise/noise_estimate.hpp"
#include "calib/tracing/plausibility.hpp"
#include "calib/tracing/score.hpp"

namespace odomcalib::calib {
namespace {

/// Family-wise; a nominal 1 % test exceeds 1 % of robots in many campaigns.
constexpr double kNamedLevel = 0.0009;
/// A delay hardly shows in odometry and cannot spoil it; what changes odometry must be beyond doubt.
constexpr double kClockLevel = 0.003;
constexpr double kUnnamedLevel = 0.0025;
constexpr std::size_t kMaxFindings = 3;
constexpr std::size_t kMaxCurves = 4;
constexpr int kMaxSteps = 12;       ///< additions and failed proofs together
constexpr std::size_t kRefits = 4;  ///< candidates refitted jointly per step
constexpr double kAmbiguity = 6.0;  ///< units of BIC
constexpr double kAlias = 0.9;      ///< canonical correlation that counts as indistinguishable
constexpr double kSameLaw = 0.5;    ///< share of a curve's statistic that a name with that law must reach
/// Share of the error that a curve, or an effect of the place, must leave at most: less is not worth a model.
constexpr double kWorthwhile = 0.95;
/// Family-wise level at which the data outside a fold must point to a candidate that all data together have
/// chosen.
constexpr double kFoldLevel = 0.05;
constexpr double kTelling = 10.0;  ///< expected gap of -2 log L that tells two candidates apart

/// One thing that may be missing: a named effect (one of its variants) or a curve.
struct Candidate {
  std::shared_ptr<const Effect> effect;
  std::optional<Curve> curve;
  std::string key;      ///< variants of one effect share it
  bool struck = false;  ///< added, or failed its proof: not asked again
};

struct Trial {
  std::size_t candidate = 0;
  FitResult fit;
  double gain = 0.0;  ///< drop of -2 log L minus q log(3 n)
};

std::string key_of(const Effect& effect) { return effect.name() + "/" + effect.parameters().front().name; }

bool contains(const std::vector<Law>& laws, const Law& law) {
  return std::find(laws.begin(), laws.end(), law) != laws.end();
}

bool belongs_to_one_recording(const Effect& effect) {
  const auto laws = effect.laws();
  return std::any_of(laws.begin(), laws.end(),
                     [](const Law& law) { return begins_with_the_recording(law.variable); });
}

std::size_t count_sizes(const Effect& effect) {
  const auto parameters = effect.parameters();
  return static_cast<std::size_t>(
      std::count_if(parameters.begin(), parameters.end(), [](const EffectParameter& p) { return !p.fixed; }));
}

/// Squared distance that a pair's weight stands for (the inverse of Student's t weight).
double squared_distance(double weight) {
  return ((kStudentDof + 3.0) / weight) - kStudentDof / kStudentConsistency;
}

/// How much larger the noise would have to be for the largest twentieth of the residuals to be noise. A
/// failed match is rare; where many pairs are far out, something systematic is, and weights must not take it
/// for failures.
double excess_of_outliers(const FitResult& fit) {
  constexpr double kShare = 0.95;
  constexpr double kExpected = 7.815;  // quantile of chi-squared with three degrees of freedom
  if (fit.weights.empty()) return 1.0;
  std::vector<double> squared;
  for (const double w : fit.weights) squared.push_back(squared_distance(w));
  const auto nth =
      squared.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(squared.size() - 1));
  std::nth_element(squared.begin(), nth, squared.end());
  return std::sqrt(std::max(*nth, 0.0) / kExpected);
}

/// Base parameters that the carrier scales.
std::vector<BaseIndex> lengths_of(Carrier carrier) {
  switch (carrier) {
    case Carrier::left_travel:
      return {kLeftRadius};
    case Carrier::right_travel:
      return {kRightRadius};
    case Carrier::both_travel:
      return {kLeftRadius, kRightRadius};
    case Carrier::track:
      return {kTrackWidth};
    default:
      return {};
  }
}

NoiseModel widened(NoiseModel noise, double factor) {
  noise.matcher_scale *= factor;
  noise.process_translation *= factor;
  noise.process_rotation *= factor;
  noise.stamp_jitter *= factor;
  return noise;
}

class Search {
 public:
  Search(std::span<const FitData> data, const EffectList& given, const FitResult& fit,
         const std::vector<bool>& base_fixed, const std::function<void(double)>& progress)
      : data_(data), base_fixed_(base_fixed), progress_(progress) {
    result_.effects = given;
    result_.fit = fit;
    collect_candidates();
  }

  SearchResult run() {
    for (int step = 0; step < kMaxSteps; ++step) {
      progress_(static_cast<double>(step) / kMaxSteps);
      if (!advance()) break;
    }
    return std::move(result_);
  }

 private:
  void collect_candidates() {
    std::set<std::string> present;
    for (const auto& effect : result_.effects) present.insert(key_of(*effect));
    for (const auto& effect : effect_catalogue()) {
      if (present.count(key_of(*effect)) > 0 || (data_.size() > 1 && belongs_to_one_recording(*effect)))
        continue;
      EffectList shapes = effect->variants();
      if (shapes.empty()) shapes.push_back(effect);
      for (const auto& shape : shapes) candidates_.push_back({shape, std::nullopt, key_of(*shape)});
    }
    for (const Curve& free : candidate_curves(models())) {
      // Odometry does without what belongs to the place or the day: then the base must be that of the whole
      // drive.
      const Curve curve = belongs_to_the_place(free.law.variable) ? centred(free, models()) : free;
      const auto effect = make_curve_effect(curve);
      candidates_.push_back(
          {effect, curve,
           effect->name() + "/" + std::to_string(curve.period) + "/" + std::to_string(curve.harmonic)});
    }
  }

  [[nodiscard]] std::vector<bool> fixed(const EffectList& effects) const {
    return fixed_with(base_fixed_, effects);
  }

  /// The fit that candidates are tested on: the result's, or one with wider noise where many pairs are far
  /// out.
  void choose_basis() {
    constexpr double kTolerated = 1.3;
    basis_ = result_.fit;
    const double excess = excess_of_outliers(result_.fit);
    if (excess < kTolerated) return;
    FitOptions options;
    options.fixed = fixed(result_.effects);
    for (const NoiseModel& noise : result_.fit.noise) options.noise.push_back(widened(noise, excess));
    auto fit = fit_joint(data_, result_.effects, result_.fit.parameters, options);
    if (fit) basis_ = std::move(fit).value();
  }

  /// One step; false when nothing more is justified.
  bool advance() {
    if (has_changed_) look_again();
    const auto name = may_name() ? best_name(*table_) : std::nullopt;
    const auto curve = best_curve(*table_);
    if (name && !(curve && curve_beats(*table_, *name, *curve)) && accept_name(*table_, *name)) return true;
    const auto clock = curve && depends_on_history(candidates_[*curve]) ? best_clock() : std::nullopt;
    if (clock) return accept_name(*table_, *clock);
    return curve && accept_curve(*table_, *curve);
  }

  /// Scores of all that is left, on the model as it is now.
  void look_again() {
    choose_basis();
    std::erase_if(candidates_, [](const Candidate& c) { return c.struck; });
    EffectList effects;
    for (const Candidate& c : candidates_) effects.push_back(c.effect);
    table_.emplace(data_, result_.effects, basis_, fixed(result_.effects), effects);
    trials_.clear();
    has_changed_ = false;
  }

  /// Where motions begin, clocks that disagree look like anything that goes with beginnings. A clock cannot
  /// spoil odometry, so it is asked first.
  [[nodiscard]] std::optional<Trial> best_clock() const {
    std::optional<Trial> best;
    for (const Trial& trial : trials_)
      if (is_open(trial.candidate) && candidates_[trial.candidate].effect->storage() == Storage::driver &&
          trial.gain > 0.0 && (!best || trial.gain > best->gain))
        best = trial;
    return best;
  }

  static bool depends_on_history(const Candidate& candidate) {
    const Variable variable = candidate.curve->law.variable;
    return is_memory(variable) || is_distance_since(variable);
  }

  [[nodiscard]] bool may_name() const {
    return result_.findings.size() < kMaxFindings && !result_.has_unnamed();
  }

  [[nodiscard]] double penalty(std::size_t degrees) const {
    return static_cast<double>(degrees) * std::log(static_cast<double>(basis_.whitened_residual.size()));
  }

  [[nodiscard]] double penalised(const Score& score) const {
    return score.statistic - penalty(score.degrees);
  }

  [[nodiscard]] double level(const Candidate& candidate) const {
    if (candidate.curve)
      return completes(candidate) || must_be_worthwhile(candidate) ? kNamedLevel : kUnnamedLevel;
    return candidate.effect->storage() == Storage::driver ? kClockLevel : kNamedLevel;
  }

  /// Joint refits of the most promising names on the noise model of the current fit.
  std::optional<Trial> best_name(const ScoreTable& table) {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (is_open(k) && !candidates_[k].curve && table.scores()[k].family_p_value <= level(candidates_[k]) &&
          !is_rest_of_a_law(table, k))
        order.push_back(k);
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return penalised(table.scores()[a]) > penalised(table.scores()[b]);
    });
    std::set<std::string> tried;
    for (const std::size_t k : order)
      if (tried.size() < kRefits && tried.insert(candidates_[k].key).second) try_out(k);
    const Trial* best = nullptr;
    for (const Trial& trial : trials_)
      if (is_open(trial.candidate) && (best == nullptr || trial.gain > best->gain)) best = &trial;
    return best == nullptr ? std::nullopt : std::optional(*best);
  }

  [[nodiscard]] bool is_open(std::size_t candidate) const { return !candidates_[candidate].struck; }

  /// Once as long as the model stays as it is.
  void try_out(std::size_t candidate) {
    const bool was_tried =
        std::any_of(trials_.begin(), trials_.end(), [&](const Trial& t) { return t.candidate == candidate; });
    if (was_tried) return;
    if (auto trial = refit(candidate, true)) trials_.push_back(std::move(*trial));
  }

  /// What a finding leaves on its own ground is the rest of its law, unless a second name explains nearly all
  /// that a free curve would.
  [[nodiscard]] bool is_rest_of_a_law(const ScoreTable& table, std::size_t candidate) const {
    constexpr double kNearlyAll = 0.9;
    const std::vector<Law> laws = candidates_[candidate].effect->laws();
    const auto is_taken = [&](const Law& law) {
      return std::any_of(result_.findings.begin(), result_.findings.end(),
                         [&](const Finding& f) { return contains(f.effect->laws(), law); });
    };
    if (std::none_of(laws.begin(), laws.end(), is_taken)) return false;
    double of_curves = 0.0;
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (candidates_[k].curve && contains(laws, candidates_[k].curve->law) &&
          is_taken(candidates_[k].curve->law))
        of_curves += table.scores()[k].statistic;
    return table.scores()[candidate].statistic < kNearlyAll * of_curves;
  }

  std::optional<Trial> refit(std::size_t index, bool keep_noise) {
    const auto& effect = candidates_[index].effect;
    EffectList effects = result_.effects;
    effects.push_back(effect);
    Eigen::VectorXd start(static_cast<Eigen::Index>(kBaseCount + count_parameters(effects)));
    const std::vector<double> own = start_of({effect});
    start << basis_.parameters,
        Eigen::Map<const Eigen::VectorXd>(own.data(), static_cast<Eigen::Index>(own.size()));
    auto fit = fit_from(effects, start, keep_noise);
    if (!fit) return std::nullopt;
    Trial trial{index, std::move(*fit), 0.0};
    trial.gain = basis_.cost - trial.fit.cost - penalty(count_sizes(*effect));
    return trial;
  }

  std::optional<FitResult> fit_from(const EffectList& effects, const Eigen::VectorXd& start,
                                    bool keep_noise) const {
    FitOptions options;
    options.fixed = fixed(effects);
    options.max_iterations = 24;
    if (keep_noise) options.noise = basis_.noise;
    auto fit = fit_joint(data_, effects, start, options);
    if (!fit) return std::nullopt;
    return std::move(fit).value();
  }

  [[nodiscard]] std::optional<std::size_t> best_curve(const ScoreTable& table) const {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (!is_open(k) || !candidates_[k].curve || table.scores()[k].family_p_value > level(candidates_[k]))
        continue;
      if (!best || penalised(table.scores()[k]) > penalised(table.scores()[*best])) best = k;
    }
    return best;
  }

  /// A curve on the name's own ground that explains no more than about twice as much is the same finding with
  /// a freer law.
  bool curve_beats(const ScoreTable& table, const Trial& name, std::size_t curve) const {
    const Score& free_form = table.scores()[curve];
    const Score& named = table.scores()[name.candidate];
    if (penalised(free_form) - penalised(named) <= kAmbiguity) return false;
    const bool same_ground =
        contains(candidates_[name.candidate].effect->laws(), candidates_[curve].curve->law) ||
        table.correlation(name.candidate, curve) > kAlias;
    return !(same_ground && named.statistic > kSameLaw * free_form.statistic);
  }

  /// Scan matching has a bias of its own in a room, and in a scripted drive what happened before stands for
  /// the place in the script: what goes with such variables must be more than that.
  static bool must_be_worthwhile(const Candidate& candidate) {
    const auto laws = candidate.curve ? std::vector<Law>{candidate.curve->law} : candidate.effect->laws();
    return std::any_of(laws.begin(), laws.end(), [&](const Law& law) {
      const bool of_room = law.variable == Variable::heading || law.variable == Variable::position;
      const bool of_history = is_memory(law.variable) || is_distance_since(law.variable);
      return of_room || (of_history && candidate.curve);
    });
  }

  /// Of the errors after and before. A curve that odometry will use must be seen to help odometry.
  static double largest_ratio(const Candidate& candidate) {
    constexpr double kCurve = 0.97;
    if (must_be_worthwhile(candidate)) return kWorthwhile;
    const bool will_be_used = candidate.effect->storage() == Storage::host;
    return candidate.curve && will_be_used ? kCurve : std::numeric_limits<double>::infinity();
  }

  /// Held-out proof on one noise model: error at the horizon, or whitened residual per block. The choice
  /// itself is held out: a fold counts only if the others point to the candidate too.
  /// @return empty if it holds, otherwise what is missing
  std::string objection(const ScoreTable& table, const Trial& trial, const EffectList& effects,
                        Proof& proof) const {
    const Candidate& candidate = candidates_[trial.candidate];
    const FoldFlags selected = table.selected_without(trial.candidate, kFoldLevel);
    proof.family_p_value = table.scores()[trial.candidate].family_p_value;
    const std::vector<bool> trusted = trusted_pairs(basis_, trial.fit);
    const auto before = horizon_error(data_, result_.effects, basis_, fixed(result_.effects), trusted);
    const auto after = horizon_error(data_, effects, trial.fit, fixed(effects), trusted);
    if (before && after) {
      const HorizonError mixed = where_selected(*before, *after, selected);
      proof.before = before->rms_position();
      proof.after = mixed.rms_position();
      proof.improvement = compare(*before, mixed);
      if (proof.improvement.ratio > largest_ratio(candidate))
        return "too small a gain: error times " + std::to_string(proof.improvement.ratio).substr(0, 5);
      if (proof.improvement.upper < 1.0) return {};
      if (proof.improvement.lower > 1.0) return "held-out error rises";
    }
    const HeldOutGain gain = compared_on_held_out(basis_, result_.effects, trial.fit, effects, selected);
    return gain.lower > 0.0 ? "" : "no gain on held-out data";
  }

  /// Each model's own weights spare what it explains badly: both are compared with the larger ones.
  [[nodiscard]] HeldOutGain compared_on_held_out(const FitResult& before, const EffectList& effects_before,
                                                 const FitResult& after, const EffectList& effects_after,
                                                 const FoldFlags& selected) const {
    std::vector<double> weights(after.weights.size());
    std::transform(after.weights.begin(), after.weights.end(), before.weights.begin(), weights.begin(),
                   [](double a, double b) { return std::max(a, b); });
    return held_out_gain(data_, with_weights(data_, effects_before, before, weights), fixed(effects_before),
                         with_weights(data_, effects_after, after, weights), fixed(effects_after), selected);
  }

  [[nodiscard]] std::string implausibility(const Effect& effect, const FitResult& fit) const {
    if (is_impossible(effect, fit)) return "outside its physical range";
    if (is_negligible(effect, fit)) return "too small to matter";
    return spoils_base(effect, basis_, fit) ? "this drive cannot tell it from the wheels" : "";
  }

  /// Adds the candidate if it is plausible and proves itself; otherwise strikes it off the list.
  std::optional<Proof> accept(const ScoreTable& table, const Trial& trial) {
    const auto effect = candidates_[trial.candidate].effect;
    EffectList effects = result_.effects;
    effects.push_back(effect);
    Proof proof;
    std::string reason = implausibility(*effect, trial.fit);
    if (reason.empty()) reason = objection(table, trial, effects, proof);
    auto settled = reason.empty() ? refit(trial.candidate, false) : std::nullopt;
    if (reason.empty() && !settled) reason = "the fit does not settle";
    const Score& score = table.scores()[trial.candidate];
    result_.considered.push_back(
        {effect->name(), score.statistic, score.family_p_value, reason.empty() ? "added" : reason});
    if (!reason.empty()) {
      strike(candidates_[trial.candidate].key);
      return std::nullopt;
    }
    result_.fit = std::move(settled->fit);
    result_.effects = std::move(effects);
    has_changed_ = true;
    return proof;
  }

  bool accept_name(const ScoreTable& table, const Trial& best) {
    const Candidate candidate = candidates_[best.candidate];
    const std::vector<std::string> aliases = aliases_of(table, best);
    const auto proof = accept(table, best);
    if (!proof) return true;
    result_.findings.push_back({candidate.effect, aliases, *proof});
    strike(candidate.key);
    retire_superfluous();
    return true;
  }

  bool accept_curve(const ScoreTable& table, std::size_t index) {
    if (result_.curves.size() >= kMaxCurves) return false;
    auto trial = refit(index, true);
    if (trial && spoils_base(*candidates_[index].effect, basis_, trial->fit)) trial = refit_centred(index);
    const Candidate candidate = candidates_[index];
    const auto law_of = completed_by(candidate);
    const std::vector<Variable> alike = alike_of(table, index);
    const auto proof = trial ? accept(table, *trial) : std::nullopt;
    if (!trial) strike(candidate.key);
    if (!proof) return true;
    result_.curves.push_back({candidate.effect, *candidate.curve, *proof, law_of, alike});
    strike(candidate.key);
    refine_newest_curve();
    doubt_zero_of_newest_curve();
    return true;
  }

  /// A law with a narrow peak needs more knots than finding it did.
  void refine_newest_curve() {
    AddedCurve& newest = result_.curves.back();
    const auto finer = refined(newest.curve, models());
    if (!finer) return;
    EffectList effects = result_.effects;
    effects.back() = make_curve_effect(*finer);
    auto fit = refit_with(effects, result_.fit);
    if (!fit || spoils_base(*effects.back(), result_.fit, *fit)) return;
    result_.doubts.emplace_back(fit->parameters.head<kBaseCount>() -
                                result_.fit.parameters.head<kBaseCount>());
    const auto more = basis_size(*finer) - basis_size(newest.curve);
    if (result_.fit.cost - fit->cost < penalty(more)) return;
    if (!(compared_on_held_out(result_.fit, result_.effects, *fit, effects, all_folds()).total > 0.0)) return;
    newest.curve = *finer;
    newest.effect = effects.back();
    result_.effects = std::move(effects);
    result_.fit = std::move(*fit);
  }

  /// A curve about its mean leaves the base the average of this drive; where its law would be zero, nobody
  /// knows.
  void doubt_zero_of_newest_curve() {
    const Curve& curve = result_.curves.back().curve;
    if (curve.mean.empty()) return;
    const auto count = static_cast<Eigen::Index>(basis_size(curve));
    const double spread = spread_of(curve, as_span(result_.fit.parameters.tail(count).eval()), models());
    Eigen::VectorXd doubt = Eigen::VectorXd::Zero(kBaseCount);
    for (const auto k : lengths_of(curve.law.carrier)) doubt(k) = spread * result_.fit.parameters(k);
    result_.doubts.push_back(doubt);
  }

  /// With another last effect, on the same noise.
  [[nodiscard]] std::optional<FitResult> refit_with(const EffectList& effects, const FitResult& fit) const {
    const auto count = static_cast<Eigen::Index>(kBaseCount + count_parameters(effects));
    const auto own = static_cast<Eigen::Index>(effects.back()->parameters().size());
    Eigen::VectorXd start = Eigen::VectorXd::Zero(count);
    start.head(count - own) = fit.parameters.head(count - own);
    FitOptions options;
    options.fixed = fixed(effects);
    options.noise = fit.noise;
    auto settled = fit_joint(data_, effects, start, options);
    return settled ? std::optional(std::move(settled).value()) : std::nullopt;
  }

  static FoldFlags all_folds() {
    FoldFlags flags;
    flags.fill(true);
    return flags;
  }

  /// Variables whose curves would have explained most of it too.
  [[nodiscard]] std::vector<Variable> alike_of(const ScoreTable& table, std::size_t index) const {
    constexpr double kMost = 0.6;  // of the statistic
    const Variable own = candidates_[index].curve->law.variable;
    std::vector<Variable> alike;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (!candidates_[k].curve || table.scores()[k].statistic < kMost * table.scores()[index].statistic)
        continue;
      const Variable other = candidates_[k].curve->law.variable;
      if (other != own && std::find(alike.begin(), alike.end(), other) == alike.end() &&
          table.correlation(index, k) > kAlias)
        alike.push_back(other);
    }
    return alike;
  }

  /// Where the drive cannot tell slow motion from the curve's mean, the curve is taken about its mean.
  std::optional<Trial> refit_centred(std::size_t index) {
    Candidate& candidate = candidates_[index];
    candidate.curve = centred(*candidate.curve, models());
    candidate.effect = make_curve_effect(*candidate.curve);
    return refit(index, true);
  }

  [[nodiscard]] std::vector<const DriveModel*> models() const {
    std::vector<const DriveModel*> all;
    for (const FitData& d : data_) all.push_back(d.model);
    return all;
  }

  /// The finding whose law this curve would replace, if any.
  [[nodiscard]] std::shared_ptr<const Effect> completed_by(const Candidate& candidate) const {
    for (const Finding& finding : result_.findings)
      if (contains(finding.effect->laws(), candidate.curve->law)) return finding.effect;
    return nullptr;
  }
  [[nodiscard]] bool completes(const Candidate& candidate) const {
    return completed_by(candidate) != nullptr;
  }

  /// A candidate that was added, or failed its proof, is not asked again; the search goes on with the others.
  void strike(const std::string& key) {
    for (Candidate& candidate : candidates_)
      if (candidate.key == key) candidate.struck = true;
  }

  /// What an earlier finding explained may belong to the one that was just added.
  void retire_superfluous() {
    std::size_t first = kBaseCount;
    for (std::size_t e = 0; e < result_.effects.size(); ++e) {
      const auto effect = result_.effects[e];
      const std::size_t count = effect->parameters().size();
      const auto finding = std::find_if(result_.findings.begin(), result_.findings.end(),
                                        [&](const Finding& f) { return f.effect == effect; });
      if (finding != result_.findings.end() && is_superfluous(*effect, first, result_.fit) &&
          remove(e, first, count)) {
        result_.findings.erase(finding);
        return;
      }
      first += count;
    }
  }

  bool remove(std::size_t index, std::size_t first, std::size_t count) {
    EffectList effects = result_.effects;
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(index));
    std::vector<Eigen::Index> kept;
    for (Eigen::Index k = 0; k < result_.fit.parameters.size(); ++k)
      if (k < static_cast<Eigen::Index>(first) || k >= static_cast<Eigen::Index>(first + count))
        kept.push_back(k);
    auto fit = fit_from(effects, result_.fit.parameters(kept), false);
    if (!fit) return false;
    result_.fit = std::move(*fit);
    result_.effects = std::move(effects);
    return true;
  }

  std::vector<std::string> aliases_of(const ScoreTable& table, const Trial& best) const {
    const Effect& effect = *candidates_[best.candidate].effect;
    std::vector<std::string> aliases = effect.always_alike();
    const auto add = [&](std::size_t k) {
      const std::string name = candidates_[k].effect->name();
      if (name != effect.name() && std::find(aliases.begin(), aliases.end(), name) == aliases.end())
        aliases.push_back(name);
    };
    for (const Trial& trial : trials_)
      if (best.gain - trial.gain < kAmbiguity) add(trial.candidate);
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (!candidates_[k].curve && table.scores()[k].family_p_value <= kNamedLevel &&
          too_close(table, best.candidate, k))
        add(k);
    return aliases;
  }

  /// The expected gap between the true and the wrong one is T (1 - rho^2).
  [[nodiscard]] bool too_close(const ScoreTable& table, std::size_t a, std::size_t b) const {
    const double rho = table.correlation(a, b);
    return rho > kAlias && table.scores()[a].statistic * (1.0 - rho * rho) < kTelling;
  }

  std::span<const FitData> data_;
  std::vector<bool> base_fixed_;
  std::function<void(double)> progress_;
  std::vector<Candidate> candidates_;
  std::optional<ScoreTable> table_;
  std::vector<Trial> trials_;  ///< refits on the model that the table belongs to
  bool has_changed_ = true;    ///< the model, since the table was made
  SearchResult result_;
  FitResult basis_;
};

}  // namespace

bool SearchResult::has_unnamed() const {
  return std::any_of(curves.begin(), curves.end(), [](const AddedCurve& c) { return c.law_of == nullptr; });
}

SearchResult search_effects(std::span<const FitData> data, const EffectList& given, const FitResult& fit,
                            const std::vector<bool>& base_fixed,
                            const std::function<void(double)>& progress) {
  return Search(data, given, fit, base_fixed, progress).run();
}

}  // namespace odomcalib::calib
