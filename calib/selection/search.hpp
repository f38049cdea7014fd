// From residual to missing effect: score tests, joint refits, cross-validation, one effect after the other.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "calib/selection/search_result.hpp"

namespace odomcalib::calib::selection {

/// Stepwise search from a fitted model. Nothing is added unless it passes family-wise and the held-out error
/// goes down with a 95 % interval that excludes "no change".
/// @param rules all of them but in an ablation
SearchResult search_effects(std::span<const measurement::FitData> data, const vehicle::EffectList& given,
                            const estimation::FitResult& fit, const std::vector<bool>& base_fixed,
                            const RuleSet& rules, const std::function<void(double)>& progress);

}  // namespace odomcalib::calib::selection
