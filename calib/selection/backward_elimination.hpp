// Terms that leave the model again: those added early that something added later explains better, names that
// a free term of their own dependence shows to be wrong, and smooth terms that are not what is missing.
#pragma once

#include <optional>

#include "calib/selection/candidate.hpp"
#include "calib/selection/cross_validation.hpp"
#include "calib/selection/fitted_model.hpp"
#include "calib/selection/hyperparameters.hpp"
#include "calib/selection/search_result.hpp"

namespace odomcalib::calib::selection {

/// Takes names and smooth terms that are no longer needed out of the model and of the report, one after the
/// other. What was added last stays.
/// @param per_parameter that an effect has to take off -2 log L for each of its own
/// @return whether the model has changed
bool eliminate_superfluous(const FitTask& task, double per_parameter, SearchResult& result);

/// A smooth term in the best of its shapes, cross-validated against the model without it.
struct FreeTerm {
  Reshaped dependence;
  CrossValidation validation;
};

/// The candidate's smooth term in the name's place, if the name leaves more than a little to it and predicts
/// held-out data worse.
/// @param index of the name's effect in the model
std::optional<FreeTerm> free_alternative_to(const FitTask& task, const FittedModel& model, std::size_t index,
                                            const Candidate& candidate);

/// A term of two covariates at once (a wheel that drags in slow turns to the right) lends part of itself to a
/// term of either alone, which is wrong wherever the other differs: in another drive odometry is better
/// without it. Whether the smooth terms explain less than half of what odometry errs by over ten seconds, in
/// squares beyond what noise of reference and wheels makes of it.
/// @param without the same model but for the smooth terms
bool explain_too_little(const FitTask& task, const FittedModel& with, const FittedModel& without);

}  // namespace odomcalib::calib::selection
