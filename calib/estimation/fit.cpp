#include "calib/estimation/fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/estimation/settings.hpp"
#include "calib/estimation/start_values.hpp"

namespace odomcalib::calib::estimation {

using measurement::Dataset;
using vehicle::VehicleModel;

Fit fit_once(Dataset dataset, const VehicleModel& start) {
  FitOptions options;
  options.fixed = vehicle::fixed_with(dataset.fixed(), start.effects);
  auto result = fit_joint(dataset.data, start.effects, start.parameters, options);
  if (!result) return {std::move(dataset), start, {}, result.error()};
  VehicleModel fitted{start.effects, result.value().parameters};
  return {std::move(dataset), std::move(fitted), std::move(result).value()};
}

Fit settle(Dataset dataset, VehicleModel start, const Settling& how) {
  how.progress("fitting", 0.0);
  for (int pass = 0;; ++pass) {
    Fit fit = fit_once(std::move(dataset), start);
    if (fit.failure || pass == settings::kMostFitPasses) return fit;
    const bool clock_moves = std::abs(delay_of(fit.model) - delay_of(start)) > how.negligible_delay;
    start = pass == 0 || clock_moves ? how.pruned(fit) : fit.model;
    const bool has_settled = pass >= settings::kFitPasses && !clock_moves;
    if (has_settled || fit.dataset.is_measured_with(start.parameters)) return fit;
    how.progress("matching", std::min(0.33 * (pass + 1), 1.0));
    dataset = measured(std::move(fit.dataset), start.parameters, start.effects);
    how.progress("fitting", std::min(0.5 * (pass + 1), 1.0));
  }
}

Fit measure_and_settle(Dataset dataset, VehicleModel start, const Settling& how) {
  dataset = measured(std::move(dataset), start.parameters, start.effects);
  return settle(std::move(dataset), std::move(start), how);
}

Fit fit_anew(Dataset dataset, const terms::Request& request, const Settling& how) {
  how.progress("matching", 0.0);
  dataset = measured_roughly(std::move(dataset));
  auto start = start_model(dataset, request);
  if (!start) return {std::move(dataset), {}, {}, start.error()};
  return settle(std::move(dataset), std::move(start).value(), how);
}

}  // namespace odomcalib::calib::estimation
