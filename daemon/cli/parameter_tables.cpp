#include "daemon/cli/parameter_tables.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/cli/display.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

std::string millimetres(const ordered_json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) return "-";
  return fmt::format("{:.3f}", 1000.0 * found->get<double>());
}

std::string value_in(const ordered_json& object, const char* name, const std::string& unit) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) return "-";
  return shown(found->get<double>(), unit);
}

/// Where values are applied, each place once: it takes too many words for a column.
std::vector<std::string> places_of(const ordered_json& parameters) {
  std::vector<std::pair<std::string, std::string>> places;
  for (const auto& p : parameters) {
    const std::string place = p.value("applied_in", ""), name = readable(p.value("name", ""));
    const auto known =
        std::find_if(places.begin(), places.end(), [&](const auto& one) { return one.first == place; });
    if (known == places.end())
      places.emplace_back(place, name);
    else
      known->second += ", " + name;
  }
  std::vector<std::string> lines;
  for (const auto& [place, names] : places)
    if (!place.empty()) lines.push_back(fmt::format("applied in {}: {}", place, names));
  return lines;
}

Section parameter_section(const ordered_json& parameters) {
  Section section{"", places_of(parameters), {{"", "in force", "calibrated", "unit", "stored in"}, {}}};
  for (const auto& p : parameters) {
    const std::string unit = p.value("unit", "");
    section.table.rows.push_back({readable(p.value("name", "")), value_in(p, "value", unit),
                                  value_in(p, "calibrated", unit), display_of(unit).unit,
                                  p.value("stored_in", "")});
  }
  return section;
}

std::string change_of(const ordered_json& entry, const char* name) {
  const auto side = [&](const char* when) {
    return millimetres(entry.value(when, ordered_json::object()), name);
  };
  return side("before") + " -> " + side("after");
}

std::string moment_of(std::int64_t us) {
  return fmt::format("{:%Y-%m-%d %H:%M}", fmt::gmtime(static_cast<std::time_t>(us / 1'000'000)));
}

std::string user_of(const ordered_json& entry) {
  const auto found = entry.find("user");
  if (found == entry.end() || !found->is_number_unsigned()) return "-";
  const std::string name = entry.value("user_name", "");
  return (name.empty() ? "" : name + " ") + fmt::format("({})", found->get<std::uint32_t>());
}

std::string action_of(const ordered_json& entry) {
  const std::string restores = entry.value("restores", "");
  return entry.value("action", "") + (restores.empty() ? "" : " before " + restores);
}

std::string outcome_of(const ordered_json& entry) {
  std::string outcome = readable(entry.value("outcome", ""));
  if (outcome != "committed" || !entry.contains("proven")) return outcome;
  return outcome + (entry["proven"] == true ? ", proven" : ", unproven");
}

Table history_table(const ordered_json& entries) {
  Table table{{"id", "when (UTC)", "by", "action", "outcome"}, {}};
  for (const BaseQuantity length : kDriveLengths) table.head.push_back(readable(name_of(length)) + " mm");
  for (const auto& entry : entries) {
    table.rows.push_back({entry.value("id", ""), moment_of(entry.value("time", std::int64_t{0})),
                          user_of(entry), action_of(entry), outcome_of(entry)});
    for (const BaseQuantity length : kDriveLengths)
      table.rows.back().push_back(change_of(entry, name_of(length)));
  }
  return table;
}

bool is_committed(const ordered_json& entry) { return entry.value("outcome", "") == "committed"; }

std::string sentence_of(const ordered_json& entry) {
  const std::string user = user_of(entry);
  std::string text =
      fmt::format("This calibration was {} on {} UTC", is_committed(entry) ? "written" : "to be written",
                  moment_of(entry.value("time", std::int64_t{0})));
  if (user != "-") text += " by " + user;
  return text + fmt::format(", entry {}: {}.", entry.value("id", ""), outcome_of(entry));
}

/// Sentences on the newest entry that wrote one calibration, and on what was written since.
std::vector<std::string> written_lines(const ordered_json& entries, const std::string& sha256) {
  const auto own = std::find_if(entries.begin(), entries.end(), [&](const auto& entry) {
    return entry.value("calibration_sha256", "") == sha256;
  });
  if (own == entries.end())
    return {"No entry names this calibration: these are other write-backs of its robot."};
  std::vector<std::string> lines = {sentence_of(*own)};
  std::string later;
  for (auto entry = entries.begin(); entry != own; ++entry)
    if (is_committed(*entry)) later += (later.empty() ? "" : ", ") + entry->value("id", "");
  if (!later.empty()) lines.push_back("Other values were written since: " + later + ".");
  if (is_committed(*own) && !own->value("proven", false))
    lines.emplace_back("No drive compared odometry before and after: odomcalibctl calibrate --apply does.");
  return lines;
}

// The values that were written, or would be, and those that they replace.
Section change_section(const ordered_json& result) {
  Section section{"", {}, {{"", "old -> new, mm"}, {}}};
  const auto after = result.value("after", ordered_json::object());
  for (const BaseQuantity length : kDriveLengths)
    if (const char* name = name_of(length); after.contains(name))
      section.table.rows.push_back({readable(name), change_of(result, name)});
  return section;
}

}  // namespace

Document describe_parameters(const ordered_json& parameters) {
  return {"Parameters in force", {parameter_section(parameters)}};
}

Document describe_history(const ordered_json& entries) {
  return {"Write-backs, newest first", {{"", {}, history_table(entries)}}};
}

namespace {

/// Those of all entries, below each other.
Table trials_of(const ordered_json& entries) {
  Table all;
  for (const auto& entry : entries) {
    const ordered_json trial = entry.value("trial", ordered_json::object());
    const DriveTrial driven{drive_errors_from(trial.value("before", ordered_json())),
                            drive_errors_from(trial.value("after", ordered_json()))};
    if (driven.is_empty()) continue;
    Table own = trial_table(driven);
    own.head.insert(own.head.begin() + 1, "entry");
    for (auto& row : own.rows) row.insert(row.begin() + 1, entry.value("id", ""));
    all.head = own.head;
    all.rows.insert(all.rows.end(), own.rows.begin(), own.rows.end());
  }
  return all;
}

}  // namespace

Table trial_table(const DriveTrial& trial) {
  Table table{{"odometry off by", "before", "after", "unit"}, {}};
  for (const DriveFigure& one : drive_figures()) {
    const auto text = [&](const std::optional<DriveErrors>& errors) {
      return errors ? fmt::format("{:.2f}", one.factor * (*errors).*one.value) : "-";
    };
    table.rows.push_back({one.words, text(trial.before), text(trial.after), one.unit});
  }
  return table;
}

std::vector<Section> write_back_sections(const ordered_json& entries, const std::string& sha256) {
  if (entries.empty()) return {};
  std::vector<Section> sections = {
      {"Written to the controller", written_lines(entries, sha256), history_table(entries)}};
  if (Table driven = trials_of(entries); !driven.rows.empty())
    sections.push_back(
        {"Trials: odometry against the lidar, driven with the values before an entry and with "
         "those that it wrote",
         {},
         std::move(driven)});
  return sections;
}

Document describe_write_back(const ordered_json& result) {
  const bool dry = result.value("outcome", "") == "dry_run";
  std::string steps;
  for (const auto& step : result.value("steps", ordered_json::array()))
    steps += (steps.empty() ? "" : ", ") + readable(step.is_string() ? step.get<std::string>() : step.dump());
  if (dry) steps = "would be written:";
  Document document{dry ? "dry run, nothing was written" : readable(result.value("outcome", "")),
                    {{"", {steps}, {}}, change_section(result)}};
  if (result.contains("goes_to"))
    document.sections.front().lines.insert(document.sections.front().lines.begin(),
                                           "goes back to " + result.value("goes_to", ""));
  for (const auto& what : result.value("asks", ordered_json::array()))
    document.sections.front().lines.push_back("to be vouched for: " + what.get<std::string>());
  document.sections.push_back(parameter_section(result.value("parameters", ordered_json::array())));
  return document;
}

Document describe_checks(const ordered_json& checks) {
  Section section{"", {}, {{"check", "outcome", "found", "remedy"}, {}}};
  for (const auto& check : checks) {
    std::vector<std::string> row;
    for (const char* column : {"name", "outcome", "found", "remedy"}) row.push_back(check.value(column, ""));
    section.table.rows.push_back(std::move(row));
  }
  return {"What is possible", {section}};
}

}  // namespace odomcalib::cli
