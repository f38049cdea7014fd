#include "calib/stages/lidar_correction.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "calib/estimation/fit.hpp"
#include "calib/ingest/sweeps.hpp"
#include "calib/measurement/scan_path.hpp"
#include "calib/selection/lidar_trace.hpp"
#include "calib/stages/placed_fit.hpp"
#include "calib/stages/settings.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/validation/criterion.hpp"

namespace odomcalib::calib::stages {
namespace {

const terms::LidarFinding* finding_of(const measurement::ScanPath& path, const std::string& name) {
  const auto found =
      std::find_if(path.lidar.begin(), path.lidar.end(),
                   [&](const terms::LidarFinding& finding) { return finding.effect->name() == name; });
  return found == path.lidar.end() ? nullptr : &*found;
}

/// The first path's finding with the mean values of all paths; none where a path lacks it.
std::optional<terms::LidarFinding> mean_of(const terms::LidarFinding& first,
                                           std::span<const measurement::ScanPath> paths) {
  terms::LidarFinding mean = first;
  for (const measurement::ScanPath& path : paths.subspan(1)) {
    const terms::LidarFinding* other = finding_of(path, first.effect->name());
    if (other == nullptr) return std::nullopt;
    for (std::size_t k = 0; k < mean.values.size(); ++k) mean.values[k] += other->values[k];
  }
  for (double& value : mean.values) value /= static_cast<double>(paths.size());
  return mean;
}

/// Pairs of scans with different headings, of all recordings. The fit's model guesses and de-skews.
std::vector<measurement::HeadingPair> heading_pairs(const estimation::Fit& fit) {
  std::vector<measurement::HeadingPair> all;
  const measurement::Dataset& dataset = fit.dataset;
  const std::span<const double> p = vehicle::as_span(fit.model.parameters);
  for (std::size_t i = 0; i < dataset.recordings.size(); ++i) {
    const measurement::ScanSurfaces scans(dataset.recordings[i], *dataset.models[i], p, fit.model.effects,
                                          dataset.pair_sets[i].range_noise);
    const std::size_t most =
        std::max<std::size_t>(1, settings::kMostHeadingPairs / dataset.recordings.size());
    auto pairs = heading_pairs(scans, most);
    std::move(pairs.begin(), pairs.end(), std::back_inserter(all));
  }
  return all;
}

/// Whether the scans of all recordings cover whole turns.
bool sees_all_round(const measurement::Dataset& dataset) {
  const auto recordings = dataset.recordings.view();
  return std::all_of(recordings.begin(), recordings.end(), [](const Recording& recording) {
    return !recording.scans.empty() && ingest::sees_all_round(recording.scans[recording.scans.size() / 2]);
  });
}

/// The recordings without the errors found; where none can be corrected, still new recordings, whose angles
/// are stated beam by beam.
ingest::Recordings corrected(const ingest::Recordings& recordings,
                             const std::vector<terms::LidarFinding>& findings) {
  std::vector<Recording> out(recordings.view().begin(), recordings.view().end());
  for (Recording& recording : out)
    for (Scan& scan : recording.scans) scan = corrected(scan, findings);
  return {std::move(out), recordings.stamps()};
}

/// Errors of the ranges that the maps of all recordings show, their values the means.
std::vector<terms::LidarFinding> common_findings(std::span<const measurement::ScanPath> paths) {
  std::vector<terms::LidarFinding> common;
  if (paths.empty()) return common;
  for (const terms::LidarFinding& finding : paths.front().lidar)
    if (auto mean = mean_of(finding, paths)) common.push_back(std::move(*mean));
  return common;
}

/// Adds what scans still show after a first correction.
void refine(std::span<terms::LidarFinding> findings, const std::vector<measurement::HeadingPair>& pairs) {
  std::vector<terms::LidarEffectPtr> effects;
  effects.reserve(findings.size());
  for (const terms::LidarFinding& finding : findings) effects.push_back(finding.effect);
  const std::vector<terms::LidarFinding> rest = selection::fit_lidar(pairs, effects);
  for (std::size_t k = 0; k < rest.size(); ++k)
    for (std::size_t j = 0; findings[k].effect->is_correctable() && j < findings[k].values.size(); ++j)
      findings[k].values[j] += rest[k].values[j];
}

using Findings = std::vector<terms::LidarFinding>;

/// Everything that stays the same from one correction to the next.
struct Task {
  ingest::Recordings uncorrected;
  const terms::Request& request;
  const estimation::Settling& how;
  const selection::RuleSet& rules;

  [[nodiscard]] bool is_requested() const { return !request.lidar_effects.empty(); }
};

/// Whether what was found is refined by a second look, at pairs of the corrected scans.
enum class Looks { once, twice };

Findings joined(const Findings& known, const Findings& found) {
  Findings all = known;
  all.insert(all.end(), found.begin(), found.end());
  return all;
}

/// Errors of the angles, which have to be known before there is a map.
Findings wrong_angles(const estimation::Fit& fit, const Task& task) {
  if (task.is_requested()) return {};
  Findings found = selection::trace_lidar(heading_pairs(fit), sees_all_round(fit.dataset), true, task.rules);
  if (found.empty() || !found.front().effect->bends_walls()) return {};
  found.resize(1);
  return found;
}

/// Findings from pairs of scans, a map or its absence known.
Findings wrong_scans(const LidarCorrection& now, const Task& task) {
  const auto pairs = heading_pairs(now.fit);
  if (task.is_requested()) return selection::fit_lidar(pairs, task.request.lidar_effects);
  return selection::trace_lidar(pairs, sees_all_round(now.fit.dataset), !now.placement.paths.empty(),
                                task.rules);
}

measurement::Dataset without(const Findings& findings, const measurement::Dataset& dataset,
                             const Task& task) {
  return with_scans_of(dataset, corrected(task.uncorrected, findings));
}

/// The findings with what corrected scans still show, and the model fitted to these.
/// @param known findings before them
std::pair<Findings, vehicle::VehicleModel> refined(Findings findings, std::size_t known,
                                                   const estimation::Fit& fit, const Task& task) {
  const auto& [effects, parameters] = fit.model;
  const estimation::Fit first_look =
      estimation::fit_once(measured(without(findings, fit.dataset, task), parameters, effects), fit.model);
  if (first_look.failure) return {std::move(findings), fit.model};
  refine(std::span(findings).subspan(known), heading_pairs(first_look));
  return {std::move(findings), first_look.model};
}

/// Everything measured and fitted anew without the errors found.
LidarCorrection take_out(const Findings& found, LidarCorrection before, const Task& task, Looks looks) {
  Findings findings = joined(before.findings, found);
  if (std::none_of(found.begin(), found.end(), [](const auto& f) { return f.effect->is_correctable(); }))
    return {std::move(before.fit), std::move(findings), std::move(before.placement)};
  vehicle::VehicleModel start = before.fit.model;
  if (looks == Looks::twice)
    std::tie(findings, start) = refined(findings, before.findings.size(), before.fit, task);
  estimation::Fit after =
      measure_and_settle(without(findings, before.fit.dataset, task), std::move(start), task.how);
  const bool is_kept = !after.failure && (task.is_requested() ||
                                          !validation::is_worse(validation::held_out_residual(before.fit),
                                                                validation::held_out_residual(after)));
  if (is_kept) return {std::move(after), std::move(findings), std::move(before.placement)};
  // Fitted once more instead of keeping the fit as it was: also without any error corrected scans state their
  // angles one by one, rounded, and results so far have stood on these.
  estimation::Fit again = measure_and_settle(without(before.findings, before.fit.dataset, task),
                                             std::move(before.fit.model), task.how);
  return {std::move(again), std::move(before.findings), std::move(before.placement)};
}

}  // namespace

LidarCorrection correct_lidar(estimation::Fit fit, const terms::Request& request,
                              const estimation::Settling& how, const selection::RuleSet& rules) {
  const Task task{fit.dataset.recordings, request, how, rules};
  const bool may_trace = request.is_automatic || task.is_requested();
  LidarCorrection now{std::move(fit)};
  if (now.fit.failure || !may_trace || !now.fit.dataset.reference_is_scans()) return now;
  Findings found = wrong_angles(now.fit, task);
  now = take_out(found, std::move(now), task, Looks::twice);
  if (now.fit.failure) return now;
  now.placement =
      place_every_scan(now.fit, how.progress, task.is_requested() ? Ranges::believed : Ranges::traced, rules);
  found = common_findings(now.placement.paths);
  now = take_out(found, std::move(now), task, Looks::once);
  if (now.fit.failure) return now;
  how.progress("tracing the lidar", 0.0);
  found = wrong_scans(now, task);
  return take_out(found, std::move(now), task, Looks::twice);
}

}  // namespace odomcalib::calib::stages
