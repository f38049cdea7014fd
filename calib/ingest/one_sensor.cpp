#include "calib/ingest/one_sensor.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "calib/ingest/reference_faults.hpp"

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
  const Recording* known = nullptr;
  for (const Recording& recording : recordings) {
    if (!is_by_scans(recording) || recording.scans.front().sensor.empty()) continue;
    if (known == nullptr) known = &recording;
    const std::string &one = known->scans.front().sensor, &other = recording.scans.front().sensor;
    if (other == one) continue;
    std::string what = "its scans are of the sensor \"" + other + "\", but those of ";
    what += known->name + " of \"" + one + "\"";
    return Error{ErrorCode::refused, std::move(what), recording.name,
                 "name the sensor that all recordings have with --sensor, or solve those of each separately"};
  }
  return std::nullopt;
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
