#include "calib/selection/lidar_evidence.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>

#include "calib/ingest/scan_span.hpp"
#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
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

}  // namespace

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

bool sees_all_round(const measurement::Dataset& dataset) {
  const auto recordings = dataset.recordings.view();
  return std::all_of(recordings.begin(), recordings.end(), [](const Recording& recording) {
    return !recording.scans.empty() && ingest::sees_all_round(recording.scans[recording.scans.size() / 2]);
  });
}

ingest::Recordings corrected(const ingest::Recordings& recordings,
                             const std::vector<terms::LidarFinding>& findings) {
  std::vector<Recording> out(recordings.view().begin(), recordings.view().end());
  for (Recording& recording : out)
    for (Scan& scan : recording.scans) scan = corrected(scan, findings);
  return {std::move(out), recordings.stamps()};
}

std::vector<terms::LidarFinding> common_findings(std::span<const measurement::ScanPath> paths) {
  std::vector<terms::LidarFinding> common;
  if (paths.empty()) return common;
  for (const terms::LidarFinding& finding : paths.front().lidar)
    if (auto mean = mean_of(finding, paths)) common.push_back(std::move(*mean));
  return common;
}

void refine(std::span<terms::LidarFinding> findings, const std::vector<measurement::HeadingPair>& pairs) {
  std::vector<terms::LidarEffectPtr> effects;
  effects.reserve(findings.size());
  for (const terms::LidarFinding& finding : findings) effects.push_back(finding.effect);
  const std::vector<terms::LidarFinding> rest = fit_lidar(pairs, effects);
  for (std::size_t k = 0; k < rest.size(); ++k)
    for (std::size_t j = 0; findings[k].effect->is_correctable() && j < findings[k].values.size(); ++j)
      findings[k].values[j] += rest[k].values[j];
}

}  // namespace odomcalib::calib::selection
