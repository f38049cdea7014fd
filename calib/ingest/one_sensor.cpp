#include <algorithm>
#include <map>
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
