#include "daemon/cli/parameter_tables.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/cli/display.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

using Lengths = std::map<std::string, double>;  // m, by quantity

std::string millimetres(const Lengths& lengths, const char* name) {
  const auto found = lengths.find(name);
  return found != lengths.end() ? fmt::format("{:.3f}", 1000.0 * found->second) : "-";
}

std::string change_of(const Lengths& before, const Lengths& after, const char* name) {
  return millimetres(before, name) + " -> " + millimetres(after, name);
}

/// Those of them that are numbers.
Lengths lengths_of(const ordered_json& object) {
  Lengths lengths;
  for (const auto& [name, value] : object.items())
    if (value.is_number()) lengths[name] = value.get<double>();
  return lengths;
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

std::string moment_of(std::int64_t us) {
  return fmt::format("{:%Y-%m-%d %H:%M}", fmt::gmtime(static_cast<std::time_t>(us / 1'000'000)));
}

std::string user_of(const WriteBack& one) {
  const auto& user = one.entry.origin.user;
  if (!user) return "-";
  return (one.user_name.empty() ? "" : one.user_name + " ") + fmt::format("({})", *user);
}

std::string action_of(const HistoryEntry& entry) {
  const std::string& restores = entry.origin.restores;
  return entry.action + (restores.empty() ? "" : " before " + restores);
}

bool is_committed(const HistoryEntry& entry) { return entry.outcome == "committed"; }

std::string outcome_of(const HistoryEntry& entry) {
  if (!is_committed(entry)) return readable(entry.outcome);
  return entry.outcome + (entry.origin.proven ? ", proven" : ", unproven");
}

Table history_table(const std::vector<WriteBack>& entries) {
  Table table{{"id", "when (UTC)", "by", "action", "outcome"}, {}};
  for (const BaseQuantity length : kDriveLengths) table.head.push_back(readable(name_of(length)) + " mm");
  for (const WriteBack& one : entries) {
    const HistoryEntry& entry = one.entry;
    table.rows.push_back(
        {entry.id, moment_of(entry.time), user_of(one), action_of(entry), outcome_of(entry)});
    for (const BaseQuantity length : kDriveLengths)
      table.rows.back().push_back(change_of(entry.before, entry.after, name_of(length)));
  }
  return table;
}

std::string sentence_of(const WriteBack& one) {
  const HistoryEntry& entry = one.entry;
  const std::string user = user_of(one);
  std::string text = fmt::format("This calibration was {} on {} UTC",
                                 is_committed(entry) ? "written" : "to be written", moment_of(entry.time));
  if (user != "-") text += " by " + user;
  return text + fmt::format(", entry {}: {}.", entry.id, outcome_of(entry));
}

/// Sentences on the newest entry that wrote one calibration, and on what was written since.
std::vector<std::string> written_lines(const std::vector<WriteBack>& entries, const std::string& sha256) {
  const auto own = std::find_if(entries.begin(), entries.end(), [&](const WriteBack& one) {
    return one.entry.origin.calibration_sha256 == sha256;
  });
  if (own == entries.end())
    return {"No entry names this calibration: these are other write-backs of its robot."};
  std::vector<std::string> lines = {sentence_of(*own)};
  std::string later;
  for (auto one = entries.begin(); one != own; ++one)
    if (is_committed(one->entry)) later += (later.empty() ? "" : ", ") + one->entry.id;
  if (!later.empty()) lines.push_back("Other values were written since: " + later + ".");
  if (is_committed(own->entry) && !own->entry.origin.proven)
    lines.emplace_back("No drive compared odometry before and after: odomcalibctl calibrate --apply does.");
  return lines;
}

// The values that were written, or would be, and those that they replace.
Section change_section(const ordered_json& result) {
  Section section{"", {}, {{"", "old -> new, mm"}, {}}};
  const auto after = result.value("after", ordered_json::object());
  const Lengths old_values = lengths_of(result.value("before", ordered_json::object())),
                new_values = lengths_of(after);
  for (const BaseQuantity length : kDriveLengths)
    if (const char* name = name_of(length); after.contains(name))
      section.table.rows.push_back({readable(name), change_of(old_values, new_values, name)});
  return section;
}

}  // namespace

Document describe_parameters(const ordered_json& parameters) {
  return {"Parameters in force", {parameter_section(parameters)}};
}

Document describe_history(const std::vector<WriteBack>& entries, std::size_t not_understood) {
  Section section{"", {}, history_table(entries)};
  if (not_understood > 0)
    section.lines.push_back(
        fmt::format("{} more of another version of odomcalibd: history --json shows them", not_understood));
  return {"Write-backs, newest first", {std::move(section)}};
}

namespace {

/// Those of all entries, below each other.
Table trials_of(const std::vector<WriteBack>& entries) {
  Table all;
  for (const WriteBack& one : entries) {
    if (one.entry.origin.trial.is_empty()) continue;
    Table own = trial_table(one.entry.origin.trial);
    own.head.insert(own.head.begin() + 1, "entry");
    for (auto& row : own.rows) row.insert(row.begin() + 1, one.entry.id);
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

std::vector<Section> write_back_sections(const std::vector<WriteBack>& entries, const std::string& sha256) {
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
