#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "calib/ingest/put_right.hpp"
#include "daemon/cli/display.hpp"
#include "daemon/cli/inspection.hpp"
#include "daemon/cli/left_out_lines.hpp"
#include "daemon/cli/output.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/angles.hpp"
#include "proto/calibration/discarded_json.hpp"
#include "proto/calibration/utc.hpp"
#include "proto/recording/left_out.hpp"

namespace odomcalib::cli {
namespace {

using calib::classical::MotionKind;
using calib::classical::ParameterSupply;
using calib::classical::Supply;
using nlohmann::ordered_json;

double rate_of(const TopicOverview& topic) {
  const std::size_t read = topic.messages - topic.malformed;
  const double length = topic.begin && topic.end ? *topic.end - *topic.begin : 0.0;
  return length > 0.0 && read > 1 ? static_cast<double>(read - 1) / length : 0.0;
}

std::string rate_text(double rate) { return rate > 0.0 ? fmt::format("{:.1f}", rate) : "-"; }

std::string gap_text(double gap) { return gap > 0.0 ? fmt::format("{:.2g}", gap) : "-"; }

std::string remark_on(const TopicOverview& topic) {
  std::vector<std::string> words;
  if (!topic.unread.empty()) words.push_back(topic.unread);
  if (!topic.frames.empty()) words.push_back("frame " + fmt::format("{}", fmt::join(topic.frames, ", ")));
  if (!topic.joints.empty()) words.push_back("joints " + fmt::format("{}", fmt::join(topic.joints, ", ")));
  if (topic.malformed > 0) words.push_back(fmt::format("{} do not hold what the type says", topic.malformed));
  if (topic.without_stamp > 0) words.push_back(fmt::format("{} without a stamp", topic.without_stamp));
  return fmt::format("{}", fmt::join(words, "; "));
}

Section topics_section(const Overview& overview) {
  Section section{"Topics", {}, {{"topic", "messages", "1/s", "longest gap s", "type, frames, joints"}, {}}};
  for (const TopicOverview& topic : overview.topics) {
    if (section.table.rows.size() == settings::kTopicLines) break;
    const std::string remark = remark_on(topic);
    section.table.rows.push_back({topic.name, fmt::format("{}", topic.messages), rate_text(rate_of(topic)),
                                  gap_text(topic.longest_gap),
                                  topic.type + (remark.empty() ? "" : ": " + remark)});
  }
  if (overview.topics.size() > settings::kTopicLines)
    section.lines = {
        fmt::format("the first {} of {}; --json has all", settings::kTopicLines, overview.topics.size())};
  return section;
}

Section streams_section(const Inspection& found) {
  Section section{"Samples", {}, {{"", "samples", "1/s", "longest gap s", "from s", "to s"}, {}}};
  for (const StreamSummary& one : found.streams)
    section.table.rows.push_back({readable(one.name), fmt::format("{}", one.samples), rate_text(one.rate()),
                                  gap_text(one.longest_gap), fmt::format("{:.2f}", one.begin),
                                  fmt::format("{:.2f}", one.end)});
  return section;
}

std::string beams_text(const ScanSummary& scans) {
  if (scans.fewest_beams == scans.most_beams) return fmt::format("{} beams", scans.most_beams);
  return fmt::format("{} to {} beams", scans.fewest_beams, scans.most_beams);
}

Section scans_section(const ScanSummary& scans) {
  Section section{"Scans", {}, {}};
  section.lines.push_back(fmt::format(
      "{} over {:.0f} degrees, {:g} to {:g} m; {:.0f} % of the beams have a reading", beams_text(scans),
      scans.field_of_view * kDegrees, scans.range_min, scans.range_max, 100.0 * scans.share_read));
  section.lines.emplace_back(scans.states_times
                                 ? "the times of the beams are stated"
                                 : "the times of the beams are not stated: they are estimated");
  if (scans.sensors.size() > 1) {
    std::vector<std::string> words;
    for (const auto& [name, count] : scans.sensors) words.push_back(fmt::format("{} ({})", name, count));
    section.lines.push_back(fmt::format("of {} lidars: {}; solve takes one of them (--sensor)",
                                        scans.sensors.size(), fmt::join(words, ", ")));
  }
  return section;
}

/// Data that solve would take, and data that it would leave out or put right.
Section taken_section(const Inspection& found) {
  Section section{"What solve takes", {}, {}};
  if (found.error) section.lines.push_back("nothing as it stands: " + found.error->text());
  if (!found.recording) {
    for (const std::string& remark : found.error->remarks) section.lines.push_back(remark);
    return section;
  }
  for (const std::string& choice : found.recording->choices) section.lines.push_back(choice);
  for (const Repair& one : found.recording->repairs)
    section.lines.push_back(fmt::format("put right: {}: {}: {}", one.what, one.chosen, one.reason));
  for (const std::string& line : evidence_lines(*found.recording)) section.lines.push_back(line);
  if (const auto word = calib::ingest::word_on_unused_scans(*found.recording)) section.lines.push_back(*word);
  if (!found.recording->robot.lidar_pose && found.recording->poses.empty() && found.scans)
    section.lines.emplace_back("nobody states the pose of the lidar: it is estimated from zero on");
  return section;
}

Section motion_section(const Inspection& found) {
  const auto& kinds = found.motion->kinds;
  Section section{"Motion, by nominal values", {}, {{"", "stretches", "in all"}, {}}};
  const auto add = [&](const char* name, const MotionKind& kind, bool turn) {
    section.table.rows.push_back(
        {name, fmt::format("{}", kind.stretches),
         turn ? fmt::format("{:.0f} deg", kind.amount * kDegrees) : fmt::format("{:.2f} m", kind.amount)});
  };
  add("straight forward", kinds.forward, false);
  add("straight backward", kinds.backward, false);
  add("on the spot, left", kinds.spin_left, true);
  add("on the spot, right", kinds.spin_right, true);
  add("in bends, left", kinds.arc_left, true);
  add("in bends, right", kinds.arc_right, true);
  section.table.rows.push_back({"stops of half a second", fmt::format("{}", kinds.stops), ""});
  if (!found.assumed.empty())
    section.lines.push_back(fmt::format("nobody states {}: usual values were assumed to count this",
                                        fmt::join(found.assumed, ", ")));
  return section;
}

std::string amount_text(double amount, bool turns) {
  return turns ? fmt::format("{:.0f} deg", amount * kDegrees) : fmt::format("{:.2f} m", amount);
}

const char* name_of(Supply supply) {
  if (supply == Supply::missing) return "missing";
  return supply == Supply::little ? "little" : "enough";
}

Section supply_section(const Inspection& found) {
  Section section{"What that is enough for", {}, {{"parameters", "shown by", "there is", "wanted", ""}, {}}};
  for (const ParameterSupply& one : found.motion->supply) {
    std::string names = one.parameters;
    section.table.rows.push_back(
        {readable(names), one.shown_by,
         amount_text(one.first_way, one.of_turns) + " and " + amount_text(one.other_way, one.of_turns),
         amount_text(one.each_way, one.of_turns), name_of(one.supply)});
  }
  if (!found.scans && found.recording->poses.empty() && found.recording->increments.empty())
    section.lines.emplace_back("neither scans nor poses: there is nothing to compare the wheels with");
  return section;
}

/// On the clock of the world, where the recording tells it.
std::string time_text(const Inspection& found) {
  double begin = 0.0, end = 0.0;
  for (const StreamSummary& one : found.streams) {
    begin = &one == found.streams.data() ? one.begin : std::min(begin, one.begin);
    end = std::max(end, one.end);
  }
  const double zero = found.recording ? found.recording->time_zero : 0.0;
  const std::string date = is_date(zero + begin) ? ", begun " + utc_text(zero + begin) : ", without a date";
  return fmt::format(", {:.0f} s{}", end - begin, date);
}

std::string subject(const Inspection& found) {
  return found.path + ": " + found.overview.form + (found.streams.empty() ? "" : time_text(found));
}

bool has(const Inspection& found, Supply supply) {
  return found.motion && std::any_of(found.motion->supply.begin(), found.motion->supply.end(),
                                     [&](const ParameterSupply& one) { return one.supply == supply; });
}

std::string next_text(const Inspection& found) {
  if (found.error) return "Next: mend what solve would stop at (\"nothing as it stands\" above).";
  if (has(found, Supply::missing)) return "Next: solve may refuse this; drive what is missing.";
  const std::string next = "Next: odomcalibctl solve " + found.solve_arguments;
  return has(found, Supply::little) ? next + "; what has little motion will be known less well" : next;
}

// --- JSON ------------------------------------------------------------------------------------------------

ordered_json json_of(const TopicOverview& topic) {
  return {{"name", topic.name},
          {"type", topic.type},
          {"unread", topic.unread.empty() ? ordered_json(nullptr) : ordered_json(topic.unread)},
          {"messages", topic.messages},
          {"malformed", topic.malformed},
          {"without_stamp", topic.without_stamp},
          {"begin", topic.begin ? ordered_json(*topic.begin) : ordered_json(nullptr)},
          {"end", topic.end ? ordered_json(*topic.end) : ordered_json(nullptr)},
          {"rate", rate_of(topic)},
          {"longest_gap", topic.longest_gap},
          {"frames", topic.frames},
          {"joints", topic.joints}};
}

ordered_json json_of(const std::optional<ScanSummary>& scans) {
  if (!scans) return nullptr;
  return {{"fewest_beams", scans->fewest_beams},   {"most_beams", scans->most_beams},
          {"field_of_view", scans->field_of_view}, {"range_min", scans->range_min},
          {"range_max", scans->range_max},         {"share_read", scans->share_read},
          {"states_times", scans->states_times},   {"sensors", scans->sensors}};
}

ordered_json json_of(const MotionKind& kind) {
  return {{"stretches", kind.stretches}, {"amount", kind.amount}};
}

ordered_json json_of(const std::optional<Motion>& motion) {
  if (!motion) return nullptr;
  const auto& kinds = motion->kinds;
  return {{"straight_forward", json_of(kinds.forward)},
          {"straight_backward", json_of(kinds.backward)},
          {"spin_left", json_of(kinds.spin_left)},
          {"spin_right", json_of(kinds.spin_right)},
          {"bend_left", json_of(kinds.arc_left)},
          {"bend_right", json_of(kinds.arc_right)},
          {"stops", kinds.stops},
          {"way_forward", kinds.way_forward},
          {"way_backward", kinds.way_backward}};
}

ordered_json supply_of(const std::optional<Motion>& motion) {
  ordered_json all = ordered_json::array();
  if (!motion) return all;
  for (const ParameterSupply& one : motion->supply)
    all.push_back({{"parameters", one.parameters},
                   {"shown_by", one.shown_by},
                   {"there", {one.first_way, one.other_way}},
                   {"each_way", one.each_way},
                   {"unit", one.of_turns ? "rad" : "m"},
                   {"supply", name_of(one.supply)}});
  return all;
}

}  // namespace

Document describe(const Inspection& found) {
  Document document{subject(found), {}};
  const auto add = [&document](Section section) {
    if (!section.lines.empty() || !section.table.rows.empty())
      document.sections.push_back(std::move(section));
  };
  add(topics_section(found.overview));
  add(streams_section(found));
  if (found.scans) add(scans_section(*found.scans));
  add(taken_section(found));
  if (found.motion) {
    add(motion_section(found));
    add(supply_section(found));
  }
  add({"", {next_text(found)}, {}});
  return document;
}

ordered_json to_json(const Inspection& found) {
  ordered_json topics = ordered_json::array(), streams = ordered_json::array();
  for (const TopicOverview& topic : found.overview.topics) topics.push_back(json_of(topic));
  for (const StreamSummary& one : found.streams)
    streams.push_back({{"name", one.name},
                       {"samples", one.samples},
                       {"rate", one.rate()},
                       {"longest_gap", one.longest_gap},
                       {"begin", one.begin},
                       {"end", one.end}});
  const Recording none;
  const Recording& recording = found.recording ? *found.recording : none;
  ordered_json out = {{"file", found.path},
                      {"form", found.overview.form},
                      {"time_zero", recording.time_zero},
                      {"topics", std::move(topics)},
                      {"streams", std::move(streams)},
                      {"scans", json_of(found.scans)},
                      {"error", found.error ? to_json(*found.error) : ordered_json(nullptr)},
                      {"choices", found.recording ? recording.choices : found.error->remarks},
                      {"discarded", to_json(left_out_of(recording))},
                      {"repairs", to_json(recording.repairs)},
                      {"assumed", found.assumed},
                      {"motion", json_of(found.motion)},
                      {"supply", supply_of(found.motion)}};
  return out;
}

}  // namespace odomcalib::cli
