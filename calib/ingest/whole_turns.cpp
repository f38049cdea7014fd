#include <algorithm>
#include <cmath>
#include <map>

#include "calib/ingest/reference_faults.hpp"
#include "calib/ingest/settings.hpp"

namespace odomcalib::calib::ingest {
namespace {

bool has_one_step(const std::vector<Scan>& scans) {
  const double step = scans.front().angle_increment;
  return std::all_of(scans.begin(), scans.end(), [&](const Scan& scan) {
    return scan.angles.empty() &&
           std::abs(scan.angle_increment - step) <= settings::kSameStep * std::abs(step);
  });
}

struct Beams {
  std::size_t fewest = 0, most = 0;
  double mean = 0.0;
  double share_of_usual = 1.0;  ///< of the scans, that have the most frequent number
};

Beams beams_of(const std::vector<Scan>& scans) {
  std::map<std::size_t, std::size_t> counts;
  double sum = 0.0;
  for (const Scan& scan : scans) {
    ++counts[scan.ranges.size()];
    sum += static_cast<double>(scan.ranges.size());
  }
  const auto usual = std::max_element(counts.begin(), counts.end(),
                                      [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto n = static_cast<double>(scans.size());
  return {counts.begin()->first, counts.rbegin()->first, sum / n, static_cast<double>(usual->second) / n};
}

/// Lost beams make scans shorter now and then; a speed that wanders makes hardly two of the same length.
bool wanders(const Beams& beams) {
  return beams.most - beams.fewest > settings::kBeamsAtEnds && beams.share_of_usual < settings::kUsualNumber;
}

}  // namespace

std::optional<Recording> with_whole_turns(const Recording& recording) {
  if (recording.scans.size() < settings::kFewestParts || !has_one_step(recording.scans)) return std::nullopt;
  const Beams beams = beams_of(recording.scans);
  const double turn = beams.mean * std::abs(recording.scans.front().angle_increment);
  if (!wanders(beams) || std::abs(turn / kWholeTurn - 1.0) > settings::kNearlyOneTurn) return std::nullopt;
  Recording whole = recording;
  for (Scan& scan : whole.scans)
    scan.angle_increment =
        std::copysign(kWholeTurn / static_cast<double>(scan.ranges.size()), scan.angle_increment);
  whole.repairs.push_back(
      {"beams", "spread over one turn by their number",
       "scans have " + std::to_string(beams.fewest) + " to " + std::to_string(beams.most) +
           " beams and one angle_increment: the speed of the head wanders, and the number "
           "of beams times their step has to be one turn"});
  return whole;
}

}  // namespace odomcalib::calib::ingest
