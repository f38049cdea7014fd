#include "calib/ingest/phantom_return.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "calib/ingest/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/number_text.hpp"

namespace odomcalib::calib::ingest {
namespace {

struct Reading {
  float value = 0.0F;
  std::size_t count = 0;
};

/// Different readings of some scans, by size.
std::vector<Reading> readings_of(const std::vector<Scan>& scans, std::size_t from, std::size_t to) {
  const std::size_t per_part = settings::kScansLookedAt / settings::kPhantomParts;
  const std::size_t step = std::max<std::size_t>(1, (to - from) / per_part);
  std::vector<float> all;
  for (std::size_t k = from; k < to; k += step)
    for (const float range : scans[k].ranges)
      if (range > 0.0F) all.push_back(range);
  std::sort(all.begin(), all.end());
  std::vector<Reading> distinct;
  for (const float value : all) {
    if (distinct.empty() || distinct.back().value != value) distinct.push_back({value, 0});
    ++distinct.back().count;
  }
  return distinct;
}

/// Usual count of the ten values next to one, five on either side.
double usual_count(const std::vector<Reading>& readings, std::size_t place) {
  std::vector<double> counts{1.0};
  for (std::size_t k = place - std::min(place, settings::kPhantomBeside);
       k < std::min(place + settings::kPhantomBeside + 1, readings.size()); ++k)
    if (k != place) counts.push_back(static_cast<double>(readings[k].count));
  return math::median_of(std::move(counts));
}

/// The most frequent reading, where it stands out.
std::optional<float> outstanding(const std::vector<Reading>& readings) {
  if (readings.empty()) return std::nullopt;
  std::size_t all = 0;
  for (const Reading& reading : readings) all += reading.count;
  const auto most = std::max_element(readings.begin(), readings.end(),
                                     [](const Reading& a, const Reading& b) { return a.count < b.count; });
  const auto count = static_cast<double>(most->count);
  if (count < settings::kPhantomShare * static_cast<double>(all)) return std::nullopt;
  const auto place = static_cast<std::size_t>(most - readings.begin());
  if (count < settings::kPhantomPeak * usual_count(readings, place)) return std::nullopt;
  return most->value;
}

void remove_readings(Recording& recording, double value) {
  std::size_t count = 0;
  for (Scan& scan : recording.scans)
    for (float& range : scan.ranges)
      if (range == static_cast<float>(value)) {
        range = 0.0F;
        ++count;
      }
  recording.discarded.push_back(
      {"beam", "exactly " + math::significant(value, 6) + " m, which stands for no return", count});
}

std::string remark_on(double value) {
  return "many readings are exactly " + math::significant(value, 6) +
         " m wherever the robot was: the lidar or its driver writes that number where nothing came back, or "
         "sees the robot itself; they are left out, and null says the same";
}

}  // namespace

std::optional<double> phantom_return(const Recording& recording) {
  constexpr std::size_t kParts = settings::kPhantomParts;
  const std::size_t scans = recording.scans.size();
  if (scans < 10 * kParts) return std::nullopt;
  std::map<float, std::size_t> parts;
  for (std::size_t part = 0; part < kParts; ++part)
    if (const auto value =
            outstanding(readings_of(recording.scans, scans * part / kParts, scans * (part + 1) / kParts)))
      ++parts[*value];
  const double most = settings::kNearRangeMax * recording.scans.front().range_max;
  for (const auto& [value, count] : parts)
    if (count >= settings::kPhantomPartsNeeded && (most <= 0.0 || static_cast<double>(value) < most))
      return static_cast<double>(value);
  return std::nullopt;
}

Cleaned without_phantom_returns(std::span<const Recording> given) {
  Repairs repairs(given);
  std::vector<std::string> remarks;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (const auto value = phantom_return(given[i])) {
      remove_readings(repairs.own(i), *value);
      remarks.push_back(remark_on(*value));
    }
  return {std::move(repairs).take(), std::move(remarks)};
}

}  // namespace odomcalib::calib::ingest
