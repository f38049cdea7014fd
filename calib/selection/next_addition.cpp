#include "calib/selection/next_addition.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "calib/selection/hyperparameters.hpp"
#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

double level(const Candidate& candidate, const SearchResult& found, const RuleSet& rules) {
  if (!candidate.smooth) return is_clock(candidate) ? settings::kClockLevel : settings::kNamedLevel;
  const bool is_stricter = (found.owner_of(candidate.smooth->dependence) || must_be_worthwhile(candidate)) &&
                           rules.has(Rule::stricter_level);
  return is_stricter ? settings::kNamedLevel : settings::kUnnamedLevel;
}

/// What the free smooth terms explain of those of a name's dependences that a finding has already.
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

/// What a finding leaves on its own dependence is the rest of its function, unless a second name explains
/// nearly all that a free smooth term would.
bool is_rest_of_a_named_term(std::size_t name, const SearchRound& round, const SearchResult& found) {
  const std::vector<vehicle::Dependence> dependences = round.candidate(name).effect->dependences();
  if (std::none_of(dependences.begin(), dependences.end(), [&](const vehicle::Dependence& dependence) {
        return found.owner_of(dependence) != nullptr;
      }))
    return false;
  return round.score(name).statistic < settings::kNearlyAll * explained_by_smooths(dependences, round, found);
}

/// Joint refits of the most promising names on the noise model of the current fit.
std::optional<Trial> best_name(SearchRound& round, const SearchResult& found) {
  std::set<std::string> tried;
  const auto is_open = [&](std::size_t k) {
    return !round.candidate(k).smooth && passes(k, round, found) &&
           !(is_rest_of_a_named_term(k, round, found) && round.rules().has(Rule::rest_of_a_name));
  };
  for (const std::size_t k : round.by_score(is_open))
    if (tried.size() < settings::kRefits && tried.insert(round.candidate(k).key).second) round.try_out(k);
  const auto best = round.best_trial([](std::size_t) { return true; });
  return best ? round.best_shape(round.candidate(best->candidate).key) : best;
}

}  // namespace

bool is_clock(const Candidate& candidate) { return candidate.effect->storage() == vehicle::Storage::driver; }

bool passes(std::size_t candidate, const SearchRound& round, const SearchResult& found) {
  return round.score(candidate).family_p_value <= level(round.candidate(candidate), found, round.rules());
}

std::optional<std::size_t> best_smooth(const SearchRound& round, const SearchResult& found) {
  const auto smooths =
      round.by_score([&](std::size_t k) { return round.candidate(k).smooth && passes(k, round, found); });
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
