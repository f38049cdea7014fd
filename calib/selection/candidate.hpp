// Candidates that the search may add to the model, and what each has to meet.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/terms/smooth_term.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::selection {

/// One thing that may be missing: a named effect (one of its variants) or a smooth term.
struct Candidate {
  std::shared_ptr<const vehicle::Effect> effect;
  std::optional<terms::SmoothTerm> smooth;
  std::string key;        ///< variants of one effect share it
  bool excluded = false;  ///< added, or failed cross-validation: not tried again
};

/// The catalogue without what the model has already, each effect in all its shapes.
/// @param one_recording others share no zero of time, heading and the like
std::vector<Candidate> names_missing(const vehicle::EffectList& present, bool one_recording);

/// Those, and the smooth terms that these drives can show.
std::vector<Candidate> all_candidates(const vehicle::EffectList& present,
                                      std::span<const vehicle::DriveModel* const> models);

Candidate candidate_of(const terms::SmoothTerm& smooth);

/// Floors that repeat themselves: tiles, planks, joints. Many, so that they are tried when all else is in the
/// model.
std::vector<Candidate> floor_waves(std::span<const vehicle::DriveModel* const> models);

bool contains(const std::vector<vehicle::Dependence>& dependences, const vehicle::Dependence& dependence);

/// Whether it is the first of its variants; another is a choice of the data.
bool has_textbook_shape(const std::shared_ptr<const vehicle::Effect>& effect);

/// Parameters that a fit is free to choose.
std::size_t count_sizes(const vehicle::Effect& effect);

}  // namespace odomcalib::calib::selection
