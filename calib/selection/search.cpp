#include "calib/selection/search.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "calib/selection/candidate.hpp"
#include "calib/selection/detectable.hpp"
#include "calib/selection/law_shape.hpp"
#include "calib/selection/likeness.hpp"
#include "calib/selection/moment.hpp"
#include "calib/selection/next_addition.hpp"
#include "calib/selection/outlier_trace.hpp"
#include "calib/selection/plausibility.hpp"
#include "calib/selection/retirement.hpp"
#include "calib/selection/rolling_waves.hpp"
#include "calib/selection/search_round.hpp"
#include "calib/selection/settings.hpp"
#include "calib/selection/settled_shape.hpp"
#include "calib/selection/vain_curves.hpp"
#include "calib/selection/wrong_name.hpp"
#include "calib/terms/curve_effect.hpp"
#include "calib/terms/curve_on_drives.hpp"

namespace odomcalib::calib::selection {
namespace {

constexpr double kNoiseShare = 0.95;  ///< of pairs that a usual effect does not touch much
constexpr std::size_t kMaxFindings = 3;
constexpr std::size_t kMaxCurves = 4;
constexpr int kMaxSteps = 12;  ///< additions and failed proofs together
constexpr const char* kAdded = "added";
constexpr const char* kInVain = "leaving out what it explains does as well";

class Search {
 public:
  Search(std::span<const measurement::FitData> data, const vehicle::EffectList& given,
         const estimation::FitResult& fit, const std::vector<bool>& base_fixed,
         const std::function<void(double)>& progress)
      : task_{data, base_fixed}, progress_(progress), candidates_(all_candidates(given, task_.models())) {
    result_.model = {given, fit};
  }

  SearchResult run() {
    go_on(0.0, 0.4);
    ask_the_outliers();
    ask_for_waves();
    go_on(0.5, 1.0);
    leave_out_vain_curves();
    for (std::size_t e = 0; e < result_.model.effects.size(); ++e) {
      result_.doubts.push_back(doubt_of_extrapolation(task_, result_.model, law_with(e)));
      add_doubts(doubts_of_shape(task_, result_.model, e));
    }
    add_doubts(unproved_);
    tell_what_has_grown();
    result_.detectable = smallest_detectable(task_, result_.model);
    return std::move(result_);
  }

 private:
  /// That candidates are tested on.
  [[nodiscard]] const FittedModel& basis() const { return round_->basis(); }

  void add_doubts(const std::vector<Eigen::VectorXd>& doubts) {
    result_.doubts.insert(result_.doubts.end(), doubts.begin(), doubts.end());
  }

  /// Places in the model of an effect and of the curves that make one law with it.
  [[nodiscard]] std::vector<std::size_t> law_with(std::size_t index) const {
    std::vector<std::size_t> law{index};
    const vehicle::EffectList& effects = result_.model.effects;
    for (const AddedCurve& added : result_.curves) {
      const vehicle::Law signed_law{added.curve.law.variable, signed_counterpart(added.curve.law.carrier)};
      if (added.effect == effects[index] || !contains(effects[index]->laws(), signed_law)) continue;
      law.push_back(static_cast<std::size_t>(std::find(effects.begin(), effects.end(), added.effect) -
                                             effects.begin()));
    }
    return law;
  }

  /// @param from, to shares of the whole search
  void go_on(double from, double to) {
    for (int step = 0; step < kMaxSteps; ++step) {
      progress_(from + (to - from) * step / kMaxSteps);
      if (!advance()) break;
    }
  }

  /// One step; false when nothing more is justified.
  bool advance() {
    if (has_changed_) look_again();
    const auto curve = best_curve(*round_, result_);
    const auto name = may_name() ? best_name_beside(curve, *round_, result_) : std::nullopt;
    if (const auto late = name ? unnoticed_clock(*name) : std::nullopt) return accept_name(*late);
    if (name && accept_name(*name)) return true;
    const auto clock = curve && depends_on_history(candidates_[*curve]) ? best_clock(*round_) : std::nullopt;
    if (clock) return accept_name(*clock);
    return curve && accept_curve(*curve);
  }

  /// A millisecond between the clocks is nothing to tell, but passes for play or for slip.
  [[nodiscard]] std::optional<Trial> unnoticed_clock(const Trial& name) const {
    constexpr double kMuch = 0.9;  // of what the name explains
    if (is_clock(candidates_[name.candidate])) return std::nullopt;
    const auto clocks = round_->by_score([&](std::size_t k) { return is_clock(candidates_[k]); });
    auto clock = clocks.empty() ? std::nullopt : round_->refit(clocks.front());
    if (!clock || !is_plain_but_small(candidates_[clocks.front()], clock->model.fit)) return std::nullopt;
    const double by_clock = basis().fit.cost - clock->model.fit.cost;
    const bool is_much = by_clock > kMuch * (basis().fit.cost - name.model.fit.cost);
    return is_much ? std::move(clock) : std::nullopt;
  }

  /// What happens so seldom that the fit leaves its pairs out no score sees, until they count as noise.
  void ask_the_outliers() {
    const auto trace = trace_outliers(task_.data, result_.model.fit);
    if (!trace) return;
    const auto goes_with = [&](const vehicle::Law& law) {
      return !belongs_to_the_place(law.variable) &&
             std::count(trace->depends_on.begin(), trace->depends_on.end(), law.variable) > 0;
    };
    std::erase_if(candidates_, [&](const Candidate& c) {
      const auto laws = laws_of(c);
      return std::none_of(laws.begin(), laws.end(), goes_with);
    });
    if (candidates_.empty()) return;
    noise_share_ = 1.0 - 0.5 * static_cast<double>(trace->outliers) / static_cast<double>(trace->pairs);
    begin_again();
    go_on(0.4, 0.5);
    noise_share_ = kNoiseShare;
  }

  /// What repeats itself along the floor or as something rolls, when nothing else is left to say.
  void ask_for_waves() {
    candidates_ = floor_waves(task_.models());
    for (const Candidate& wave : rolling_waves(task_.data, result_.model)) candidates_.push_back(wave);
    begin_again();
  }

  /// With other candidates.
  void begin_again() {
    round_.reset();
    has_changed_ = true;
    no_more_curves_ = false;
  }

  /// Waves are many, and what was nothing before one of them was found is not asked again.
  void strike_hopeless_waves() {
    constexpr double kHopeless = 0.05;  // family-wise
    for (std::size_t k = 0; round_ && k < candidates_.size(); ++k)
      if (candidates_[k].curve && terms::basis_as<terms::Wave>(*candidates_[k].curve) &&
          round_->score(k).family_p_value > kHopeless)
        candidates_[k].struck = true;
  }

  /// Scores of all that is left, on the model as it is now.
  void look_again() {
    strike_hopeless_waves();
    std::erase_if(candidates_, [](const Candidate& c) { return c.struck; });
    round_.emplace(
        task_, FittedModel{result_.model.effects, widened_where_outlying(task_, result_.model, noise_share_)},
        candidates_);
    has_changed_ = false;
  }

  [[nodiscard]] bool may_name() const {
    return result_.findings.size() < kMaxFindings && !result_.has_unnamed();
  }

  [[nodiscard]] std::string implausibility(const Candidate& candidate,
                                           const estimation::FitResult& fit) const {
    const vehicle::Effect& effect = *candidate.effect;
    if (candidate.curve && is_sway(*candidate.curve) &&
        is_hidden_by_ticks(*candidate.curve, fit, task_.models()))
      return "ticks so far apart hide as much";
    if (auto reason = impossibility(effect, fit); !reason.empty()) return reason;
    if (is_negligible(effect, fit)) return "too small to matter";
    if (auto reason = contradiction(effect, fit); !reason.empty()) return reason;
    const bool spoils =
        candidate.curve ? curve_spoils_base(effect, basis().fit, fit) : spoils_base(effect, basis().fit, fit);
    return spoils ? "this drive cannot tell it from the wheels" : "";
  }

  /// Too small to be told, not too small to have moved the lengths.
  [[nodiscard]] bool is_plain_but_small(const Candidate& candidate, const estimation::FitResult& fit) const {
    return is_negligible(*candidate.effect, fit) && !spoils_base(*candidate.effect, basis().fit, fit);
  }

  /// Adds the candidate if it is plausible and proves itself; otherwise strikes it off the list.
  std::optional<Proof> accept(const Trial& trial) {
    const Candidate& candidate = candidates_[trial.candidate];
    const Score& score = round_->score(trial.candidate);
    Proof proof;
    proof.family_p_value = score.family_p_value;
    std::optional<Trial> settled;
    std::string reason = implausibility(candidate, trial.model.fit);
    const Eigen::VectorXd change = trial.model.base() - basis().base();
    const bool is_small = is_plain_but_small(candidate, trial.model.fit);
    if (is_small && !candidate.curve && is_clock(candidate)) return keep_quietly(trial, reason);
    if (is_small) result_.doubts.push_back(change);
    if (reason.empty()) {
      reason = failure(trial, proof, settled);
      const bool is_plain = !candidate.curve || score.family_p_value <= settings::kNamedLevel;
      if (!reason.empty() && is_plain) {
        unproved_.push_back(change);
        if (candidate.curve) unproved_.push_back(doubt_of_zero(task_, trial.model, *candidate.curve));
      }
    }
    consider(trial, reason.empty() ? kAdded : reason);
    strike(candidate.key);
    if (!reason.empty()) return std::nullopt;
    adopt(std::move(settled->model));
    return proof;
  }

  void consider(const Trial& trial, const std::string& outcome) {
    const Score& score = round_->score(trial.candidate);
    const Candidate& candidate = candidates_[trial.candidate];
    Considered one{candidate.effect->name(), score.statistic, score.family_p_value, outcome};
    if (candidate.curve) {
      one.depends_on = variables_like(candidates_, round_->table(), trial.candidate);
      one.depends_on.insert(one.depends_on.begin(), candidate.curve->law.variable);
    }
    result_.considered.push_back(std::move(one));
  }

  /// With what was added later a quiet effect may have become one that matters.
  void tell_what_has_grown() {
    const FittedModel& model = result_.model;
    for (std::size_t e = 0; e < model.effects.size(); ++e)
      if (const auto first = static_cast<std::size_t>(first_parameter(model.effects, e));
          !is_negligible(*model.effects[e], first, model.fit))
        std::erase(result_.quiet, model.effects[e]);
  }

  /// Stays in the model unnamed: a millisecond matters to nobody, but left out it would look like slip.
  std::optional<Proof> keep_quietly(const Trial& trial, const std::string& reason) {
    consider(trial, reason);
    strike(candidates_[trial.candidate].key);
    result_.quiet.push_back(candidates_[trial.candidate].effect);
    const auto settled = round_->refit(trial.candidate, {});
    adopt(settled ? settled->model : trial.model);
    return std::nullopt;
  }

  /// Whether what lies outside each fold points to the candidate, in whichever of its shapes.
  [[nodiscard]] FoldFlags selected_without_fold(std::size_t candidate) const {
    FoldFlags selected{};
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (candidates_[k].key != candidates_[candidate].key) continue;
      const FoldFlags of_shape = round_->table().selected_without(k, settings::kFoldLevel);
      for (std::size_t fold = 0; fold < selected.size(); ++fold) selected[fold] |= of_shape[fold];
    }
    return selected;
  }

  /// How the trial fails its proof; empty when it does not.
  /// @param settled the trial on its own noise then
  std::string failure(const Trial& trial, Proof& proof, std::optional<Trial>& settled) {
    const FoldFlags selected = selected_without_fold(trial.candidate);
    std::string reason =
        objection(task_, basis(), trial.model, selected, largest_ratio(candidates_[trial.candidate]), proof);
    if (!reason.empty()) return reason;
    if (may_be_chance(candidates_[trial.candidate], proof)) {
      no_more_curves_ = true;
      if (!has_drives(proof)) return "may be chance, and the reference is too broken for drives to prove it";
      return "a gain that may be chance: error times " + std::to_string(proof.improvement.ratio).substr(0, 5);
    }
    settled = round_->refit(trial.candidate, {});
    if (!settled) return "the fit does not settle";
    const bool is_followed = odometry_uses(candidates_[trial.candidate]);
    const DriveChange drives = change_of_drives(task_, basis(), settled->model);
    if (drives.is_spoilt || (is_followed && drives.ratio.value_or(0.0) > 1.0)) return "drives get worse";
    return is_followed && is_worse_than(result_.model, settled->model) ? kInVain : "";
  }

  /// With noise wide enough for what is systematic the plain model has moved as well. A curve that stands for
  /// a few motions which a robust fit would have left out must not cost the others what that fit gives them.
  [[nodiscard]] bool is_worse_than(const FittedModel& before, const FittedModel& after) const {
    const DriveChange drives = change_of_drives(task_, before, after);
    return drives.is_spoilt || drives.ratio.value_or(0.0) > 1.0;
  }

  /// Whether the proof is one of drives of ten seconds, not of single pairs.
  static bool has_drives(const Proof& proof) { return proof.before > 0.0; }

  /// A curve that odometry follows. What folds that do not point to it make of it counts too: the next drive
  /// may be like them.
  static bool odometry_uses(const Candidate& candidate) {
    return candidate.curve && candidate.effect->storage() == vehicle::Storage::host &&
           std::isfinite(largest_ratio(candidate));
  }

  /// Of a curve that odometry would use, whose gain must show over ten seconds; where the reference is too
  /// broken for that, its score must leave no doubt. A reference that errs with the motion, as in a nearly
  /// round room, asks for one curve after the other: where the best is none, no other is.
  [[nodiscard]] bool may_be_chance(const Candidate& candidate, const Proof& proof) const {
    if (!odometry_uses(candidate) || result_.owner_of(candidate.curve->law)) return false;
    return has_drives(proof) ? !proof.improvement.is_plain() : proof.family_p_value > settings::kNamedLevel;
  }

  void adopt(FittedModel model) {
    result_.model = std::move(model);
    start_again();
  }

  /// All that odometry would follow and that has no name, or none.
  void leave_out_vain_curves() {
    FittedModel without = result_.model;
    std::vector<AddedCurve> followed;
    for (const AddedCurve& added : result_.curves) {
      if (added.law_of || !odometry_uses(candidate_of(added.curve))) continue;
      const auto place = std::find(without.effects.begin(), without.effects.end(), added.effect);
      auto fewer =
          without_effect(task_, without, static_cast<std::size_t>(place - without.effects.begin()), {});
      if (!fewer) return;
      without = std::move(*fewer);
      followed.push_back(added);
    }
    if (followed.empty() || !explain_too_little(task_, result_.model, without)) return;
    result_.model = std::move(without);
    for (const AddedCurve& added : followed) withdraw(added);
  }

  void withdraw(const AddedCurve& curve) {
    result_.forget(curve.effect);
    for (Considered& one : result_.considered)
      if (one.name == curve.effect->name() && one.outcome == kAdded) one.outcome = kInVain;
  }

  /// From the model as it is now.
  void start_again() {
    has_changed_ = true;
    no_more_curves_ = false;
    unproved_.clear();
  }

  /// A law that can bend much should leave nothing to a free one.
  [[nodiscard]] std::optional<std::size_t> better_curve(const Trial& name) const {
    const auto& effect = candidates_[name.candidate].effect;
    if (has_textbook_shape(effect)) return std::nullopt;
    const std::vector<vehicle::Law> laws = effect->laws();
    const auto curves = round_->by_score([&](std::size_t k) {
      const auto& curve = candidates_[k].curve;
      return curve && passes(k, *round_, result_) && contains(laws, curve->law);
    });
    if (curves.empty()) return std::nullopt;
    const std::size_t last = name.model.effects.size() - 1;
    const auto free = free_law_instead_of(task_, name.model, last, candidates_[curves.front()]);
    return free ? std::optional(curves.front()) : std::nullopt;
  }

  /// What seems to have changed bit by bit may have changed at once.
  [[nodiscard]] std::optional<std::size_t> better_event(const Trial& name) const {
    const std::vector<vehicle::Law> laws = candidates_[name.candidate].effect->laws();
    const bool goes_with_time = std::any_of(laws.begin(), laws.end(), [](const vehicle::Law& law) {
      return law.variable == vehicle::Variable::time;
    });
    return goes_with_time ? event_instead_of(task_, *round_, name) : std::nullopt;
  }

  bool accept_name(const Trial& best) {
    if (const auto curve = better_curve(best)) return accept_curve(*curve);
    if (const auto event = better_event(best)) return accept_curve(*event);
    const Candidate candidate = candidates_[best.candidate];
    const std::vector<std::size_t> rivals = round_->rivals_of(best);
    const std::vector<std::string> aliases = aliases_among(candidates_, best.candidate, rivals);
    const auto proof = accept(best);
    if (!proof) return true;
    result_.findings.push_back({candidate.effect, aliases, *proof});
    strike_what_is_excluded_by(*candidate.effect);
    add_doubts(round_->doubts_of(rivals, best));
    drop_superfluous();
    return true;
  }

  bool accept_curve(std::size_t index) {
    if (no_more_curves_ || result_.curves.size() >= kMaxCurves) return false;
    auto trial = happens_at_once(*candidates_[index].curve)
                     ? refit_as(index, at_likeliest_moment(task_, basis(), *candidates_[index].curve))
                     : round_->refit(index);
    if (trial && is_held_back(*candidates_[index].effect, trial->model.fit))
      trial = refit_as(index, strong(*candidates_[index].curve));
    if (trial && may_be_centred(*candidates_[index].curve) &&
        curve_spoils_base(*candidates_[index].effect, basis().fit, trial->model.fit))
      trial = refit_as(index, centred(*candidates_[index].curve, task_.models()));
    const auto law_of = result_.owner_of(candidates_[index].curve->law);
    const std::vector<vehicle::Variable> alike = variables_like(candidates_, round_->table(), index);
    if (!trial) {
      strike(candidates_[index].key);
      return true;
    }
    const SearchResult before = result_;
    auto proof = accept(*trial);
    const bool may_replace =
        law_of && !result_.is_completed(law_of) && !happens_at_once(*candidates_[index].curve);
    if (!proof && may_replace) replace(law_of, index, alike);
    if (!proof && !law_of) proof = accept_reshaped(index);
    if (!proof) return true;
    const Candidate& candidate = candidates_[index];
    result_.curves.push_back({candidate.effect, *candidate.curve, *proof, law_of, alike});
    settle_shape_of_newest_curve(task_, result_);
    if (odometry_uses(candidate) && is_worse_than(before.model, result_.model)) {
      go_back_to(before);
      return true;
    }
    strike_what_is_excluded_by(*result_.curves.back().effect);
    drop_superfluous();
    return true;
  }

  /// What was added proved itself, but not as it settled.
  void go_back_to(SearchResult before) {
    before.considered = std::move(result_.considered);
    before.considered.back().outcome = kInVain;
    result_ = std::move(before);
    start_again();
  }

  void strike_what_is_excluded_by(const vehicle::Effect& found) {
    for (Candidate& candidate : candidates_)
      if (candidate.curve && found.excludes(candidate.curve->law)) candidate.struck = true;
  }

  /// A law that foretells nothing in the shape that it was found in, too coarse for it, may in another.
  std::optional<Proof> accept_reshaped(std::size_t index) {
    Candidate& candidate = candidates_[index];
    if (terms::basis_as<terms::Wave>(*candidate.curve)) return std::nullopt;
    auto best = in_best_shape(task_, basis(), *candidate.curve, basis().fit.noise);
    if (best && is_held_back(*best->model.effects.back(), best->model.fit))
      best = in_best_shape(task_, basis(), strong(*candidate.curve), basis().fit.noise);
    if (!best || best->curve == *candidate.curve) return std::nullopt;
    candidate.curve = std::move(best->curve);
    candidate.effect = best->model.effects.back();
    return accept(Trial{index, std::move(best->model)});
  }

  /// A free law that cannot stand on the name's, but does better in its place, shows that the name was wrong.
  void replace(const std::shared_ptr<const vehicle::Effect>& name, std::size_t candidate,
               const std::vector<vehicle::Variable>& alike) {
    const auto& effects = result_.model.effects;
    const auto place = std::find(effects.begin(), effects.end(), name) - effects.begin();
    auto free =
        free_law_instead_of(task_, result_.model, static_cast<std::size_t>(place), candidates_[candidate]);
    if (!free) return;
    free->proof.family_p_value = round_->score(candidate).family_p_value;
    result_.forget(name);
    adopt(free->law.model);
    result_.considered.back().outcome = "took the place of " + name->name();
    result_.curves.push_back({result_.model.effects.back(), free->law.curve, free->proof, nullptr, alike});
    settle_shape_of_newest_curve(task_, result_);
  }

  /// What an earlier finding or curve explained may belong to what was just added.
  void drop_superfluous() {
    if (retire_superfluous(task_, schwarz(basis().fit), result_)) start_again();
  }

  /// Larger than usual if the data insist; about its mean where the drive cannot tell that from slow motion.
  std::optional<Trial> refit_as(std::size_t index, const terms::Curve& curve) {
    candidates_[index].curve = curve;
    candidates_[index].effect = make_curve_effect(curve);
    return round_->refit(index);
  }

  /// A candidate that was added, or failed its proof, is not asked again; the search goes on with the others.
  void strike(const std::string& key) {
    for (Candidate& candidate : candidates_)
      if (candidate.key == key) candidate.struck = true;
  }

  FitTask task_;
  std::function<void(double)> progress_;
  std::vector<Candidate> candidates_;
  std::optional<SearchRound> round_;
  double noise_share_ = kNoiseShare;
  bool no_more_curves_ = false;
  bool has_changed_ = true;  ///< the model or the candidates, since the round began
  SearchResult result_;
  /// What plausible names and plain curves would make of the base parameters that the last model could
  /// neither show nor rule out.
  std::vector<Eigen::VectorXd> unproved_;
};

}  // namespace

SearchResult search_effects(std::span<const measurement::FitData> data, const vehicle::EffectList& given,
                            const estimation::FitResult& fit, const std::vector<bool>& base_fixed,
                            const std::function<void(double)>& progress) {
  return Search(data, given, fit, base_fixed, progress).run();
}

}  // namespace odomcalib::calib::selection
