#include "calib/ingest/unit_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "calib/ingest/settings.hpp"
#include "calib/matching/surface.hpp"
#include "calib/math/median.hpp"
#include "calib/math/number_text.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::ingest {
namespace {

struct Unit {
  const char* name;
  double size;  ///< in s or m
};

constexpr std::array kTimeUnits = {Unit{"milliseconds", 1e-3}, Unit{"microseconds", 1e-6},
                                   Unit{"nanoseconds", 1e-9}, Unit{"minutes", 60.0}};
constexpr std::array kLengthUnits = {Unit{"millimetres", 1e-3}, Unit{"centimetres", 1e-2},
                                     Unit{"inches", 0.0254}, Unit{"kilometres", 1e3}};

std::string rounded(double value) { return math::significant(value, 4); }

Error wrong(const Recording& recording, const std::string& what, const std::string& remedy) {
  return {ErrorCode::format, what, recording.name, remedy};
}

/// Interval of one lidar's scans: those of several come in between each other.
double interval_of_scans(const Recording& recording) {
  std::vector<double> times;
  for (const Scan& scan : recording.scans)
    if (scan.sensor == recording.scans.front().sensor) times.push_back(scan.t);
  return times.size() < 2 ? settings::kLongestInterval_s : math::median_of(math::differences_of(times));
}

}  // namespace

std::optional<Error> scans_too_fast(const Recording& recording) {
  if (recording.scans.size() < 2) return std::nullopt;
  const double interval = interval_of_scans(recording);
  if (interval >= settings::kFastestScans_s) return std::nullopt;
  const std::string unit = unit_of_interval(interval);
  return wrong(recording,
               "scans come every " + rounded(1e3 * interval) + " ms, faster than any lidar turns" +
                   (unit.empty() ? "" : ": their times look like " + unit),
               "write times in seconds; where one turn is split into parts, join them");
}

std::optional<Error> slow_beams(const Recording& recording) {
  if (recording.scans.size() < 2) return std::nullopt;
  const double interval = interval_of_scans(recording);
  std::vector<double> sweeps;
  for (const Scan& scan : recording.scans)
    sweeps.push_back(matching::beam_time(scan, scan.ranges.size() - 1) - matching::beam_time(scan, 0));
  const double sweep = std::abs(math::median_of(std::move(sweeps)));
  if (sweep <= settings::kLongestSweep * interval) return std::nullopt;
  const bool is_unit = sweep > settings::kSweepInOtherUnit * interval;
  return wrong(recording,
               "the beams of a scan take " + rounded(sweep) + " s, but scans come every " +
                   rounded(interval) + " s: " +
                   (is_unit ? "time_increment or times are not in seconds"
                            : "the stamps of the scans run too slowly, or time_increment is too long"),
               is_unit ? "write time_increment as seconds from one beam to the next, or leave it out"
                       : "stamp scans with the clock that stamps the counts, and write time_increment as "
                         "seconds from one beam to the next");
}

std::optional<Error> too_many_turns(const Recording& recording) {
  std::vector<double> sweeps;
  for (const Scan& scan : recording.scans)
    sweeps.push_back(std::abs(scan.angle(scan.ranges.size() - 1) - scan.angle(0)));
  if (sweeps.empty()) return std::nullopt;
  const double sweep = math::median_of(std::move(sweeps));
  constexpr double kTurn = 2.0 * math::kPi;
  if (sweep <= settings::kMostTurns * kTurn) return std::nullopt;
  const bool degrees = sweep > settings::kTurnsInDegrees * kTurn;
  return wrong(recording,
               "a scan covers " + rounded(sweep) + " rad, " + rounded(sweep / kTurn) + " turns" +
                   (degrees ? ": its angles look like degrees" : ": its angles are stretched"),
               degrees ? "angle_min, angle_increment and angles must be in radians"
                       : "check angle_increment: it is the angle from one beam to the next, in radians, and "
                         "the number of beams per turn depends on the lidar's mode");
}

namespace {

template <typename Sample>
double span_of(const std::vector<Sample>& samples) {
  return samples.empty() ? 0.0 : samples.back().t - samples.front().t;
}

}  // namespace

/// Both streams are of one drive: where one seems to take a unit's factor longer, it is in that unit.
std::optional<Error> spans_in_units(const Recording& recording) {
  const bool by_poses = !recording.poses.empty();
  const double ticks = span_of(recording.ticks);
  const double reference = by_poses ? span_of(recording.poses) : span_of(recording.scans);
  if (!(ticks > 0.0) || !(reference > 0.0)) return std::nullopt;
  for (const Unit& unit : kTimeUnits)
    for (const bool of_ticks : {true, false}) {
      const double ratio = of_ticks ? ticks / reference : reference / ticks;
      if (std::abs(ratio * unit.size - 1.0) > settings::kSameSpan) continue;
      const std::string scans = by_poses ? "poses" : "scans";
      return wrong(recording,
                   "ticks run over " + rounded(ticks) + ", " + scans + " over " + rounded(reference) +
                       " seconds: the times of the " + (of_ticks ? "ticks" : scans) + " look like " +
                       unit.name,
                   "write every \"t\" in seconds");
    }
  return std::nullopt;
}

/// Where the lidar sits on the base: no robot is that large, and no angle.
std::optional<Error> wrong_lidar_pose(const Recording& recording) {
  if (!recording.robot.lidar_pose) return std::nullopt;
  const auto& [x, y, yaw] = *recording.robot.lidar_pose;
  if (std::hypot(x, y) > settings::kFarthestLidar_m)
    return wrong(recording,
                 "lidar_pose puts the lidar " + rounded(std::hypot(x, y)) + " m from the middle of the axle",
                 "write x and y of lidar_pose in metres");
  if (std::abs(yaw) > 2.0 * math::kPi)
    return wrong(recording,
                 "lidar_pose turns the lidar by " + rounded(yaw) + " rad: its yaw looks like degrees",
                 "write the yaw of lidar_pose in radians");
  return std::nullopt;
}

namespace {

double median_reading(const Recording& recording) {
  std::vector<double> readings;
  const std::size_t step = std::max<std::size_t>(1, recording.scans.size() / settings::kScansLookedAt);
  for (std::size_t k = 0; k < recording.scans.size(); k += step)
    for (const float range : recording.scans[k].ranges)
      if (range > 0.0F) readings.push_back(static_cast<double>(range));
  return readings.empty() ? 0.0 : math::median_of(std::move(readings));
}

const Unit& likeliest_length(double reading) {
  const auto distance = [&](const Unit& unit) {
    return std::abs(std::log(reading * unit.size / settings::kUsualMedian_m));
  };
  return *std::min_element(kLengthUnits.begin(), kLengthUnits.end(),
                           [&](const Unit& a, const Unit& b) { return distance(a) < distance(b); });
}

}  // namespace

std::optional<Error> wrong_ranges(const Recording& recording) {
  const double median = median_reading(recording);
  const bool far = median > settings::kFarthestMedian_m;
  if (median == 0.0 || (!far && median >= settings::kNearestMedian_m)) return std::nullopt;
  const Unit& unit = likeliest_length(median);
  return wrong(recording,
               "half of the ranges are " + std::string(far ? "above " : "below ") + rounded(median) +
                   ", which no 2D lidar sees in metres: they look like " + unit.name + " (" +
                   rounded(median * unit.size) + " m)",
               "multiply ranges, range_min and range_max by " + rounded(unit.size));
}

std::string unit_of_interval(double interval) {
  const auto is_usual = [](double seconds) {
    return seconds >= settings::kShortestInterval_s && seconds <= settings::kLongestInterval_s;
  };
  if (is_usual(interval)) return "";
  for (const Unit& unit : kTimeUnits)
    if (is_usual(interval * unit.size)) return unit.name;
  return "";
}

}  // namespace odomcalib::calib::ingest
