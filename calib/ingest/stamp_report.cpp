#include "calib/ingest/stamp_report.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "calib/ingest/settings.hpp"
#include "calib/math/se2.hpp"
#include "calib/terms/effects/factories.hpp"

namespace odomcalib::calib::ingest {

std::string to_json(const StampReport& report) {
  nlohmann::ordered_json body = {
      {"ticks", report.ticks}, {"scans", report.scans}, {"time_increment", report.sweep}};
  if (report.clocks > 0.0) body["clocks"] = report.clocks;
  return body.dump();
}

std::vector<std::string> remarks_on(const StampReport& report) {
  std::vector<std::string> remarks;
  const auto remark_on = [&](const std::string& what, double seconds) {
    if (seconds > settings::kReportedJitter_s)
      remarks.push_back("stamps of the " + what + " jitter by " + std::to_string(std::lround(1e3 * seconds)) +
                        " ms although the motion shows that the " + what +
                        " were taken evenly: even times were used; stamp them where they are made");
  };
  remark_on("ticks", report.ticks);
  remark_on("scans", report.scans);
  if (report.sweep > 0.0)
    remarks.push_back(
        "scans do not say when their beams were sent; a head that turns once from scan to scan explains the "
        "motion better, and was assumed: record time_increment");
  if (report.clocks > 0.0)
    remarks.push_back(
        "the clocks of the recordings differ by " + std::to_string(std::lround(1e3 * report.clocks)) +
        " ms (standard deviation) beyond chance: each was read by a clock of its own; stamp wheels "
        "and reference by one clock");
  return remarks;
}

std::vector<EffectResult> effects_of(const StampReport& report) {
  if (report.turn == 0.0) return {};
  EffectResult skew;
  skew.name = terms::make_scan_skew()->name();
  skew.parameters = {{"c", {report.turn / (2.0 * math::kPi), -1.0, "s"}}};
  skew.evidence.p_value = report.sweep_p_value;
  return {skew};
}

}  // namespace odomcalib::calib::ingest
