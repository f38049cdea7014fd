#include "calib/selection/candidate.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <type_traits>
#include <variant>

#include "calib/selection/settings.hpp"
#include "calib/terms/candidate_curves.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/curve_effect.hpp"
#include "calib/terms/curve_on_drives.hpp"
#include "calib/terms/wave_curves.hpp"
#include "calib/vehicle/placed_effects.hpp"

namespace odomcalib::calib::selection {
namespace {

std::string key_of(const vehicle::Effect& effect) {
  return effect.name() + "/" + effect.parameters().front().name;
}

/// What tells a basis from others of the same law that are sought for themselves; empty for all that are
/// shapes of one law.
constexpr auto kind_of = []<typename Kind>(const Kind& basis) -> std::string {
  if constexpr (std::is_same_v<Kind, terms::Cycle>) return "/cycle " + std::to_string(basis.period);
  if constexpr (std::is_same_v<Kind, terms::Harmonics>) return "/harmonic " + std::to_string(basis.only);
  if constexpr (std::is_same_v<Kind, terms::Wave>)
    return "/wave " + std::to_string(basis.along_x) + " " + std::to_string(basis.along_y);
  if constexpr (std::is_same_v<Kind, terms::Patches>) return "/patches";
  if constexpr (std::is_same_v<Kind, terms::ChangePoint>) return "/change point";
  if constexpr (std::is_same_v<Kind, terms::Decay>) return "/decay";
  return {};
};

std::string key_of(const vehicle::Effect& effect, const terms::Curve& curve) {
  return effect.name() + (curve.with_motion ? "/pace" : "") + std::visit(kind_of, curve.basis);
}

bool belongs_to_one_recording(const vehicle::Effect& effect) {
  const auto laws = effect.laws();
  return std::any_of(laws.begin(), laws.end(),
                     [](const vehicle::Law& law) { return begins_with_the_recording(law.variable); });
}

void add_curves(std::span<const vehicle::DriveModel* const> models, std::vector<Candidate>& candidates) {
  for (const terms::Curve& curve : terms::candidate_curves(models))
    candidates.push_back(candidate_of(as_of_the_drive(curve, models)));
}

}  // namespace

Candidate candidate_of(const terms::Curve& curve) {
  const auto effect = make_curve_effect(curve);
  return {effect, curve, key_of(*effect, curve)};
}

std::vector<Candidate> names_missing(const vehicle::EffectList& present, bool one_recording) {
  std::vector<Candidate> names;
  std::set<std::string> known;
  for (const auto& effect : present) known.insert(key_of(*effect));
  for (const auto& effect : terms::effect_catalogue()) {
    if (known.count(key_of(*effect)) > 0 || (!one_recording && belongs_to_one_recording(*effect))) continue;
    vehicle::EffectList shapes = effect->variants();
    if (shapes.empty()) shapes.push_back(effect);
    for (const auto& shape : shapes) names.push_back({shape, std::nullopt, key_of(*shape)});
  }
  return names;
}

std::vector<Candidate> all_candidates(const vehicle::EffectList& present,
                                      std::span<const vehicle::DriveModel* const> models) {
  std::vector<Candidate> candidates = names_missing(present, models.size() == 1);
  add_curves(models, candidates);
  return candidates;
}

std::vector<Candidate> floor_waves(std::span<const vehicle::DriveModel* const> models) {
  std::vector<Candidate> candidates;
  for (const terms::Curve& wave : terms::wave_curves(models)) candidates.push_back(candidate_of(wave));
  return candidates;
}

bool contains(const std::vector<vehicle::Law>& laws, const vehicle::Law& law) {
  return std::find(laws.begin(), laws.end(), law) != laws.end();
}

std::vector<vehicle::Law> laws_of(const Candidate& candidate) {
  return candidate.curve ? std::vector<vehicle::Law>{candidate.curve->law} : candidate.effect->laws();
}

bool depends_on_history(const Candidate& candidate) {
  if (!candidate.curve) return false;
  const vehicle::Variable variable = candidate.curve->law.variable;
  return is_memory(variable) || is_distance_since(variable);
}

bool must_be_worthwhile(const Candidate& candidate) {
  if (depends_on_history(candidate) || (candidate.curve && happens_at_once(*candidate.curve))) return true;
  const auto laws = laws_of(candidate);
  return std::any_of(laws.begin(), laws.end(), [](const vehicle::Law& law) {
    return law.variable == vehicle::Variable::heading || law.variable == vehicle::Variable::position ||
           law.variable == vehicle::Variable::since_stop;
  });
}

double largest_ratio(const Candidate& candidate) {
  if (must_be_worthwhile(candidate)) return settings::kWorthwhile;
  // What comes back with each turn of a wheel cancels over ten seconds, however plain it is in between.
  if (candidate.curve && is_phase(candidate.curve->law.variable))
    return std::numeric_limits<double>::infinity();
  const bool will_be_used = candidate.effect->storage() == vehicle::Storage::host;
  return candidate.curve && will_be_used ? settings::kUseful : std::numeric_limits<double>::infinity();
}

bool has_textbook_shape(const std::shared_ptr<const vehicle::Effect>& effect) {
  const vehicle::EffectList shapes = effect->variants();
  return shapes.empty() || vehicle::start_of({effect}) == vehicle::start_of({shapes.front()});
}

std::size_t count_sizes(const vehicle::Effect& effect) {
  const auto parameters = effect.parameters();
  return static_cast<std::size_t>(std::count_if(parameters.begin(), parameters.end(),
                                                [](const vehicle::EffectParameter& p) { return !p.fixed; }));
}

}  // namespace odomcalib::calib::selection
