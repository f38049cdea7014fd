// What candidates would change in the residual.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/estimators/joint.hpp"
#include "calib/tracing/candidate.hpp"

namespace odomcalib::calib {

/// Whitened derivatives of the prediction by the parameters of each candidate, which acts on top of `effects`
/// at its start (where it changes nothing), at the fit and with its weights: 3 n x parameters, one matrix per
/// candidate.
std::vector<Eigen::MatrixXd> candidate_columns(std::span<const FitData> data, const EffectList& effects,
                                               const FitResult& fit,
                                               const std::vector<Candidate>& candidates);

}  // namespace odomcalib::calib
