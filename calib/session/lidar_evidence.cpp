#include "calib/session/lidar_evidence.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>

namespace odomcalib::calib {
namespace {

constexpr std::size_t kMostPairs = 120;  // of all recordings together

const LidarFinding* finding_of(const ScanPath& path, const std::string& name) {
  const auto found = std::find_if(path.lidar.begin(), path.lidar.end(), [&](const LidarFinding& finding) {
    return finding.effect->name() == name;
  });
  return found == path.lidar.end() ? nullptr : &*found;
}

/// The first path's finding with the mean values of all paths; none where a path lacks it.
std::optional<LidarFinding> mean_of(const LidarFinding& first, std::span<const ScanPath> paths) {
  LidarFinding mean = first;
  for (const ScanPath& path : paths.subspan(1)) {
    const LidarFinding* other = finding_of(path, first.effect->name());
    if (other == nullptr) return std::nullopt;
    for (std::size_t k = 0; k < mean.values.size(); ++k) mean.values[k] += other->values[k];
  }
  for (double& value : mean.values) value /= static_cast<double>(paths.size());
  return mean;
}

}  // namespace

std::vector<HeadingPair> heading_pairs(const Session& session, const Eigen::VectorXd& parameters,
                                       const EffectList& effects) {
  std::vector<HeadingPair> all;
  const std::span<const double> p = as_span(parameters);
  for (std::size_t i = 0; i < session.recordings().size(); ++i) {
    const ScanSurfaces scans(session.recordings()[i], *session.data()[i].model, p, effects,
                             session.pair_sets()[i].range_noise);
    const std::size_t most = std::max<std::size_t>(1, kMostPairs / session.recordings().size());
    auto pairs = heading_pairs(scans, most);
    std::move(pairs.begin(), pairs.end(), std::back_inserter(all));
  }
  return all;
}

bool sees_all_round(const Session& session) {
  return std::all_of(
      session.recordings().begin(), session.recordings().end(), [](const Recording& recording) {
        return !recording.scans.empty() && sees_all_round(recording.scans[recording.scans.size() / 2]);
      });
}

std::vector<Recording> corrected(std::span<const Recording> recordings,
                                 const std::vector<LidarFinding>& findings) {
  std::vector<Recording> out(recordings.begin(), recordings.end());
  for (Recording& recording : out)
    for (Scan& scan : recording.scans) scan = corrected(scan, findings);
  return out;
}

std::vector<LidarFinding> common_findings(std::span<const ScanPath> paths) {
  std::vector<LidarFinding> common;
  if (paths.empty()) return common;
  for (const LidarFinding& finding : paths.front().lidar)
    if (auto mean = mean_of(finding, paths)) common.push_back(std::move(*mean));
  return common;
}

void refine(std::span<LidarFinding> findings, const std::vector<HeadingPair>& pairs) {
  std::vector<LidarEffectPtr> effects;
  effects.reserve(findings.size());
  for (const LidarFinding& finding : findings) effects.push_back(finding.effect);
  const std::vector<LidarFinding> rest = fit_lidar(pairs, effects);
  for (std::size_t k = 0; k < rest.size(); ++k)
    for (std::size_t j = 0; findings[k].effect->is_correctable() && j < findings[k].values.size(); ++j)
      findings[k].values[j] += rest[k].values[j];
}

}  // namespace odomcalib::calib
