#include "daemon/cli/plan_document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace odomcalib::cli {
namespace {

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
