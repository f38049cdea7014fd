#include "calib/ingest/recordings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/one_sensor.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/math/se2.hpp"
#include "calib/terms/catalogue.hpp"

namespace odomcalib::calib::ingest {
namespace {

void multiply(Recording& recording, double scale) {
  for (Scan& scan : recording.scans) {
    for (float& range : scan.ranges) range = static_cast<float>(scale * static_cast<double>(range));
    scan.range_min *= scale;
    scan.range_max *= scale;
  }
  for (PoseSample& pose : recording.poses) {
    pose.x *= scale;
    pose.y *= scale;
  }
  for (IncrementSample& increment : recording.increments) {
    increment.lidar_motion[0] *= scale;
    increment.lidar_motion[1] *= scale;
  }
}

}  // namespace

Recordings::Recordings(std::vector<Recording> repaired, const StampReport& stamps)
    : owner_(std::make_shared<const std::vector<Recording>>(std::move(repaired))),
      view_(*owner_),
      stamps_(stamps) {}

bool Recordings::are_those_of(const Recordings& other) const {
  return view_.data() == other.view_.data() && view_.size() == other.view_.size();
}

Recordings Recordings::reported_as(const StampReport& stamps) const {
  Recordings same = *this;
  same.stamps_ = stamps;
  return same;
}

Recording& Repairs::own(std::size_t k) {
  if (own_.empty()) own_.assign(given_.begin(), given_.end());
  return own_[k];
}

Recordings Repairs::take(const StampReport& stamps) && {
  return any() ? Recordings(std::move(own_), stamps) : Recordings(given_);
}

Recordings with_even_ticks(std::span<const Recording> given) {
  Repairs repairs(given);
  StampReport stamps;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (const auto even = even_ticks(given[i])) {
      set_stamps(repairs.own(i).ticks, even->t);
      stamps.ticks = std::max(stamps.ticks, even->jitter);
    }
  return std::move(repairs).take(stamps);
}

StampTimes entry_of(const StampReport& report) {
  return {report.ticks, report.scans, report.sweep,
          report.clocks > 0.0 ? std::optional(report.clocks) : std::nullopt};
}

namespace {

const char* sentence_of(SweepKind kind) {
  switch (kind) {
    case SweepKind::assumed:
      break;
    case SweepKind::instead_of_stated:
      return "scans state other times of their beams than the motion shows; a head that turns once from scan "
             "to "
             "scan explains it better, and was assumed: record time_increment as the seconds from one beam "
             "to the "
             "next";
    case SweepKind::against_the_list:
      return "scans list their beams against the order in which the head sends them, as the motion shows; "
             "they "
             "were turned round: list beams as they are sent";
  }
  return "scans do not say when their beams were sent; a head that turns once from scan to scan explains the "
         "motion better, and was assumed: record time_increment";
}

}  // namespace

std::vector<std::string> remarks_on(const StampReport& report) {
  std::vector<std::string> remarks;
  const auto remark_on = [&](const std::string& what, double seconds) {
    if (seconds > settings::kReportedJitter_s)
      remarks.push_back("stamps of the " + what + " jitter by " + std::to_string(std::lround(1e3 * seconds)) +
                        " ms although the motion shows that the " + what +
                        " were taken evenly: even times were used; stamp them where they are made");
  };
  remark_on("ticks", report.ticks);
  remark_on("scans", report.scans);
  if (report.sweep > 0.0) remarks.emplace_back(sentence_of(report.kind));
  if (report.clocks > 0.0)
    remarks.push_back(
        "the clocks of the recordings differ by " + std::to_string(std::lround(1e3 * report.clocks)) +
        " ms (standard deviation) beyond chance: each was read by a clock of its own; stamp wheels "
        "and reference by one clock");
  return remarks;
}

std::vector<EffectResult> effects_of(const StampReport& report) {
  if (report.turn == 0.0) return {};
  EffectResult skew;
  skew.name = terms::make_scan_skew()->name();
  skew.parameters = {{"c", {report.turn / (2.0 * math::kPi), -1.0, "s"}}};
  skew.evidence.p_value = report.sweep_p_value;
  return {skew};
}

std::optional<Scale> scale_by_data_sheet(std::span<const Recording> recordings) {
  if (!std::any_of(recordings.begin(), recordings.end(), is_by_scans)) return std::nullopt;
  return Scale{1.0, settings::kLidarScale, "lidar data sheet"};
}

Recordings with_scale(std::span<const Recording> given, double scale) {
  if (scale == 1.0) return Recordings(given);
  std::vector<Recording> scaled(given.begin(), given.end());
  for (Recording& recording : scaled) multiply(recording, scale);
  return {std::move(scaled), {}};
}

}  // namespace odomcalib::calib::ingest
