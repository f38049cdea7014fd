#include "daemon/cli/status_document.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "proto/angles.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

std::string status_text(const ordered_json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Rows of a recording: what it holds of each kind of motion, and what a solve would miss.
std::vector<std::vector<std::string>> motion_rows(const ordered_json& motion) {
  const auto degrees = [&](const char* way) {
    return fmt::format("{} {} ({:.0f} deg)", motion[way]["stretches"].get<int>(), way,
                       motion[way]["rad"].get<double>() * kDegrees);
  };
  std::vector<std::vector<std::string>> rows = {
      {"recorded",
       fmt::format("stretches: {} straight ({:.2f} m), {}, {}", motion["straight"]["stretches"].get<int>(),
                   motion["straight"]["m"].get<double>(), degrees("left"), degrees("right"))}};
  for (const auto& missing : motion["missing"]) rows.push_back({"missing for a solve", status_text(missing)});
  return rows;
}

/// Whether what was written last was proven by a motion belongs to it.
std::string calibrated_text(const ordered_json& status) {
  std::string calibrated = status["calibrated"] == true ? "yes" : "no";
  if (!status.contains("proven") || !status["proven"].is_boolean()) return calibrated;
  return calibrated +
         (status["proven"] == true ? ", proven by a motion" : "; what was written last is unproven");
}

}  // namespace

Document describe_status(const ordered_json& status) {
  Document document{"odomcalibd: " + status_text(status["state"]), {}};
  const auto& controller = status["controller"];
  const auto& lidar = status["lidar"];
  Section section;
  auto& rows = section.table.rows;
  // An empty text gets no row.
  const auto add = [&rows](const char* what, const std::string& text) {
    if (!text.empty()) rows.push_back({what, text});
  };
  add("robot", status["robot"].value("robot_id", ""));
  add("controller", status_text(controller["state"]) + "  " + status_text(controller["device"]));
  add("lidar", (lidar["stale"] == "" ? "scans arrive" : status_text(lidar["stale"])) + "  " +
                   status_text(lidar["device"]));
  add("in the way", status.value("obstacle", ""));
  if (controller.contains("supply_voltage") && controller["supply_voltage"].is_number())
    add("battery", fmt::format("{:.1f} V", controller["supply_voltage"].get<double>()));
  add("calibrated", calibrated_text(status));
  add("last stop", status_text(status["last_stop"]));
  const ordered_json lcm = status.value("lcm", ordered_json::object());
  if (const auto lost = lcm.value("dropped", std::uint64_t{0}); lost > 0)
    add("LCM", fmt::format("{} messages dropped: the network is too slow", lost));
  if (status["recording_bytes"] > 0)
    for (auto& row : motion_rows(status["recorded_motion"])) rows.push_back(std::move(row));
  for (const auto* device : {&controller, &lidar})
    if ((*device)["problem"] != "") section.lines.push_back(status_text((*device)["problem"]));
  if (status.value("replaced_controller", "") != "")
    section.lines.push_back(status.value("replaced_controller", "") + ": odomcalibctl check");
  document.sections.push_back(section);
  return document;
}

}  // namespace odomcalib::cli
