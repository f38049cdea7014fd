// Cross-validation over five folds of whole blocks of 20 s: neighbouring pairs share a scan, so that single
// pairs left out would not be independent of the rest.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::validation {

inline constexpr std::size_t kFolds = settings::kFolds;

/// Fold of each pair, recordings one after the other; blocks are dealt out in turn, so that every fold has
/// early and late motion.
std::vector<std::size_t> folds_of(std::span<const measurement::FitData> data);

/// Whether each fold leaves something to fit to: a drive of one block has nothing to hold out.
bool hold_out(const std::vector<std::size_t>& folds);

/// Parameters without the fold: one Gauss-Newton step on the remaining whitened rows, which for a nearly
/// linear problem is the refit.
Eigen::VectorXd without_fold(const estimation::FitResult& fit, const std::vector<std::size_t>& folds,
                             std::size_t fold, const std::vector<bool>& fixed);

}  // namespace odomcalib::calib::validation
