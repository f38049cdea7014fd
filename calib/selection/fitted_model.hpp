// A model and its fit, and what the search does with the two together.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/selection/rules.hpp"
#include "calib/vehicle/vehicle_model.hpp"

namespace odomcalib::calib::selection {

struct FittedModel {
  vehicle::EffectList effects;  ///< in the order of the parameter vector
  estimation::FitResult fit;
  [[nodiscard]] Eigen::VectorXd base() const { return fit.parameters.head<vehicle::kBaseCount>(); }
};

/// Task of a fit in the search: recordings, which base parameters stay as they are, and the rules that hold.
struct FitTask {
  std::span<const measurement::FitData> data;
  std::vector<bool> base_fixed;
  RuleSet rules = {};

  [[nodiscard]] std::vector<bool> fixed(const vehicle::EffectList& effects) const {
    return vehicle::fixed_with(base_fixed, effects);
  }
  [[nodiscard]] std::vector<const vehicle::DriveModel*> models() const;
  /// @param noise per recording; empty: estimated anew
  [[nodiscard]] std::optional<estimation::FitResult> fit(
      const vehicle::EffectList& effects, const Eigen::VectorXd& start,
      const std::vector<measurement::NoiseModel>& noise) const;
};

/// Fitted with one more effect, the last then; nullopt if that does not settle.
/// @param noise per recording; empty: estimated anew
std::optional<FittedModel> with_effect(const FitTask& task, const FittedModel& model,
                                       const std::shared_ptr<const vehicle::Effect>& effect,
                                       const std::vector<measurement::NoiseModel>& noise);

/// Fitted without one of the effects; nullopt if that does not settle.
std::optional<FittedModel> without_effect(const FitTask& task, const FittedModel& model, std::size_t index,
                                          const std::vector<measurement::NoiseModel>& noise);

/// The same model with wider noise where many pairs are far out: something systematic is there, and robust
/// weights must not take it for failed matches.
/// @param share of the pairs that has to be noise
estimation::FitResult widened_where_outlying(const FitTask& task, const FittedModel& model, double share);

}  // namespace odomcalib::calib::selection
