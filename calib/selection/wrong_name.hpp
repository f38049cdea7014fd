// Names that a free law on their own ground shows to be wrong.
#pragma once

#include <optional>

#include "calib/selection/candidate.hpp"
#include "calib/selection/law_shape.hpp"
#include "calib/selection/proof.hpp"

namespace odomcalib::calib::selection {

/// A curve in the best of its shapes, proved against the model without it.
struct FreeLaw {
  Reshaped law;
  Proof proof;
};

/// The candidate's curve in the name's place, if the name leaves more than a little to it and foretells
/// held-out data worse.
/// @param index of the name's effect in the model
std::optional<FreeLaw> free_law_instead_of(const FitTask& task, const FittedModel& model, std::size_t index,
                                           const Candidate& candidate);

}  // namespace odomcalib::calib::selection
