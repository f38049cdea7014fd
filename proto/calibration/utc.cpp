#include "proto/calibration/utc.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace odomcalib {
namespace {

namespace chr = std::chrono;

constexpr double kFirstDate = 978'307'200.0;     // s since 1970: 2001-01-01
constexpr double kLastDate = 253'402'300'799.0;  // s since 1970: the last second of 9999

}  // namespace

bool is_date(double t) { return t >= kFirstDate && t <= kLastDate; }

std::string utc_text(double t) {
  const chr::sys_seconds time{chr::seconds{std::llround(std::floor(t))}};
  const auto day = chr::floor<chr::days>(time);
  const chr::year_month_day date{day};
  const chr::hh_mm_ss clock{time - day};
  std::array<char, 48> text{};
  (void)std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02dZ",
                      static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                      static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()),
                      static_cast<int>(clock.minutes().count()), static_cast<int>(clock.seconds().count()));
  return text.data();
}

std::string utc_span(double begin, double end) {
  const std::string from = utc_text(begin), to = utc_text(end);
  const auto day = [](const std::string& text) { return text.substr(0, 10); };
  const auto minute = [](const std::string& text) { return text.substr(11, 5); };
  return day(from) + ", " + minute(from) + " to " + (day(to) == day(from) ? "" : day(to) + ", ") +
         minute(to) + " UTC";
}

std::optional<double> utc_from(const std::string& text) {
  int year = 0, hour = 0, minute = 0, second = 0;
  unsigned month = 0, day = 0;
  // NOLINTNEXTLINE(cert-err34-c): what does not read back as the same text is refused below
  if (std::sscanf(text.c_str(), "%4d-%2u-%2uT%2d:%2d:%2dZ", &year, &month, &day, &hour, &minute, &second) !=
      6)
    return std::nullopt;
  const chr::year_month_day date{chr::year{year}, chr::month{month}, chr::day{day}};
  if (!date.ok()) return std::nullopt;
  const chr::sys_seconds time =
      chr::sys_days{date} + chr::hours{hour} + chr::minutes{minute} + chr::seconds{second};
  const auto t = static_cast<double>(time.time_since_epoch().count());
  return is_date(t) && utc_text(t) == text ? std::optional(t) : std::nullopt;
}

}  // namespace odomcalib
