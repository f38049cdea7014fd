// Names that a free term of their own dependence shows to be wrong.
#pragma once

#include <optional>

#include "calib/selection/candidate.hpp"
#include "calib/selection/cross_validation.hpp"
#include "calib/selection/hyperparameters.hpp"

namespace odomcalib::calib::selection {

/// A smooth term in the best of its shapes, cross-validated against the model without it.
struct FreeTerm {
  Reshaped dependence;
  CrossValidation validation;
};

/// The candidate's smooth term in the name's place, if the name leaves more than a little to it and predicts
/// held-out data worse.
/// @param index of the name's effect in the model
std::optional<FreeTerm> free_term_instead_of(const FitTask& task, const FittedModel& model, std::size_t index,
                                             const Candidate& candidate);

}  // namespace odomcalib::calib::selection
