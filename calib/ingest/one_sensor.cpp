#include "calib/ingest/one_sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "calib/ingest/reference_faults.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/number_text.hpp"
#include "proto/recording/scan_parts.hpp"

namespace odomcalib::calib::ingest {
namespace {

std::map<std::string, std::size_t> scans_by_sensor(const Recording& recording) {
  std::map<std::string, std::size_t> counts;
  for (const Scan& scan : recording.scans) ++counts[scan.sensor];
  return counts;
}

std::string named(const std::string& sensor) { return sensor.empty() ? "without a name" : sensor; }

std::string list_of(const std::map<std::string, std::size_t>& counts) {
  std::string list;
  for (const auto& [sensor, count] : counts)
    list += (list.empty() ? "" : ", ") + named(sensor) + " (" + std::to_string(count) + ")";
  return list;
}

std::string most_of(const std::map<std::string, std::size_t>& counts) {
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// Number of beams and step between them, rad: medians.
struct Grid {
  double beams = 0.0, step = 0.0;
};

Grid grid_of(const Recording& recording) {
  std::vector<double> beams, steps;
  for (const Scan& scan : recording.scans) {
    beams.push_back(static_cast<double>(scan.ranges.size()));
    steps.push_back(mean_step(scan));
  }
  return {math::median_of(std::move(beams)), math::median_of(std::move(steps))};
}

bool is_near(double a, double b) {
  return std::abs(a - b) <= settings::kSameTurn * std::max(std::abs(a), std::abs(b));
}

std::string text_of(double value) { return math::significant(value, 4); }

std::string pose_text(const std::optional<std::array<double, 3>>& pose) {
  if (!pose) return "at a place that nobody states";
  return "at " + text_of((*pose)[0]) + ", " + text_of((*pose)[1]) + " m, " + text_of((*pose)[2]) + " rad";
}

/// The first thing besides the name that tells the lidar of one recording from that of another; empty:
/// nothing.
std::string difference(const Recording& one, const Recording& other) {
  const Grid a = grid_of(one), b = grid_of(other);
  const Scan &first = one.scans.front(), &second = other.scans.front();
  if (!is_near(a.beams, b.beams)) return text_of(b.beams) + " beams, not " + text_of(a.beams);
  if (!is_near(a.step, b.step)) return "steps of " + text_of(b.step) + " rad, not " + text_of(a.step);
  if (std::abs(second.angle_min - first.angle_min) > std::abs(a.step))
    return "the first beam at " + text_of(second.angle_min) + " rad, not " + text_of(first.angle_min);
  if (first.range_min != second.range_min || first.range_max != second.range_max)
    return "ranges from " + text_of(second.range_min) + " to " + text_of(second.range_max) + " m, not " +
           text_of(first.range_min) + " to " + text_of(first.range_max);
  if (one.robot.lidar_pose != other.robot.lidar_pose)
    return "mounted " + pose_text(other.robot.lidar_pose) + ", not " + pose_text(one.robot.lidar_pose);
  return {};
}

/// The first recording by scans that names its sensor; null: none does.
const Recording* first_named(std::span<const Recording> recordings) {
  const auto named = std::find_if(recordings.begin(), recordings.end(), [](const Recording& one) {
    return is_by_scans(one) && !one.scans.front().sensor.empty();
  });
  return named == recordings.end() ? nullptr : &*named;
}

bool is_by_another_name(const Recording& recording, const Recording& known) {
  return is_by_scans(recording) && !recording.scans.front().sensor.empty() &&
         recording.scans.front().sensor != known.scans.front().sensor;
}

}  // namespace

bool is_by_scans(const Recording& recording) {
  return recording.poses.empty() && recording.increments.empty() && !recording.scans.empty();
}

std::optional<Error> lacks_sensor(std::span<const Recording> recordings, const std::string& sensor) {
  if (sensor.empty()) return std::nullopt;
  for (const Recording& recording : recordings) {
    const auto counts = scans_by_sensor(recording);
    const bool is_unnamed = counts.size() == 1 && counts.contains("");
    if (!is_by_scans(recording) || counts.contains(sensor) || is_unnamed) continue;
    return Error{ErrorCode::usage,
                 "has no scans of the sensor \"" + sensor + "\", but of: " + list_of(counts), recording.name,
                 "leave this recording out, or solve its sensor separately: each has a mounting of its own"};
  }
  return std::nullopt;
}

std::optional<Error> two_sensors(std::span<const Recording> recordings) {
  const Recording* known = first_named(recordings);
  if (known == nullptr) return std::nullopt;
  const auto found = std::find_if(recordings.begin(), recordings.end(), [&](const Recording& recording) {
    return is_by_another_name(recording, *known);
  });
  if (found == recordings.end()) return std::nullopt;
  const std::string differs = difference(*known, *found);
  std::string what = "its scans are of the sensor \"" + found->scans.front().sensor + "\", but those of ";
  what += known->name + " of \"" + known->scans.front().sensor + "\"";
  std::string remedy =
      "name the sensor that all recordings have with --sensor, or solve those of each separately";
  if (!differs.empty())
    what += ": " + differs;
  else
    remedy += "; where only its name changed: --same-lidar";
  return Error{ErrorCode::refused, std::move(what), found->name, std::move(remedy)};
}

Recordings of_one_name(const Recordings& given) {
  const Recording* known = first_named(given.view());
  if (known == nullptr) return given;
  Repairs repairs(given.view());
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Recording& recording = given[i];
    if (!is_by_another_name(recording, *known) || !difference(*known, recording).empty()) continue;
    const std::string name = known->scans.front().sensor, other = recording.scans.front().sensor;
    const std::string whose = known->name;
    Recording& own = repairs.own(i);
    for (Scan& scan : own.scans) scan.sensor = name;
    std::string chosen = "of the sensor \"" + other;
    chosen += "\", taken for \"" + name + "\"";
    own.repairs.push_back({"scans", std::move(chosen),
                           "--same-lidar says that it is the one of " + whose +
                               ", and beams, limits of the range and stated mounting are the same"});
  }
  return repairs.any() ? std::move(repairs).take(given.stamps()) : given;
}

std::optional<Recording> of_one_sensor(const Recording& recording, const std::string& sensor) {
  const auto counts = scans_by_sensor(recording);
  if (counts.size() < 2) return std::nullopt;
  const std::string chosen = counts.contains(sensor) && !sensor.empty() ? sensor : most_of(counts);
  Recording one = recording;
  const auto is_other = [&](const Scan& scan) { return scan.sensor != chosen; };
  Discarded others{"scan", kOfAnotherSensor, 0, one.scans.size()};
  for (const Scan& scan : one.scans) {
    if (!is_other(scan)) continue;
    count_one(others, scan.t);
  }
  std::erase_if(one.scans, is_other);
  one.discarded.push_back(others);
  one.repairs.push_back(
      {"scans", "of the sensor " + named(chosen),
       "there are scans of several sensors: " + list_of(counts) + "; --sensor NAME takes those of another"});
  return one;
}

}  // namespace odomcalib::calib::ingest
