// Changes that candidates would make in the residual.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/selection/candidate.hpp"

namespace odomcalib::calib::selection {

/// Takes the index of a candidate and its matrix.
using CandidateVisit = std::function<void(std::size_t, Eigen::MatrixXd)>;

/// Visits the whitened derivatives of the prediction by the parameters of each candidate, which acts on top
/// of `effects` at its start (where it changes nothing), at the fit and with its weights: 3 n x parameters,
/// one matrix per candidate, names first. A matrix lives for its visit only, because there may be more than a
/// thousand waves and each grows with the recording.
void for_each_candidate(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                        const estimation::FitResult& fit, const std::vector<Candidate>& candidates,
                        const CandidateVisit& visit);

/// The same matrices in the candidates' order, all held at once.
std::vector<Eigen::MatrixXd> candidate_columns(std::span<const measurement::FitData> data,
                                               const vehicle::EffectList& effects,
                                               const estimation::FitResult& fit,
                                               const std::vector<Candidate>& candidates);

}  // namespace odomcalib::calib::selection
