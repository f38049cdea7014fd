#include "calib/ingest/sweeps.hpp"

#include <algorithm>
#include <cmath>

#include "calib/ingest/even_stamps.hpp"
#include "calib/matching/surface.hpp"
#include "calib/math/median.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::ingest {
namespace {

bool could_sweep(const Recording& recording) {
  const auto& scans = recording.scans;
  return scans.size() > 1 && std::none_of(scans.begin(), scans.end(), [&](const Scan& scan) {
           return scan.time_increment || !scan.times.empty() || scan.sensor != scans.front().sensor;
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

}  // namespace

std::vector<Recording> with_sweeps(std::span<const Recording> recordings) {
  if (!std::all_of(recordings.begin(), recordings.end(), could_sweep)) return {};
  std::vector<Recording> sweeping(recordings.begin(), recordings.end());
  for (Recording& recording : sweeping) let_sweep(recording);
  return sweeping;
}

double turn_of_head(const Recording& sweeping) {
  const Scan& scan = sweeping.scans.front();
  const double step = angle_between_beams(scan);
  if (!(step > 0.0) || scan.ranges.size() < 2) return 0.0;
  const double turn = scan.time_increment.value_or(0.0) * 2.0 * math::kPi / step;
  return std::copysign(turn, math::wrap_angle(scan.angle(1) - scan.angle(0)));
}

void take_stamps_for_middles(std::vector<Recording>& recordings) {
  for (Recording& recording : recordings)
    for (Scan& scan : recording.scans) scan.t -= matching::reference_time(scan);
}

}  // namespace odomcalib::calib::ingest
