// From residual to missing effect: score tests, joint refits, held-out proof, one effect after the other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/estimators/joint.hpp"
#include "calib/tracing/curve.hpp"
#include "calib/tracing/horizon.hpp"

namespace odomcalib::calib {

struct Finding {
  std::shared_ptr<const Effect> effect;
  double family_p_value = 1.0;
  std::vector<std::string> aliases;  ///< candidates the data cannot tell from it
  double before = 0.0;               ///< held-out position error at the horizon, m
  double after = 0.0;
  Improvement improvement;
};

struct Unnamed {
  std::vector<Curve> curves;  ///< what was added to the model, in order
  double p_value = 1.0;
  double share = 0.0;  ///< of the excess error that the curves remove
};

struct SearchResult {
  EffectList effects;  ///< in the order of the parameter vector: those given, then the findings, then curves
  FitResult fit;
  std::vector<Finding> findings;
  std::optional<Unnamed> unnamed;
};

/// Stepwise search from a fitted model. Nothing is added unless it passes family-wise and the held-out error
/// goes down with a 95 % interval that excludes "no change".
SearchResult search_effects(std::span<const FitData> data, const EffectList& given, const FitResult& fit,
                            const std::vector<bool>& base_fixed, const std::function<void(double)>& progress);

}  // namespace odomcalib::calib
