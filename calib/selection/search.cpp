#include "calib/selection/search.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "calib/math/number_text.hpp"
#include "calib/selection/backward_elimination.hpp"
#include "calib/selection/candidate.hpp"
#include "calib/selection/detectable.hpp"
#include "calib/selection/equivalent_models.hpp"
#include "calib/selection/hyperparameter_selection.hpp"
#include "calib/selection/hyperparameters.hpp"
#include "calib/selection/plausibility.hpp"
#include "calib/selection/rolling_waves.hpp"
#include "calib/selection/search_round.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"

namespace odomcalib::calib::selection {
namespace {

constexpr const char* kAdded = "added";
constexpr const char* kUnhelpful = "leaving out what it explains does as well";

class Search {
 public:
  Search(std::span<const measurement::FitData> data, const vehicle::EffectList& given,
         const estimation::FitResult& fit, const std::vector<bool>& base_fixed, const RuleSet& rules,
         const std::function<void(double)>& progress)
      : task_{data, base_fixed, rules},
        progress_(progress),
        candidates_(all_candidates(given, task_.models())) {
    result_.model = {given, fit};
  }

  SearchResult run() {
    run_steps(0.0, 0.5);
    propose_waves();
    run_steps(0.5, 1.0);
    eliminate_unhelpful_smooths();
    for (std::size_t e = 0; e < result_.model.effects.size(); ++e) {
      result_.model_uncertainties.push_back(
          uncertainty_of_extrapolation(task_, result_.model, parts_of_term(e)));
      add_model_uncertainties(uncertainties_of_shape(task_, result_.model, e));
    }
    add_model_uncertainties(unconfirmed_);
    report_what_has_grown();
    result_.detectable = smallest_detectable(task_, result_.model);
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool has(Rule rule) const { return task_.rules.has(rule); }

  /// The model that candidates are tested on.
  [[nodiscard]] const FittedModel& basis() const { return round_->basis(); }

  void add_model_uncertainties(const std::vector<Eigen::VectorXd>& model_uncertainties) {
    result_.model_uncertainties.insert(result_.model_uncertainties.end(), model_uncertainties.begin(),
                                       model_uncertainties.end());
  }

  /// Places in the model of an effect and of the smooth terms that make one term with it.
  [[nodiscard]] std::vector<std::size_t> parts_of_term(std::size_t index) const {
    std::vector<std::size_t> parts{index};
    const vehicle::EffectList& effects = result_.model.effects;
    for (const AddedSmoothTerm& added : result_.smooths) {
      const vehicle::Dependence signed_dependence{added.smooth.dependence.covariate,
                                                  signed_counterpart(added.smooth.dependence.channel)};
      if (added.effect == effects[index] || !contains(effects[index]->dependences(), signed_dependence))
        continue;
      parts.push_back(static_cast<std::size_t>(std::find(effects.begin(), effects.end(), added.effect) -
                                               effects.begin()));
    }
    return parts;
  }

  /// @param from, to shares of the whole search
  void run_steps(double from, double to) {
    for (int step = 0; step < settings::kMostSteps; ++step) {
      progress_(from + (to - from) * step / settings::kMostSteps);
      if (!advance()) break;
    }
  }

  /// One step; false when nothing more is justified.
  bool advance() {
    if (has_changed_) rescore();
    const auto smooth = best_smooth(*round_);
    const auto name = may_add_name() ? best_name_beside(smooth, *round_, result_) : std::nullopt;
    if (const auto late = name ? unnoticed_clock(*name) : std::nullopt; late && has(Rule::clock_before_name))
      return accept_name(*late);
    if (name && accept_name(*name)) return true;
    return smooth && accept_smooth(*smooth);
  }

  /// A millisecond between the clocks is not worth reporting, but passes for play or for slip.
  [[nodiscard]] std::optional<Trial> unnoticed_clock(const Trial& name) const {
    if (is_clock(candidates_[name.candidate])) return std::nullopt;
    const auto clocks = round_->by_score([&](std::size_t k) { return is_clock(candidates_[k]); });
    auto clock = clocks.empty() ? std::nullopt : round_->refit(clocks.front());
    if (!clock || !is_plain_but_small(candidates_[clocks.front()], clock->model.fit)) return std::nullopt;
    const double by_clock = basis().fit.cost - clock->model.fit.cost;
    const bool is_much = by_clock > settings::kClockShareOfName * (basis().fit.cost - name.model.fit.cost);
    return is_much ? std::move(clock) : std::nullopt;
  }

  /// Waves along the floor or of something that rolls, when nothing else is left to say.
  void propose_waves() {
    candidates_ = floor_waves(task_.models());
    for (const Candidate& wave : rolling_waves(task_.data, result_.model)) candidates_.push_back(wave);
    replace_candidates();
  }

  /// With other candidates.
  void replace_candidates() {
    round_.reset();
    has_changed_ = true;
  }

  /// Scores of all that is left, on the model as it is now.
  void rescore() {
    std::erase_if(candidates_, [](const Candidate& c) { return c.excluded; });
    round_.emplace(task_,
                   FittedModel{result_.model.effects,
                               widened_where_outlying(task_, result_.model, settings::kNoiseShare)},
                   candidates_);
    has_changed_ = false;
  }

  [[nodiscard]] bool may_add_name() const {
    return (result_.findings.size() < settings::kMostFindings || !has(Rule::few_terms)) &&
           !(result_.has_unnamed() && has(Rule::names_before_smooth_terms));
  }

  [[nodiscard]] std::string implausibility(const Candidate& candidate,
                                           const estimation::FitResult& fit) const {
    const vehicle::Effect& effect = *candidate.effect;
    if (candidate.smooth && is_sway(*candidate.smooth) &&
        is_hidden_by_ticks(*candidate.smooth, fit, task_.models()) && has(Rule::sway_above_ticks))
      return "ticks so far apart hide as much";
    if (auto reason = impossibility(effect, fit); !reason.empty() && has(Rule::physical_range)) return reason;
    if (is_negligible(effect, fit) && has(Rule::size_that_matters)) return "too small to matter";
    if (auto reason = contradiction(effect, fit); !reason.empty() && has(Rule::no_contradiction))
      return reason;
    const bool spoils = spoils_base(effect, basis().fit, fit) && has(Rule::base_determined);
    return spoils ? "this drive cannot separate it from the wheels" : "";
  }

  /// Too small to be reported, not too small to have moved the lengths.
  [[nodiscard]] bool is_plain_but_small(const Candidate& candidate, const estimation::FitResult& fit) const {
    return is_negligible(*candidate.effect, fit) && !spoils_base(*candidate.effect, basis().fit, fit);
  }

  /// Adds the candidate if it is plausible and passes cross-validation; otherwise excludes it.
  std::optional<CrossValidation> accept(const Trial& trial) {
    const Candidate& candidate = candidates_[trial.candidate];
    const Score& score = round_->score(trial.candidate);
    CrossValidation validation;
    validation.family_p_value = score.family_p_value;
    std::optional<Trial> settled;
    std::string reason = implausibility(candidate, trial.model.fit);
    const Eigen::VectorXd change = trial.model.base() - basis().base();
    const bool is_small = is_plain_but_small(candidate, trial.model.fit);
    if (is_small && !candidate.smooth && is_clock(candidate) && has(Rule::unnamed_clock))
      return keep_as_nuisance(trial, reason);
    if (is_small) result_.model_uncertainties.push_back(change);
    if (reason.empty()) {
      reason = failure(trial, validation, settled);
      const bool is_plain = !candidate.smooth || score.family_p_value <= settings::kNamedLevel;
      if (!reason.empty() && is_plain) {
        unconfirmed_.push_back(change);
        if (candidate.smooth)
          unconfirmed_.push_back(uncertainty_of_zero(task_, trial.model, *candidate.smooth));
      }
    }
    consider(trial, reason.empty() ? kAdded : reason);
    exclude(candidate.key);
    if (!reason.empty()) return std::nullopt;
    adopt(std::move(settled->model));
    return validation;
  }

  void consider(const Trial& trial, const std::string& outcome) {
    const Score& score = round_->score(trial.candidate);
    const Candidate& candidate = candidates_[trial.candidate];
    Considered one{candidate.effect->name(), score.statistic, score.family_p_value, outcome};
    if (candidate.smooth) {
      one.depends_on = covariates_like(candidates_, round_->table(), trial.candidate);
      one.depends_on.insert(one.depends_on.begin(), candidate.smooth->dependence.covariate);
    }
    result_.considered.push_back(std::move(one));
  }

  /// With what was added later a nuisance effect may have become one that matters.
  void report_what_has_grown() {
    const FittedModel& model = result_.model;
    for (std::size_t e = 0; e < model.effects.size(); ++e)
      if (const auto first = static_cast<std::size_t>(first_parameter(model.effects, e));
          !is_negligible(*model.effects[e], first, model.fit))
        std::erase(result_.nuisance, model.effects[e]);
  }

  /// Stays in the model unnamed: a millisecond matters to nobody, but left out it would look like slip.
  std::optional<CrossValidation> keep_as_nuisance(const Trial& trial, const std::string& reason) {
    consider(trial, reason);
    exclude(candidates_[trial.candidate].key);
    result_.nuisance.push_back(candidates_[trial.candidate].effect);
    const auto settled = round_->refit(trial.candidate, {});
    adopt(settled ? settled->model : trial.model);
    return std::nullopt;
  }

  /// Whether what lies outside each fold points to the candidate, in whichever of its shapes.
  [[nodiscard]] validation::FoldFlags selected_without_fold(std::size_t candidate) const {
    std::vector<std::size_t> shapes;
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (candidates_[k].key == candidates_[candidate].key) shapes.push_back(k);
    return round_->table().selected_without(shapes, settings::kFoldLevel);
  }

  /// How the trial fails cross-validation; empty when it does not.
  /// @param settled the trial on its own noise then
  std::string failure(const Trial& trial, CrossValidation& validation, std::optional<Trial>& settled) {
    validation::FoldFlags selected = selected_without_fold(trial.candidate);
    if (selected != validation::all_folds() && !has(Rule::choice_held_out))
      selected = validation::all_folds();
    std::string reason = objection(task_, basis(), trial.model, selected, validation);
    if (!reason.empty()) return reason;
    if (may_be_chance(candidates_[trial.candidate], validation) && has(Rule::gain_in_most_drives)) {
      if (!has_drives(validation))
        return "may be chance, and the reference is too broken for drives to prove it";
      return "a gain that may be chance: error times " + math::five_characters(validation.improvement.ratio);
    }
    settled = round_->refit(trial.candidate, {});
    if (!settled) return "the fit does not settle";
    const bool is_followed = odometry_uses(candidates_[trial.candidate]);
    const DriveChange drives = change_of_drives(task_, basis(), settled->model);
    const bool is_worse = drives.is_spoilt || (is_followed && drives.ratio.value_or(0.0) > 1.0);
    return is_worse && has(Rule::drives_not_worse) ? "drives get worse" : "";
  }

  /// Whether it was cross-validated on drives of ten seconds, not on single pairs.
  static bool has_drives(const CrossValidation& validation) { return validation.before > 0.0; }

  /// A smooth term that odometry follows. What folds that do not point to it make of it counts too: the next
  /// drive may be like them. An error that comes back with each turn of a wheel cancels over ten seconds,
  /// however plain in between.
  static bool odometry_uses(const Candidate& candidate) {
    return candidate.smooth && candidate.effect->storage() == vehicle::Storage::host &&
           !is_phase(candidate.smooth->dependence.covariate);
  }

  /// A smooth term that odometry would use must show its gain over ten seconds; where the reference is too
  /// broken for that, its score must be decisive.
  [[nodiscard]] bool may_be_chance(const Candidate& candidate, const CrossValidation& validation) const {
    if (!odometry_uses(candidate) || result_.owner_of(candidate.smooth->dependence)) return false;
    return has_drives(validation) ? !validation.improvement.is_plain()
                                  : validation.family_p_value > settings::kNamedLevel;
  }

  void adopt(FittedModel model) {
    result_.model = std::move(model);
    mark_changed();
  }

  /// All that odometry would follow and that has no name, or none.
  void eliminate_unhelpful_smooths() {
    FittedModel without = result_.model;
    std::vector<AddedSmoothTerm> followed;
    for (const AddedSmoothTerm& added : result_.smooths) {
      if (added.named_term || !odometry_uses(candidate_of(added.smooth))) continue;
      const auto place = std::find(without.effects.begin(), without.effects.end(), added.effect);
      auto fewer =
          without_effect(task_, without, static_cast<std::size_t>(place - without.effects.begin()), {});
      if (!fewer) return;
      without = std::move(*fewer);
      followed.push_back(added);
    }
    if (followed.empty() || !explain_too_little(task_, result_.model, without) ||
        !has(Rule::enough_explained))
      return;
    result_.model = std::move(without);
    for (const AddedSmoothTerm& added : followed) withdraw(added);
  }

  void withdraw(const AddedSmoothTerm& smooth) {
    result_.forget(smooth.effect);
    for (Considered& one : result_.considered)
      if (one.name == smooth.effect->name() && one.outcome == kAdded) one.outcome = kUnhelpful;
  }

  /// From the model as it is now.
  void mark_changed() {
    has_changed_ = true;
    unconfirmed_.clear();
  }

  /// A term that can bend much should leave nothing to a free one.
  [[nodiscard]] std::optional<std::size_t> better_smooth(const Trial& name) const {
    const auto& effect = candidates_[name.candidate].effect;
    if (has_textbook_shape(effect)) return std::nullopt;
    const auto& dependences = effect->dependences();
    const auto smooths = round_->by_score([&](std::size_t k) {
      const auto& smooth = candidates_[k].smooth;
      return smooth && passes(k, *round_) && contains(dependences, smooth->dependence);
    });
    if (smooths.empty()) return std::nullopt;
    const std::size_t last = name.model.effects.size() - 1;
    const auto free = free_alternative_to(task_, name.model, last, candidates_[smooths.front()]);
    return free && has(Rule::name_against_smooth_term) ? std::optional(smooths.front()) : std::nullopt;
  }

  bool accept_name(const Trial& best) {
    if (const auto smooth = better_smooth(best)) return accept_smooth(*smooth);
    const Candidate candidate = candidates_[best.candidate];
    const std::vector<std::size_t> competitors = round_->competitors_of(best);
    const std::vector<std::string> aliases = aliases_among(candidates_, best.candidate, competitors);
    const auto validation = accept(best);
    if (!validation) return true;
    result_.findings.push_back({candidate.effect, aliases, *validation});
    exclude_what_is_covered_by(*candidate.effect);
    add_model_uncertainties(round_->model_uncertainties_of(competitors, best));
    drop_superfluous();
    return true;
  }

  bool accept_smooth(std::size_t index) {
    if (result_.smooths.size() >= settings::kMostSmooths && has(Rule::few_terms)) return false;
    auto trial = happens_at_once(*candidates_[index].smooth)
                     ? refit_as(index, at_likeliest_change_point(task_, basis(), *candidates_[index].smooth))
                     : round_->refit(index);
    if (trial && is_held_back(*candidates_[index].effect, trial->model.fit) && has(Rule::larger_prior))
      trial = refit_as(index, strong(*candidates_[index].smooth));
    if (trial && may_be_centred(*candidates_[index].smooth) &&
        smooth_spoils_base(*candidates_[index].effect, basis().fit, trial->model.fit) &&
        has(Rule::centred_term))
      trial = refit_as(index, centred(*candidates_[index].smooth, task_.models()));
    const auto named_term = result_.owner_of(candidates_[index].smooth->dependence);
    const std::vector<vehicle::Covariate> alike = covariates_like(candidates_, round_->table(), index);
    if (!trial) {
      exclude(candidates_[index].key);
      return true;
    }
    auto validation = accept(*trial);
    const bool may_replace =
        named_term && !result_.is_completed(named_term) && !happens_at_once(*candidates_[index].smooth);
    if (!validation && may_replace && has(Rule::smooth_term_for_name)) replace(named_term, index, alike);
    if (!validation && !named_term && has(Rule::other_shape)) validation = accept_reshaped(index);
    if (!validation) return true;
    const Candidate& candidate = candidates_[index];
    result_.smooths.push_back({candidate.effect, *candidate.smooth, *validation, named_term, alike});
    select_hyperparameters_of_newest(task_, result_);
    exclude_what_is_covered_by(*result_.smooths.back().effect);
    drop_superfluous();
    return true;
  }

  void exclude_what_is_covered_by(const vehicle::Effect& found) {
    for (Candidate& candidate : candidates_)
      if (candidate.smooth && found.excludes(candidate.smooth->dependence) && has(Rule::exclusions))
        candidate.excluded = true;
  }

  /// A term that predicts nothing in the shape that it was found in, too coarse for it, may in another.
  std::optional<CrossValidation> accept_reshaped(std::size_t index) {
    Candidate& candidate = candidates_[index];
    if (terms::basis_as<terms::Wave>(*candidate.smooth)) return std::nullopt;
    auto best = in_best_shape(task_, basis(), *candidate.smooth, basis().fit.noise);
    if (best && is_held_back(*best->model.effects.back(), best->model.fit) && has(Rule::larger_prior))
      best = in_best_shape(task_, basis(), strong(*candidate.smooth), basis().fit.noise);
    if (!best || best->smooth == *candidate.smooth) return std::nullopt;
    candidate.smooth = std::move(best->smooth);
    candidate.effect = best->model.effects.back();
    return accept(Trial{index, std::move(best->model)});
  }

  /// A free term that cannot stand beside the name's, but does better in its place, shows that the name was
  /// wrong.
  void replace(const std::shared_ptr<const vehicle::Effect>& name, std::size_t candidate,
               const std::vector<vehicle::Covariate>& alike) {
    const auto& effects = result_.model.effects;
    const auto place = std::find(effects.begin(), effects.end(), name) - effects.begin();
    auto free =
        free_alternative_to(task_, result_.model, static_cast<std::size_t>(place), candidates_[candidate]);
    if (!free) return;
    free->validation.family_p_value = round_->score(candidate).family_p_value;
    result_.forget(name);
    adopt(free->dependence.model);
    result_.considered.back().outcome = "took the place of " + name->name();
    result_.smooths.push_back(
        {result_.model.effects.back(), free->dependence.smooth, free->validation, nullptr, alike});
    select_hyperparameters_of_newest(task_, result_);
  }

  /// An error that an earlier finding or smooth term explained may belong to what was just added.
  void drop_superfluous() {
    if (has(Rule::backward_elimination) && eliminate_superfluous(task_, schwarz(basis().fit), result_))
      mark_changed();
  }

  /// Larger than usual if the data insist; about its mean where the drive cannot separate that from slow
  /// motion.
  std::optional<Trial> refit_as(std::size_t index, const terms::SmoothTerm& smooth) {
    candidates_[index].smooth = smooth;
    candidates_[index].effect = make_smooth_term_effect(smooth);
    return round_->refit(index);
  }

  /// A candidate that was added, or failed cross-validation, is not tried again; the search goes on with the
  /// others.
  void exclude(const std::string& key) {
    for (Candidate& candidate : candidates_)
      if (candidate.key == key) candidate.excluded = true;
  }

  FitTask task_;
  std::function<void(double)> progress_;
  std::vector<Candidate> candidates_;
  std::optional<SearchRound> round_;
  bool has_changed_ = true;  ///< the model or the candidates, since the round began
  SearchResult result_;
  /// Changes of the base parameters by plausible names and plain smooth terms that the last model could
  /// neither show nor rule out.
  std::vector<Eigen::VectorXd> unconfirmed_;
};

}  // namespace

SearchResult search_effects(std::span<const measurement::FitData> data, const vehicle::EffectList& given,
                            const estimation::FitResult& fit, const std::vector<bool>& base_fixed,
                            const RuleSet& rules, const std::function<void(double)>& progress) {
  return Search(data, given, fit, base_fixed, rules, progress).run();
}

}  // namespace odomcalib::calib::selection
