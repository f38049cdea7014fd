#include "calib/ingest/sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/matching/surface.hpp"
#include "calib/math/median.hpp"
#include "calib/math/se2.hpp"
#include "proto/recording/scan_checks.hpp"
#include "proto/recording/scan_parts.hpp"

namespace odomcalib::calib::ingest {
namespace {

bool states_a_sweep(const Scan& scan) { return scan.time_increment.has_value(); }

/// Whether that kind is another one than what the scans state.
bool could_sweep(const Recording& recording, SweepKind kind) {
  const auto& scans = recording.scans;
  const bool is_stated = !scans.empty() && states_a_sweep(scans.front());
  if (kind != SweepKind::against_the_list && is_stated != (kind == SweepKind::instead_of_stated))
    return false;
  return scans.size() > 1 && std::none_of(scans.begin(), scans.end(), [&](const Scan& scan) {
           return states_a_sweep(scan) != is_stated || !scan.times.empty() ||
                  scan.sensor != scans.front().sensor;
         });
}

double angle_between_beams(const Scan& scan) {
  const std::size_t beams = scan.ranges.size();
  return beams < 2 ? 0.0 : std::abs(scan.angle(beams - 1) - scan.angle(0)) / static_cast<double>(beams - 1);
}

void let_sweep(Recording& recording) {
  const double turn = math::median_of(math::differences_of(stamps_of(recording.scans)));  // s
  for (Scan& scan : recording.scans)
    scan.time_increment = turn * angle_between_beams(scan) / (2.0 * math::kPi);
}

/// Time of one turn of a head that sweeps, s; negative where it turns clockwise.
double turn_of_head(const Scan& scan) {
  const double step = angle_between_beams(scan);
  if (!(step > 0.0) || scan.ranges.size() < 2) return 0.0;
  const double turn = scan.time_increment.value_or(0.0) * 2.0 * math::kPi / step;
  return std::copysign(turn, math::wrap_angle(scan.angle(1) - scan.angle(0)));
}

/// Angle from one beam to the next in the mean, rad; 0 with less than two.
double step_size(const Scan& scan) {
  return scan.ranges.size() < 2 ? 0.0 : std::abs(math::wrap_angle(mean_step(scan)));
}

}  // namespace

std::optional<Recordings> with_sweeps(const Recordings& recordings, SweepKind kind) {
  const auto given = recordings.view();
  const auto could = [kind](const Recording& recording) { return could_sweep(recording, kind); };
  if (given.empty() || !std::all_of(given.begin(), given.end(), could)) return std::nullopt;
  std::vector<Recording> sweeping(given.begin(), given.end());
  const Scan& stated = given.front().scans.front();
  const bool keeps_times = kind == SweepKind::against_the_list && states_a_sweep(stated);
  for (Recording& recording : sweeping) {
    if (kind == SweepKind::against_the_list)
      for (Scan& scan : recording.scans) list_backwards(scan);
    if (!keeps_times) let_sweep(recording);
  }
  StampReport stamps = recordings.stamps();
  const Scan& first = sweeping.front().scans.front();
  stamps.sweep = *first.time_increment;
  stamps.turn = turn_of_head(first) - turn_of_head(stated);
  stamps.kind = kind;
  return Recordings(std::move(sweeping), stamps);
}

Recordings stamped_in_the_middle(const Recordings& sweeping) {
  std::vector<Recording> moved(sweeping.view().begin(), sweeping.view().end());
  for (Recording& recording : moved)
    for (Scan& scan : recording.scans) scan.t -= matching::reference_time(scan);
  return {std::move(moved), sweeping.stamps()};
}

bool overstates_a_turn(const Scan& scan) {
  const double step = step_size(scan);
  return step * static_cast<double>(scan.ranges.size()) >= 2.0 * math::kPi + 0.5 * step;
}

bool sees_all_round(const Scan& scan) {
  return step_size(scan) * static_cast<double>(scan.ranges.size()) > settings::kAllRoundScan_rad &&
         !overstates_a_turn(scan);
}

}  // namespace odomcalib::calib::ingest
