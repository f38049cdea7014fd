#include "proto/recording/stamp_units.hpp"

#include <array>

namespace odomcalib {
namespace {

struct Unit {
  const char* name;
  double per_second;
};

constexpr std::array kUnits = {Unit{"milliseconds since 1970", 1e3}, Unit{"microseconds since 1970", 1e6},
                               Unit{"nanoseconds since 1970", 1e9}};

constexpr const char* kBegin = "time stamp in ";

}  // namespace

const char* unit_of_date(double stamp) {
  for (const Unit& unit : kUnits)
    if (stamp >= kEarliestDate_s * unit.per_second && stamp <= kLatestDate_s * unit.per_second)
      return unit.name;
  return nullptr;
}

std::string stamp_reason(const char* unit) { return kBegin + std::string(unit) + ", not in seconds"; }

std::string unit_of_reason(const std::string& reason) {
  for (const Unit& unit : kUnits)
    if (reason == stamp_reason(unit.name)) return unit.name;
  return "";
}

Error wrong_dates(const std::string& what, std::size_t count, const std::string& unit,
                  const std::string& where) {
  const std::string many = what.ends_with("s") ? what : what + "s";
  return {ErrorCode::format,
          "times are not in seconds: stamps of " + std::to_string(count) + " " + many + " look like " + unit,
          where, "write every \"t\" in seconds"};
}

}  // namespace odomcalib
