// The shape of a law that was found as a curve: how fine it is, and what is unknown of it.
#pragma once

#include "calib/tracing/curve.hpp"
#include "calib/tracing/fitted_model.hpp"

namespace odomcalib::calib {

/// The model with a curve in another shape.
struct Reshaped {
  Curve curve;
  FittedModel model;  ///< on the noise of the given one
};
/// The shapes that the drive can tell from the wheels.
/// @param model whose last effect is the curve's
std::vector<Reshaped> reshaped(const FitTask& task, const FittedModel& model, const Curve& curve);

/// Whether the other shape is worth its parameters, and better on held-out data.
bool is_better(const FitTask& task, const FittedModel& given, const FittedModel& other);

/// A curve about its mean leaves the base the average of this drive; where its law would be zero, nobody
/// knows. By how much that may move the base parameters.
Eigen::VectorXd doubt_of_zero(const FitTask& task, const FittedModel& model, const Curve& curve);

}  // namespace odomcalib::calib
