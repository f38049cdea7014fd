// How recordings are cut for held-out figures: in one way everywhere, so that they can be compared.
#pragma once

#include <span>
#include <vector>

#include "calib/estimators/joint.hpp"

namespace odomcalib::calib {

inline constexpr std::size_t kFolds = 5;

/// Fold of each pair of all recordings, in order. Blocks of 20 s are dealt out in turn, so that every fold
/// has early and late motion.
std::vector<std::size_t> folds_of(std::span<const FitData> data);

}  // namespace odomcalib::calib
