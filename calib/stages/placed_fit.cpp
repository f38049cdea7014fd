#include "calib/stages/placed_fit.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "calib/estimation/path_fit.hpp"
#include "calib/measurement/scan_path.hpp"
#include "calib/selection/range_trace.hpp"
#include "calib/validation/criterion.hpp"

namespace odomcalib::calib::stages {
namespace {

bool acts_in_places(const vehicle::Effect& effect) {
  const auto& dependences = effect.dependences();
  return std::any_of(dependences.begin(), dependences.end(), [](const vehicle::Dependence& dependence) {
    return dependence.covariate == vehicle::Covariate::heading ||
           dependence.covariate == vehicle::Covariate::position;
  });
}

std::vector<std::vector<vehicle::Fix>> fixes_of(const estimation::Fit& fit,
                                                const measurement::Placement& placement) {
  const math::Pose mount = vehicle::to_base(vehicle::as_span(fit.model.parameters)).mount;
  std::vector<std::vector<vehicle::Fix>> fixes;
  for (std::size_t i = 0; i < fit.dataset.recordings.size(); ++i)
    fixes.push_back(placement.paths.empty() ? measurement::fixes_of(fit.dataset.recordings[i])
                                            : measurement::fixes_of(placement.paths[i], mount));
  return fixes;
}

/// One recording with the places of its scans.
struct PlacedData {
  measurement::FitData data;
  bool has_slid = false;  ///< its matches slid, so that places have taken their part
};

/// Matches that slide in a loose room look like a carpet.
PlacedData with_places(measurement::FitData data, const measurement::ScanPath& path,
                       const vehicle::VehicleModel& model) {
  const vehicle::Trajectory trajectory =
      data.model->trajectory(vehicle::as_span(model.parameters), model.effects);
  const measurement::PathOfWheels wheels = measurement::path_of_wheels(trajectory);
  const bool slides = validation::is_sliding(drift_of_matches(data.pairs, path, wheels));
  if (slides) data.pairs = pairs_of_places(data.pairs, path, wheels);
  data.places = path.scans;
  return {std::move(data), slides};
}

/// Flags of the parameters that are too small to be reported.
std::vector<bool> nuisance_parameters(const selection::SearchResult& found) {
  std::vector<bool> nuisance(vehicle::kBaseCount, false);
  for (const auto& effect : found.model.effects) {
    const bool is_nuisance =
        std::find(found.nuisance.begin(), found.nuisance.end(), effect) != found.nuisance.end();
    nuisance.insert(nuisance.end(), effect->parameters().size(), is_nuisance);
  }
  return nuisance;
}

/// A parameter too small to be reported, as a millisecond's delay, is too small to speak against places.
bool improves(const estimation::PathFit& path, const selection::SearchResult& found) {
  const estimation::FitResult& fit = found.model.fit;
  const std::vector<bool> nuisance = nuisance_parameters(found);
  std::vector<validation::Comparison> compared;
  for (Eigen::Index k = 0; k < fit.parameters.size(); ++k)
    if (!nuisance[static_cast<std::size_t>(k)])
      compared.push_back({{fit.parameters(k), fit.covariance(k, k)},
                          {path.parameters(k), path.covariance(k, k)},
                          k < vehicle::kBaseCount});
  return validation::confirms_and_knows_better(compared);
}

std::vector<estimation::PathData> path_data(const measurement::Dataset& dataset,
                                            const std::vector<measurement::ScanPath>& paths) {
  std::vector<estimation::PathData> data;
  for (std::size_t i = 0; i < paths.size(); ++i) data.push_back({dataset.models[i].get(), paths[i].scans});
  return data;
}

}  // namespace

measurement::Placement place_every_scan(const estimation::Fit& fit, const measurement::Progress& progress,
                                        Ranges ranges, const selection::RuleSet& rules) {
  if (!fit.dataset.has_motions_alone()) progress("placing every scan", 0.0);
  if (ranges == Ranges::believed) return place_all(fit.dataset, fit.model, nullptr);
  return place_all(fit.dataset, fit.model, [&rules](const auto&... of_the_map) {
    return selection::trace_ranges(of_the_map..., rules);
  });
}

measurement::Placement placement_of(const estimation::Fit& fit, measurement::Placement known,
                                    const measurement::Progress& progress) {
  return fit.failure || known.is_of(fit.dataset) ? std::move(known) : place_every_scan(fit, progress);
}

estimation::Fit locate(estimation::Fit fit, const measurement::Placement& placement) {
  if (fit.failure) return fit;
  const vehicle::VehicleModel& model = fit.model;
  const auto fixes = fixes_of(fit, placement);
  fit.dataset = located(std::move(fit.dataset), fixes, model.parameters, model.effects);
  bool refit = std::any_of(model.effects.begin(), model.effects.end(),
                           [](const auto& effect) { return acts_in_places(*effect); });
  for (std::size_t i = 0; i < placement.paths.size(); ++i) {
    auto [data, has_slid] = with_places(std::move(fit.dataset.data[i]), placement.paths[i], model);
    fit.dataset.data[i] = std::move(data);
    refit = refit || has_slid;
  }
  if (!refit) return fit;
  return estimation::fit_once(std::move(fit.dataset), model);
}

RefinedResult fit_to_every_scan(selection::SearchResult found, const measurement::Dataset& dataset,
                                measurement::Placement placement, const measurement::Progress& progress) {
  if (placement.paths.empty()) return {std::move(found)};
  const vehicle::VehicleModel model{found.model.effects, found.model.fit.parameters};
  if (model.parameters.size() != placement.parameters.size() || model.parameters != placement.parameters) {
    progress("placing every scan", 0.5);
    placement = place_all(dataset, model, nullptr, placement.paths);
  }
  if (placement.paths.empty()) return {std::move(found)};
  const auto fit =
      fit_path(path_data(dataset, placement.paths), model.effects, model.parameters,
               {vehicle::fixed_with(dataset.fixed(), model.effects), found.model.fit.prior_information});
  if (!fit || !improves(fit.value(), found)) return {std::move(found)};
  found.model.fit.parameters = fit.value().parameters;
  found.model.fit.covariance = fit.value().covariance;
  return {std::move(found), true};
}

}  // namespace odomcalib::calib::stages
