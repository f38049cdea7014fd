#include "calib/stamps/stamp_report.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace odomcalib::calib {

std::string to_json(const StampJitter& jitter) {
  return nlohmann::ordered_json{{"ticks", jitter.ticks}, {"scans", jitter.scans}}.dump();
}

std::vector<std::string> remarks_on(const StampJitter& jitter) {
  constexpr double kWorthALook = 5e-3;  // s
  std::vector<std::string> remarks;
  const auto remark_on = [&](const std::string& what, double seconds) {
    if (seconds > kWorthALook)
      remarks.push_back("stamps of the " + what + " jitter by " + std::to_string(std::lround(1e3 * seconds)) +
                        " ms although the motion shows that the " + what +
                        " were taken evenly: even times were used; stamp them where they are made");
  };
  remark_on("ticks", jitter.ticks);
  remark_on("scans", jitter.scans);
  return remarks;
}

}  // namespace odomcalib::calib
