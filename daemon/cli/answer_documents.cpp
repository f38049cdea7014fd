#include "daemon/cli/answer_documents.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
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

using nlohmann::ordered_json;

// The more important of two cells that share a character.
char stronger(char a, char b) {
  constexpr std::string_view kOrder = "#R. ";
  return kOrder[std::min(kOrder.find(a), kOrder.find(b))];
}

// A character is twice as high as it is wide: two rows make one line.
std::vector<std::string> drawing(const std::vector<std::string>& rows) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    std::string line = rows[i];
    if (i + 1 < rows.size())
      std::transform(line.begin(), line.end(), rows[i + 1].begin(), line.begin(), stronger);
    lines.push_back("|" + line + "|");
  }
  const std::string edge = "+" + std::string(rows.empty() ? 0 : rows.front().size(), '-') + "+";
  lines.insert(lines.begin(), edge);
  lines.push_back(edge);
  return lines;
}

Section space(const ordered_json& body) {
  Section section{
      "clear space, from above; ahead is up", {}, {{"", "required, m", "nearest reading, m"}, {}}};
  for (const char* side : {"ahead", "left", "behind", "right"}) {
    const ordered_json& one = body[side];
    section.table.rows.push_back({side, fmt::format("{:.2f}", one["needed"].get<double>()),
                                  one["nearest"].is_number()
                                      ? fmt::format("{:.2f}", one["nearest"].get<double>())
                                      : std::string("none")});
  }
  section.lines = drawing(body["rows"].get<std::vector<std::string>>());
  const double cell = body["cell"].get<double>();
  section.lines.emplace_back("R robot   . required   # seen by the lidar");
  section.lines.push_back(fmt::format("a character is {:.2f} m wide and {:.2f} m high", cell, 2.0 * cell));
  return section;
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
  for (const char* warning : {"replaced_controller", "calibration_not_held"})
    if (status.value(warning, "") != "")
      section.lines.push_back(status.value(warning, "") + ": odomcalibctl check");
  document.sections.push_back(section);
  return document;
}

Document describe_plan(const ordered_json& plan) {
  Document document{
      fmt::format("{}: {} move{} in {:.0f} s, at most {:.2f} m from here", plan.value("plan", ""),
                  plan.value("moves", 0), plan.value("moves", 0) == 1 ? "" : "s", plan.value("duration", 0.0),
                  plan.value("reach", 0.0)),
      {}};
  Section limits{"", {}, {}};
  limits.lines.push_back(fmt::format("an obstacle within {:.2f} m ahead of the robot stops it",
                                     plan.value("stopping_distance", 0.0)));
  for (const auto& text : plan.value("limited", std::vector<std::string>())) limits.lines.push_back(text);
  const auto unseen = plan.value("unseen_moves", std::vector<std::string>());
  if (!unseen.empty())
    limits.lines.push_back(fmt::format("the lidar does not see where these go: {}", fmt::join(unseen, ", ")));
  if (plan.value("first_motion", false)) limits.lines.emplace_back("the first motion of this robot");
  if (plan.contains("clear_space")) document.sections.push_back(space(plan["clear_space"]));
  document.sections.push_back(limits);
  return document;
}

}  // namespace odomcalib::cli
