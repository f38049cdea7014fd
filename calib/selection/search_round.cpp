#include "calib/selection/search_round.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/selection/equivalent_models.hpp"
#include "calib/selection/hyperparameters.hpp"
#include "calib/selection/plausibility.hpp"
#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

double level(const Candidate& candidate) {
  if (candidate.smooth) return settings::kUnnamedLevel;
  return is_clock(candidate) ? settings::kClockLevel : settings::kNamedLevel;
}

/// Sum explained by the free smooth terms on those of a name's dependences that a finding has already.
double explained_by_smooths(const std::vector<vehicle::Dependence>& dependences, const SearchRound& round,
                            const SearchResult& found) {
  double all = 0.0;
  for (const std::size_t k :
       round.by_score([&](std::size_t k) { return round.candidate(k).smooth.has_value(); }))
    if (const vehicle::Dependence& dependence = round.candidate(k).smooth->dependence;
        contains(dependences, dependence) && found.owner_of(dependence))
      all += round.score(k).statistic;
  return all;
}

/// The error that a finding leaves on its own dependence is the rest of its function, unless a second name
/// explains nearly all that a free smooth term would.
bool is_rest_of_a_named_term(std::size_t name, const SearchRound& round, const SearchResult& found) {
  const auto& dependences = round.candidate(name).effect->dependences();
  if (std::none_of(dependences.begin(), dependences.end(), [&](const vehicle::Dependence& dependence) {
        return found.owner_of(dependence) != nullptr;
      }))
    return false;
  return round.score(name).statistic <
         settings::kNameShareOfSmooth * explained_by_smooths(dependences, round, found);
}

/// Joint refits of the most promising names on the noise model of the current fit.
std::optional<Trial> best_name(SearchRound& round, const SearchResult& found) {
  std::set<std::string> tried;
  const auto is_open = [&](std::size_t k) {
    return !round.candidate(k).smooth && passes(k, round) &&
           !(is_rest_of_a_named_term(k, round, found) && round.rules().has(Rule::rest_of_a_name));
  };
  for (const std::size_t k : round.by_score(is_open))
    if (tried.size() < settings::kRefits && tried.insert(round.candidate(k).key).second) round.try_out(k);
  const auto best = round.best_trial([](std::size_t) { return true; });
  return best ? round.best_shape(round.candidate(best->candidate).key) : best;
}

}  // namespace

SearchRound::SearchRound(const FitTask& task, FittedModel basis, const std::vector<Candidate>& candidates)
    : task_(task), candidates_(candidates), basis_(std::move(basis)), table_(task_, basis_, candidates_) {}

double SearchRound::penalty(std::size_t degrees) const {
  return static_cast<double>(degrees) * schwarz(basis_.fit);
}

double SearchRound::penalised(std::size_t candidate) const {
  const auto& smooth = candidates_[candidate].smooth;
  const std::size_t chosen = smooth && happens_at_once(*smooth) ? 1 : 0;  // its moment
  return score(candidate).statistic - penalty(score(candidate).degrees + chosen);
}

std::optional<Trial> SearchRound::refit(std::size_t candidate) const {
  return refit(candidate, basis_.fit.noise);
}

std::optional<Trial> SearchRound::refit(std::size_t candidate,
                                        const std::vector<measurement::NoiseModel>& noise) const {
  const auto& effect = candidates_[candidate].effect;
  auto model = with_effect(task_, basis_, effect, noise);
  if (!model) return std::nullopt;
  const double gain =
      basis_.fit.cost - model->fit.cost - penalty(count_sizes(*effect)) -
      (has_textbook_shape(effect) || !task_.rules.has(Rule::hyperparameter_penalty) ? 0.0
                                                                                    : settings::kAkaike);
  return Trial{candidate, std::move(*model), gain};
}

void SearchRound::try_out(std::size_t candidate) {
  const bool was_tried =
      std::any_of(trials_.begin(), trials_.end(), [&](const Trial& t) { return t.candidate == candidate; });
  if (was_tried) return;
  if (auto trial = refit(candidate)) trials_.push_back(std::move(*trial));
}

std::optional<Trial> SearchRound::best_trial(const Wanted& wanted) const {
  const Trial* best = nullptr;
  for (const Trial& trial : trials_)
    if (is_open(trial.candidate) && wanted(trial.candidate) && (best == nullptr || trial.gain > best->gain))
      best = &trial;
  return best == nullptr ? std::nullopt : std::optional(*best);
}

std::optional<Trial> SearchRound::best_shape(const std::string& key) {
  const auto is_shape = [&](std::size_t k) { return candidates_[k].key == key; };
  std::size_t shapes = 0;
  for (const std::size_t k : by_score(is_shape))
    if (shapes++ < settings::kRefits) try_out(k);
  return best_trial(is_shape);
}

std::vector<std::size_t> SearchRound::by_score(const Wanted& wanted) const {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < candidates_.size(); ++k)
    if (is_open(k) && wanted(k)) order.push_back(k);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return penalised(a) > penalised(b); });
  return order;
}

bool SearchRound::smooth_beats(std::size_t smooth, std::size_t name) const {
  if (penalised(smooth) - penalised(name) <= settings::kAmbiguity) return false;
  const bool same_ground =
      contains(candidates_[name].effect->dependences(), candidates_[smooth].smooth->dependence) ||
      table_.correlations(name, {smooth}).front() > settings::kAlias;
  const auto has_key_of_name = [&](std::size_t k) { return candidates_[k].key == candidates_[name].key; };
  const double of_best_shape = score(by_score(has_key_of_name).front()).statistic;
  const double of_smooth = score(smooth).statistic;
  return !(same_ground && (score(name).statistic > settings::kSameDependence * of_smooth ||
                           of_best_shape > settings::kNameShareOfSmooth * of_smooth));
}

std::vector<std::size_t> SearchRound::competitors_of(const Trial& best) const {
  std::vector<std::size_t> competitors;
  for (const Trial& trial : trials_)
    if (is_open(trial.candidate) && best.gain - trial.gain < settings::kAmbiguity &&
        task_.rules.has(Rule::close_competitors))
      competitors.push_back(trial.candidate);
  std::vector<std::size_t> names;
  for (std::size_t k = 0; k < candidates_.size(); ++k)
    if (is_open(k) && !candidates_[k].smooth && score(k).family_p_value <= settings::kNamedLevel)
      names.push_back(k);
  const std::vector<std::size_t> close = too_close(table_, best.candidate, names);
  if (!close.empty() && task_.rules.has(Rule::close_competitors))
    competitors.insert(competitors.end(), close.begin(), close.end());
  return competitors;
}

std::vector<Eigen::VectorXd> SearchRound::model_uncertainties_of(const std::vector<std::size_t>& competitors,
                                                                 const Trial& best) {
  const std::string name = candidates_[best.candidate].effect->name();
  for (const std::size_t competitor : competitors) try_out(competitor);
  std::vector<Eigen::VectorXd> model_uncertainties;
  for (const Trial& trial : trials_) {
    const vehicle::Effect& effect = *candidates_[trial.candidate].effect;
    const bool is_competitor =
        std::find(competitors.begin(), competitors.end(), trial.candidate) != competitors.end();
    if (is_competitor && effect.name() != name && impossibility(effect, trial.model.fit).empty())
      model_uncertainties.emplace_back(trial.model.base() - best.model.base());
  }
  return model_uncertainties;
}

bool is_clock(const Candidate& candidate) { return candidate.effect->storage() == vehicle::Storage::driver; }

bool passes(std::size_t candidate, const SearchRound& round) {
  return round.score(candidate).family_p_value <= level(round.candidate(candidate)) ||
         !round.rules().has(Rule::significance);
}

std::optional<std::size_t> best_smooth(const SearchRound& round) {
  const auto smooths =
      round.by_score([&](std::size_t k) { return round.candidate(k).smooth && passes(k, round); });
  return smooths.empty() ? std::nullopt : std::optional(smooths.front());
}

std::optional<Trial> best_name_beside(std::optional<std::size_t> smooth, SearchRound& round,
                                      const SearchResult& found) {
  auto name = best_name(round, found);
  if (!name || !smooth || !round.smooth_beats(*smooth, name->candidate) ||
      !round.rules().has(Rule::smooth_term_before_name))
    return name;
  const vehicle::Dependence& dependence = round.candidate(*smooth).smooth->dependence;
  const auto own = round.best_trial(
      [&](std::size_t k) { return contains(round.candidate(k).effect->dependences(), dependence); });
  return own && !round.smooth_beats(*smooth, own->candidate) ? own : std::nullopt;
}

}  // namespace odomcalib::calib::selection
