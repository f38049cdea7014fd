#include "calib/selection/candidate.hpp"

#include <algorithm>
#include <set>
#include <type_traits>
#include <variant>

#include "calib/terms/candidate_smooths.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"
#include "calib/vehicle/placed_effects.hpp"

namespace odomcalib::calib::selection {
namespace {

std::string key_of(const vehicle::Effect& effect) {
  return effect.name() + "/" + effect.parameters().front().name;
}

/// Mark that distinguishes a basis from others of the same dependence that are candidates of their own; empty
/// for all that are shapes of one dependence.
constexpr auto kKindOf = []<typename Kind>(const Kind& basis) -> std::string {
  if constexpr (std::is_same_v<Kind, terms::Cycle>) return "/cycle " + std::to_string(basis.period);
  if constexpr (std::is_same_v<Kind, terms::Harmonics>) return "/harmonic " + std::to_string(basis.only);
  if constexpr (std::is_same_v<Kind, terms::Wave>)
    return "/wave " + std::to_string(basis.along_x) + " " + std::to_string(basis.along_y);
  if constexpr (std::is_same_v<Kind, terms::Patches>) return "/patches";
  if constexpr (std::is_same_v<Kind, terms::ChangePoint>) return "/change point";
  if constexpr (std::is_same_v<Kind, terms::Decay>) return "/decay";
  return {};
};

std::string key_of(const vehicle::Effect& effect, const terms::SmoothTerm& smooth) {
  return effect.name() + (smooth.with_motion ? "/pace" : "") + std::visit(kKindOf, smooth.basis);
}

bool belongs_to_one_recording(const vehicle::Effect& effect) {
  const auto& dependences = effect.dependences();
  return std::any_of(dependences.begin(), dependences.end(), [](const vehicle::Dependence& dependence) {
    return begins_with_the_recording(dependence.covariate);
  });
}

void add_smooths(std::span<const vehicle::DriveModel* const> models, std::vector<Candidate>& candidates) {
  for (const terms::SmoothTerm& smooth : as_of_the_drive(terms::candidate_smooths(models), models))
    candidates.push_back(candidate_of(smooth));
}

}  // namespace

Candidate candidate_of(const terms::SmoothTerm& smooth) {
  const auto effect = make_smooth_term_effect(smooth);
  return {effect, smooth, key_of(*effect, smooth)};
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
  add_smooths(models, candidates);
  return candidates;
}

std::vector<Candidate> floor_waves(std::span<const vehicle::DriveModel* const> models) {
  std::vector<Candidate> candidates;
  for (const terms::SmoothTerm& wave : terms::periodic_smooths(models))
    candidates.push_back(candidate_of(wave));
  return candidates;
}

bool contains(const std::vector<vehicle::Dependence>& dependences, const vehicle::Dependence& dependence) {
  return std::find(dependences.begin(), dependences.end(), dependence) != dependences.end();
}

bool has_textbook_shape(const std::shared_ptr<const vehicle::Effect>& effect) {
  const vehicle::EffectList shapes = effect->variants();
  return shapes.empty() || vehicle::start_of({effect}) == vehicle::start_of({shapes.front()});
}

std::size_t count_sizes(const vehicle::Effect& effect) {
  const auto& parameters = effect.parameters();
  return static_cast<std::size_t>(std::count_if(parameters.begin(), parameters.end(),
                                                [](const vehicle::EffectParameter& p) { return !p.fixed; }));
}

}  // namespace odomcalib::calib::selection
