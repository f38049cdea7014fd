#include <string>
#include <vector>

#include "calib/ingest/put_right.hpp"
#include "calib/ingest/reference_faults.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/math/number_text.hpp"

namespace odomcalib::calib::ingest {
namespace {

/// s, without what is longer than an interruption.
template <typename Sample>
double time_covered(const std::vector<Sample>& samples) {
  double covered = 0.0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const double step = samples[k].t - samples[k - 1].t;
    if (step <= settings::kMaxGap_s) covered += step;
  }
  return covered;
}

}  // namespace

std::optional<std::string> word_on_unused_scans(const Recording& recording) {
  if (recording.poses.empty() || recording.scans.size() < 2) return std::nullopt;
  const double poses = time_covered(recording.poses), scans = time_covered(recording.scans);
  if (poses >= settings::kPosesCover * scans) return std::nullopt;
  return std::to_string(recording.scans.size()) +
         " scans are not used: the poses are the reference, and cover " + math::fixed(poses, 1) + " of " +
         math::fixed(scans, 1) + " s";
}

std::optional<Recording> with_unused_scans_told(const Recording& recording) {
  const auto word = word_on_unused_scans(recording);
  if (!word) return std::nullopt;
  Recording told = recording;
  told.repairs.push_back({"reference", std::to_string(recording.poses.size()) + " poses", *word});
  return told;
}

}  // namespace odomcalib::calib::ingest
