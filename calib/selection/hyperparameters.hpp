// The shape of a term that was found as a smooth term: how fine it is, and what is unknown of it.
#pragma once

#include <optional>

#include "calib/selection/fitted_model.hpp"
#include "calib/terms/smooth_term.hpp"

namespace odomcalib::calib::selection {

/// The model with a smooth term in another shape.
struct Reshaped {
  terms::SmoothTerm smooth;
  FittedModel model;  ///< on the noise of the given one
};

/// Those of the shapes that the drive can separate from the wheels, of sizes that a robot may have.
/// @param now whose model ends with its smooth term
std::vector<Reshaped> reshaped(const FitTask& task, const Reshaped& now,
                               const std::vector<terms::SmoothTerm>& shapes);

/// Decrease of -2 log L that a parameter needs when it is the question whether what it belongs to is there
/// (Schwarz, Ann. Statist. 6, 1978); settings::kAkaike when that has passed cross-validation.
double schwarz(const estimation::FitResult& fit);

/// Number of parameters that the data decide rather than the priors: the trace of what maps the data to what
/// is fitted to them (Hastie, Tibshirani and Friedman, The Elements of Statistical Learning, 2009, eq. 7.32).
double effective_parameters(const estimation::FitResult& fit);

/// The smooth term on top of `model` in that of its shapes that describes the data best; nullopt if the drive
/// can separate none from the wheels.
/// @param noise of what it will be compared with, per recording
std::optional<Reshaped> in_best_shape(const FitTask& task, const FittedModel& model,
                                      const terms::SmoothTerm& smooth,
                                      const std::vector<measurement::NoiseModel>& noise);

/// A name that leaves so little to a freer term is the right one, whatever that little is.
/// @param index of the name's effect in `named`; `free` has a smooth term in its place, on the same noise
bool explains_nearly_all(const FitTask& task, const FittedModel& named, std::size_t index,
                         const FittedModel& free);

/// Whether the other model is worth its parameters, and better on held-out data.
bool is_better(const FitTask& task, const FittedModel& given, const FittedModel& other, double per_parameter);

/// A smooth term about its mean leaves the base the average of this drive; where its function would be zero,
/// nobody knows. By how much that may move the base parameters.
Eigen::VectorXd uncertainty_of_zero(const FitTask& task, const FittedModel& model,
                                    const terms::SmoothTerm& smooth);

/// The base parameters are those of a robot without the effect. Where this drive shows it at work everywhere,
/// as a term of speed does down to the slowest speed, they are extrapolated: by what it does where it does
/// least. Zero where it is absent, or of either sign, in a tenth of the drive.
/// @param dependence effects of the model that make it up: one, or one and the smooth terms that make one
/// term with it. A term that is not the textbook's has no side of which it is known that nothing happens
/// there, so that all that lies between its extremes is open.
Eigen::VectorXd uncertainty_of_extrapolation(const FitTask& task, const FittedModel& model,
                                             const std::vector<std::size_t>& dependence);

/// Changes of the base parameters with the other shapes in which an effect that scales lengths is tried, each
/// by the root of its probability beside all of them (Hoeting et al., Stat. Sci. 14, 1999, eq. 5).
/// @param index of the effect in the model
std::vector<Eigen::VectorXd> uncertainties_of_shape(const FitTask& task, const FittedModel& model,
                                                    std::size_t index);

}  // namespace odomcalib::calib::selection
