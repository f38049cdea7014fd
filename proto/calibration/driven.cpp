#include "proto/calibration/driven.hpp"

#include <algorithm>
#include <array>
#include <ctime>

namespace odomcalib {
namespace {

/// s since 1970: what lies outside counts from elsewhere, or in another unit. Chosen: September 2001, before
/// any such robot's clock; year 2100.
constexpr double kEarliest_s = 1e9, kLatest_s = 4.1e9;

std::string formatted(double time, const char* format) {
  const auto whole = static_cast<std::time_t>(time);
  std::tm parts{};
  gmtime_r(&whole, &parts);
  std::array<char, 64> text{};
  return {text.data(), std::strftime(text.data(), text.size(), format, &parts)};
}

}  // namespace

std::optional<Driven> driven_of(const Calibration& calibration) {
  if (calibration.data.empty()) return std::nullopt;
  Driven driven{kLatest_s, kEarliest_s};
  for (const DataUse& data : calibration.data) {
    if (!data.begin || !(*data.begin > kEarliest_s && *data.begin + data.duration < kLatest_s))
      return std::nullopt;
    driven.begin = std::min(driven.begin, *data.begin);
    driven.end = std::max(driven.end, *data.begin + data.duration);
  }
  return driven;
}

std::string iso_time(double time) { return formatted(time, "%Y-%m-%dT%H:%M:%SZ"); }

std::string readable_time(const Driven& driven) {
  const std::string day = formatted(driven.begin, "%Y-%m-%d"), last_day = formatted(driven.end, "%Y-%m-%d");
  return day + ", " + formatted(driven.begin, "%H:%M") + " to " + (last_day == day ? "" : last_day + ", ") +
         formatted(driven.end, "%H:%M") + " UTC";
}

}  // namespace odomcalib
