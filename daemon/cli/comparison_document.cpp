#include "daemon/cli/comparison_document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "calib/odometry/predict.hpp"
#include "daemon/cli/calibration_document.hpp"
#include "daemon/cli/display.hpp"
#include "daemon/cli/usable_calibration.hpp"
#include "proto/angles.hpp"
#include "proto/base_quantities.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib::cli {
namespace {

namespace comparison = calib::comparison;
using comparison::Change;
using comparison::Difference;
using comparison::LoneEffect;
using comparison::Metre;
using comparison::Urgency;

// Characters of "2026-05-04", where the time begins behind it, and characters of "22:15".
constexpr std::size_t kDate = 10, kTimeAt = 11, kTime = 5;

std::string day_of(double t) { return is_date(t) ? utc_text(t).substr(0, kDate) : "-"; }

std::string minute_of(double t) {
  return is_date(t) ? day_of(t) + " " + utc_text(t).substr(kTimeAt, kTime) : "-";
}

/// Whether another file of the robot has the same text about when it was driven.
template <typename Text>
bool is_shared(const ComparedRobot& robot, const ComparedFile& file, Text text_of) {
  return std::any_of(robot.files.begin(), robot.files.end(), [&](const ComparedFile& other) {
    return &other != &file && other.calibration.driven &&
           text_of(other.calibration.driven->begin) == text_of(file.calibration.driven->begin);
  });
}

/// The day, with the time where another drive is of the same day.
std::string when_driven(const ComparedRobot& robot, const ComparedFile& file) {
  if (!file.calibration.driven) return "-";
  const double begin = file.calibration.driven->begin;
  return is_shared(robot, file, day_of) ? minute_of(begin) : day_of(begin);
}

/// Names one of the files; they are told apart by name where the time does not do it.
std::string label_of(const ComparedRobot& robot, const ComparedFile& file) {
  if (!robot.by_date) return file_name(file.path);
  const std::string when = when_driven(robot, file);
  return is_shared(robot, file, minute_of) ? fmt::format("{} ({})", when, file_name(file.path)) : when;
}

std::string robot_name(const ComparedRobot& robot) {
  return robot.robot_id.empty() ? "robot without a name" : "robot " + robot.robot_id;
}

std::string p_text(double p) { return p < 1e-4 ? "p < 0.0001" : fmt::format("p {:.2g}", p); }

std::string sigmas(const Change& change) { return fmt::format("{:+.1f}", change.deviations()); }

std::vector<std::string> names_of_changed(const std::vector<Change>& changes) {
  std::vector<std::string> names;
  for (const Change& one : changes)
    if (one.is_change()) names.push_back(readable(one.name));
  return names;
}

/// The most significant one, where none is significant alone.
const Change* farthest(const Difference& difference) {
  const auto& all = difference.parameters;
  const auto found = std::max_element(all.begin(), all.end(), [](const Change& a, const Change& b) {
    return std::abs(a.deviations()) < std::abs(b.deviations());
  });
  return found == all.end() ? nullptr : &*found;
}

bool is_empty(const Difference& difference) { return difference.joint.is_empty(); }

/// Parameters, values of effects, and effects that came or went by more than chance.
std::vector<std::string> all_that_changed(const Difference& difference) {
  std::vector<std::string> names = names_of_changed(difference.parameters);
  for (std::string& name : names_of_changed(difference.effects)) names.push_back(std::move(name));
  for (const LoneEffect& effect : difference.came)
    if (effect.is_change()) names.push_back(readable(effect.name) + " came");
  for (const LoneEffect& effect : difference.went)
    if (effect.is_change()) names.push_back(readable(effect.name) + " went");
  return names;
}

/// Effects that are in one of both, which may be chance.
std::vector<std::string> doubtful_effects(const Difference& difference) {
  std::vector<std::string> names;
  for (const auto* effects : {&difference.came, &difference.went})
    for (const LoneEffect& effect : *effects)
      if (!effect.is_change()) names.push_back(readable(effect.name));
  return names;
}

std::string what_changed(const Difference& difference) {
  const std::vector<std::string> names = all_that_changed(difference);
  if (!names.empty()) return fmt::format("{}", fmt::join(names, ", "));
  if (is_empty(difference)) return "nothing in common";
  const Change* most = farthest(difference);
  if (difference.joint.is_change() && most != nullptr) return "together; most of all " + readable(most->name);
  const std::vector<std::string> doubtful = doubtful_effects(difference);
  return doubtful.empty() ? "nothing" : fmt::format("nothing; in one only: {}", fmt::join(doubtful, ", "));
}

std::string error_text(const comparison::Estimate& error, const std::string& unit, double factor, int digits,
                       const char* more, const char* less) {
  return fmt::format("{:.{}f} +- {:.{}f} {} {}", std::abs(error.value) * factor, digits,
                     2.0 * error.std * factor, digits, unit, error.value > 0.0 ? more : less);
}

/// Effect of the change on odometry.
std::string in_words(const Difference& difference) {
  if (!difference.metre_error) return "";
  std::string text = "by the values before, odometry now reads a metre " +
                     error_text(*difference.metre_error, "mm", 1000.0, 2, "too long", "too short");
  if (difference.turn_error)
    text += " and a full turn " +
            error_text(*difference.turn_error, "degrees", kDegrees, 2, "too far", "too little");
  text += " (+-2 sigma)";
  if (difference.has_effects)
    text += "; this holds for the lengths alone: what effects make of odometry is not in it";
  return text;
}

std::string metre_text(const ComparedRobot& robot, const Difference& difference) {
  if (difference.metre == Metre::unstated)
    return "no file states how long the metre of its reference is: it is taken to be the same in all";
  if (difference.metre == Metre::apart)
    return "the metres of the references are not the same: the error of each is in the deviations";
  const auto& scale = robot.usable_file(0).calibration.scale;
  return fmt::format(
      "the metre of the reference ({}, +-{:.3g} %) is the same in all: its error cancels in "
      "differences, if the lidar is still the same",
      scale->source, 100.0 * 2.0 * scale->std / scale->value);
}

/// The effect, and whether it is more than chance that the other drives did not show it.
std::string lone_text(const LoneEffect& effect) {
  const std::string name = readable(effect.name);
  if (!effect.smallest) return name + " (whether the other drives would have shown it cannot be told)";
  const Quantity& found = effect.value.quantity;
  const Display show = display_of(found.unit);
  const auto shown = [&](double size) {
    return fmt::format("{:.3g}{}{}", size * show.factor, show.unit.empty() ? "" : " ", show.unit);
  };
  const std::string parameter = effect.value.name.substr(effect.name.size() + 2);
  return fmt::format("{} ({} {}; the other drives would have shown {}{})", name, readable(parameter),
                     shown(found.value), shown(*effect.smallest),
                     effect.is_change() ? "" : ": with its deviation it may be chance");
}

std::string effects_text(const Difference& difference) {
  std::string text;
  const auto add = [&text](const char* what, const std::vector<LoneEffect>& effects) {
    std::vector<std::string> names(effects.size());
    std::transform(effects.begin(), effects.end(), names.begin(), lone_text);
    if (names.empty()) return;
    text += (text.empty() ? "" : "; ") + std::string(what) + fmt::format("{}", fmt::join(names, ", "));
  };
  add("effects that came: ", difference.came);
  add("effects that went: ", difference.went);
  if (!text.empty()) text += "; the other values are of another model then";
  return text;
}

std::vector<std::string> change_row(const Change& change) {
  const Display show = display_of(change.unit);
  return {readable(change.name),
          number(change.before * show.factor, show.digits),
          number(change.after * show.factor, show.digits),
          fmt::format("{:+.{}f}", change.difference() * show.factor, show.digits),
          number(2.0 * change.std * show.factor, show.digits),
          show.unit,
          sigmas(change),
          change.is_change() ? "changed" : ""};
}

void add_line(Section& section, const std::string& text) {
  if (!text.empty()) section.lines.push_back(text);
}

/// From one calibration to a later one.
Section difference_section(const std::string& title, const Difference& difference) {
  Section section{title, {}, {{"", "before", "after", "change", "+-2 sigma", "unit", "sigmas", ""}, {}}};
  for (const Change& one : difference.parameters) section.table.rows.push_back(change_row(one));
  for (const Change& one : difference.effects) section.table.rows.push_back(change_row(one));
  if (is_empty(difference))
    add_line(section, "nothing to compare: no value is in both with a deviation");
  else
    add_line(section,
             fmt::format("changed: {}; joint test of \"nothing changed\": chi-squared {:.1f} of {}, {}",
                         what_changed(difference), difference.joint.statistic, difference.joint.freedom,
                         p_text(difference.joint.p_value)));
  add_line(section, in_words(difference));
  add_line(section, effects_text(difference));
  return section;
}

std::string from_to(const ComparedRobot& robot, std::size_t from, std::size_t to) {
  return label_of(robot, robot.usable_file(from)) + " to " + label_of(robot, robot.usable_file(to));
}

/// A line a step.
Section steps_section(const ComparedRobot& robot) {
  Section section{"Steps", {}, {{"from", "to", "metre mm/m", "turn deg", "p", "changed"}, {}}};
  for (std::size_t k = 0; k < robot.steps.size(); ++k) {
    const Difference& step = robot.steps[k];
    const auto shown = [](const std::optional<comparison::Estimate>& error, double factor) {
      return error ? fmt::format("{:+.2f}", error->value * factor) : std::string("-");
    };
    section.table.rows.push_back(
        {label_of(robot, robot.usable_file(k)), label_of(robot, robot.usable_file(k + 1)),
         shown(step.metre_error, 1000.0), shown(step.turn_error, kDegrees),
         is_empty(step) ? "-" : fmt::format("{:.2g}", step.joint.p_value), what_changed(step)});
  }
  section.lines = {"metre, turn: what odometry by the values before reads too much, or (-) too little"};
  return section;
}

std::string order_text(const ComparedRobot& robot) {
  return robot.by_date ? "in order of the dates of their drives"
                       : "in the order in which they were named: not every recording tells its date";
}

std::string files_text(const ComparedRobot& robot) {
  if (robot.files.size() < 2) return "one calibration";
  return fmt::format("{} calibrations, {}", robot.files.size(), order_text(robot));
}

/// The files, and which of them were left out.
Section files_section(const ComparedRobot& robot) {
  Section section{"Files", {}, {{"file", "driven", "verdict", ""}, {}}};
  for (const ComparedFile& file : robot.files) {
    section.table.rows.push_back({file_name(file.path), when_driven(robot, file),
                                  readable(name_of(file.calibration.verdict)),
                                  file.left_out.empty() ? "" : "left out: " + file.left_out});
  }
  return section;
}

/// Whether the counts of a turn differ, among the files whose recordings have counts.
bool counts_differ(const ComparedRobot& robot) {
  std::set<double> counts;
  for (const ComparedFile& file : robot.files)
    if (const auto of_turn = counts_a_turn(file.calibration)) counts.insert(*of_turn);
  return counts.size() > 1;
}

/// Files that were taken to be of the only robot that another one names.
std::string unnamed_text(const ComparedRobot& robot) {
  std::vector<std::string> unnamed;
  for (const ComparedFile& file : robot.files)
    if (!robot.robot_id.empty() && file.calibration.robot.robot_id.empty())
      unnamed.push_back(file_name(file.path));
  if (unnamed.empty()) return "";
  return fmt::format("{} {} no robot: taken to be of {}", fmt::join(unnamed, ", "),
                     unnamed.size() == 1 ? "names" : "name", robot.robot_id);
}

/// Basis on which to read the numbers below.
Section basis_section(const ComparedRobot& robot) {
  Section section{"", {files_text(robot)}, {}};
  if (const std::string unnamed = unnamed_text(robot); !unnamed.empty()) section.lines.push_back(unnamed);
  if (counts_differ(robot))
    section.lines.emplace_back("they were solved with different ticks_per_rev: diameters are not comparable");
  if (robot.steps.empty()) return section;
  section.lines.push_back(metre_text(robot, robot.overall.value_or(robot.steps.front())));
  if (robot.overall)
    section.lines.push_back(
        fmt::format("joint test of \"nothing changed in any\": chi-squared {:.1f} of {}, {}",
                    robot.all.statistic, robot.all.freedom, p_text(robot.all.p_value)));
  return section;
}

// --- Trends ----------------------------------------------------------------------------------------------

const char* per_unit(TrendAxis::Kind kind) {
  if (kind == TrendAxis::Kind::date) return "day";
  return kind == TrendAxis::Kind::distance ? "km" : "calibration";
}

/// Shown units in one of the axis: a day, a km or a calibration.
double axis_factor(TrendAxis::Kind kind) { return kind == TrendAxis::Kind::distance ? 1e-3 : 1.0; }

struct SlopeDisplay {
  double factor;
  std::string unit;
};

SlopeDisplay slope_display(const std::string& unit, TrendAxis::Kind kind) {
  const bool length = unit == "m";
  const double shown = length ? 1e6 : 1000.0 * kDegrees;
  return {shown / axis_factor(kind), fmt::format("{}/{}", length ? "um" : "mdeg", per_unit(kind))};
}

std::string axis_text(const TrendAxis& axis) {
  if (axis.kind == TrendAxis::Kind::date) return "over date";
  return axis.kind == TrendAxis::Kind::distance ? "over what the robot's counter of distance says"
                                                : "over the number of the calibration";
}

/// Where on the axis, for people.
std::string place_text(const TrendAxis& axis, double x) {
  if (axis.kind == TrendAxis::Kind::date) {
    const double t = axis.zero + x * kDay_s;
    return is_date(t) ? day_of(t) : "after 9999";
  }
  if (axis.kind == TrendAxis::Kind::distance) return fmt::format("{:.4g} km", 1e-3 * x);
  return fmt::format("calibration {:.1f}", x);
}

std::string bound_text(double bound) { return fmt::format("{:g} mm/m", 1000.0 * bound); }

std::string passing_text(const TrendOverAxis& trend, double bound) {
  const auto found = comparison::passing(trend.parameters, bound);
  if (!found)
    return "when a metre passes " + bound_text(bound) + " cannot be told: both diameters are needed";
  const std::string what = "a metre by the newest values is off by " + bound_text(bound) + " ";
  const auto place = [&](double x) { return place_text(trend.axis, x); };
  if (found->at && found->earliest && found->latest)
    return fmt::format("{}at {} (95 %: {} to {}), if the line goes on", what, place(*found->at),
                       place(*found->earliest), place(*found->latest));
  if (found->earliest)
    return fmt::format("{}not before {} (95 %); when it will be cannot be told: the slope may be none", what,
                       place(*found->earliest));
  return "a metre by the newest values stays within " + bound_text(bound) + ", as far as this line tells";
}

std::string scatter_text(const TrendOverAxis& trend) {
  std::vector<std::string> names;
  for (const auto& one : trend.parameters)
    if (one.line && one.line->scatters()) names.push_back(readable(one.name));
  if (names.empty()) return "";
  return fmt::format("more scatter about the line than the deviations say, which grew with it: {}",
                     fmt::join(names, ", "));
}

Section trend_section(const TrendOverAxis& trend, const std::optional<double>& bound) {
  Section section{"Trend " + axis_text(trend.axis), {}, {{"", "slope", "+-2 sigma", "unit", "p", ""}, {}}};
  for (const auto& one : trend.parameters) {
    if (!one.line) continue;
    const SlopeDisplay show = slope_display(one.unit, trend.axis.kind);
    section.table.rows.push_back({readable(one.name), fmt::format("{:+.3g}", one.line->slope * show.factor),
                                  fmt::format("{:.2g}", 2.0 * one.line->slope_std * show.factor), show.unit,
                                  fmt::format("{:.2g}", one.line->p_value),
                                  one.line->is_significant() ? "significant" : ""});
  }
  if (section.table.rows.empty()) section.lines = {"all calibrations are of one time: there is no line"};
  add_line(section, scatter_text(trend));
  if (bound) add_line(section, passing_text(trend, *bound));
  return section;
}

Figure figure_of(const TrendAxis& axis, const comparison::ParameterTrend& trend, bool with_line) {
  const Display show = display_of(trend.unit);
  const double along = axis_factor(axis.kind);
  const std::string x = axis.kind == TrendAxis::Kind::date       ? "days since " + day_of(axis.zero)
                        : axis.kind == TrendAxis::Kind::distance ? "km"
                                                                 : "calibration";
  Figure figure{fmt::format("{} {}. Bars: +-2 sigma.", readable(trend.name), axis_text(axis)),
                x,
                fmt::format("{} [{}]", readable(trend.name), show.unit),
                false,
                {}};
  Curve values{"calibrations", Curve::Style::dots, Curve::Tone::after, {}};
  for (const auto& point : trend.points) {
    values.points.push_back({point.x * along, point.value * show.factor});
    values.errors.push_back(2.0 * point.std * show.factor);
  }
  if (with_line && trend.line) {
    Curve line{"weighted line", Curve::Style::line, Curve::Tone::reference, {}};
    for (const auto& end : {trend.points.front(), trend.points.back()})
      line.points.push_back({end.x * along, trend.line->at(end.x) * show.factor});
    figure.curves.push_back(std::move(line));
  }
  figure.curves.push_back(std::move(values));
  return figure;
}

/// One picture a parameter and axis.
Section pictures_section(const ComparedRobot& robot, bool with_lines) {
  Section section{"Values", {}, {}};
  for (const TrendOverAxis& trend : robot.trends)
    for (const auto& one : trend.parameters)
      section.figures.push_back(figure_of(trend.axis, one, with_lines));
  return section;
}

// --- One robot, many robots ------------------------------------------------------------------------------

void add_once(std::vector<std::string>& names, std::vector<std::string> more) {
  for (std::string& name : more)
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
}

/// The steps, and the whole change where an effect grows too slowly for one of them.
std::vector<const Difference*> judged(const ComparedRobot& robot) {
  std::vector<const Difference*> all;
  for (const Difference& step : robot.steps) all.push_back(&step);
  if (robot.overall && robot.overall->has_changed_effect()) all.push_back(&*robot.overall);
  return all;
}

/// The p-value is of lengths and lidar: beside effects that changed alone it says that these did not.
std::string finding(const ComparedRobot& robot) {
  if (std::all_of(robot.steps.begin(), robot.steps.end(), is_empty)) return "nothing to compare";
  const auto& test = robot.usable.size() > 2 ? robot.all : robot.steps.front().joint;
  bool changed = test.is_change(), by_effects = false;
  std::vector<std::string> names, doubtful;
  for (const Difference* one : judged(robot)) {
    changed = changed || one->joint.is_change() || !names_of_changed(one->parameters).empty();
    by_effects = by_effects || one->has_changed_effect();
    add_once(names, all_that_changed(*one));
    add_once(doubtful, doubtful_effects(*one));
  }
  const std::string p = test.is_empty() ? "" : fmt::format(" ({})", p_text(test.p_value));
  const std::string listed = fmt::format("{}", fmt::join(names, ", "));
  if (changed) return "something changed" + p + (names.empty() ? "" : ": " + listed);
  if (by_effects) return "something changed: " + listed + "; nothing else did" + p;
  if (doubtful.empty()) return "nothing changed" + p;
  return fmt::format("nothing changed{}, but effects are {}: {}", p,
                     robot.usable.size() > 2 ? "not in all" : "in one only", fmt::join(doubtful, ", "));
}

/// Sections, the most important first: the whole change, where it leads, and then how it came about.
std::vector<Section> sections_of(const ComparedRobot& robot, const ComparisonOptions& options,
                                 Extent extent) {
  std::vector<Section> sections{basis_section(robot)};
  if (!robot.steps.empty())
    sections.push_back(difference_section("From " + from_to(robot, 0, robot.usable.size() - 1),
                                          robot.overall.value_or(robot.steps.front())));
  for (const TrendOverAxis& trend : robot.trends)
    if (options.trend) sections.push_back(trend_section(trend, options.bound));
  if (extent == Extent::page) sections.push_back(pictures_section(robot, options.trend));
  if (robot.overall) sections.push_back(steps_section(robot));
  for (std::size_t k = 0; robot.overall && extent != Extent::summary && k < robot.steps.size(); ++k)
    sections.push_back(difference_section("From " + from_to(robot, k, k + 1), robot.steps[k]));
  sections.push_back(files_section(robot));
  return sections;
}

/// Deviation of the newest calibration's value from nominal, %.
std::string over_nominal(const Calibration& calibration, BaseQuantity length) {
  const auto value = calibration.parameter(length), nominal = nominal_value(calibration.robot, length);
  if (!value || !nominal || !std::isfinite(*value)) return "-";
  return fmt::format("{:+.2f}", 100.0 * (*value / *nominal - 1.0));
}

/// By the values before.
std::string metre_of_change(const ComparedRobot& robot) {
  const auto& since = robot.standing.since_last;
  return since && since->metre_error ? fmt::format("{:+.2f}", 1000.0 * since->metre_error->value) : "-";
}

std::vector<std::string> fleet_row(const ComparedRobot& robot, const std::optional<double>& bound) {
  const ComparedFile& newest = robot.files.back();
  const Calibration& calibration = newest.calibration;
  const auto& since = robot.standing.since_last;
  std::vector<std::string> row{robot.robot_id.empty() ? file_name(newest.path) : robot.robot_id,
                               calibration.driven ? day_of(calibration.driven->begin) : "-"};
  for (const BaseQuantity length : kDriveLengths) row.push_back(over_nominal(calibration, length));
  row.insert(row.end(), {comparison::name_of(robot.standing.urgency), metre_of_change(robot),
                         since ? what_changed(*since) : "-"});
  if (!bound) return row;
  const auto found =
      robot.trends.empty() ? std::nullopt : comparison::passing(robot.trends.front().parameters, *bound);
  row.push_back(found && found->at ? place_text(robot.trends.front().axis, *found->at) : "-");
  return row;
}

/// In a fleet they stand alone.
std::vector<std::string> names_of_unnamed(const std::vector<ComparedRobot>& robots) {
  std::vector<std::string> names;
  for (const ComparedRobot& robot : robots)
    if (robot.robot_id.empty()) names.push_back(file_name(robot.files.front().path));
  return names;
}

Section fleet_section(const std::vector<ComparedRobot>& robots, const ComparisonOptions& options) {
  Section section{
      "",
      {"the most urgent first: refused, changed since the calibration before, warnings",
       "left, right, track: newest value over nominal in %; metre: what odometry by the values before "
       "reads too much now, or (-) too little"},
      {{"robot", "driven", "left", "right", "track", "state", "metre mm/m", "changed"}, {}}};
  if (options.bound) section.table.head.push_back("passes " + bound_text(*options.bound));
  for (const ComparedRobot& robot : robots) section.table.rows.push_back(fleet_row(robot, options.bound));
  if (const auto unnamed = names_of_unnamed(robots); !unnamed.empty())
    section.lines.push_back(fmt::format(
        "{} name{} no robot (robot_id), and stand{} alone here; to name it: odomcalibctl solve RECORDING "
        "--robot-id NAME",
        fmt::join(unnamed, ", "), unnamed.size() == 1 ? "s" : "", unnamed.size() == 1 ? "s" : ""));
  return section;
}

Document::Tone tone_of_robots(const std::vector<ComparedRobot>& robots) {
  switch (robots.front().standing.urgency) {
    case Urgency::refused:
      return Document::Tone::bad;
    case Urgency::changed:
    case Urgency::warnings:
      return Document::Tone::doubtful;
    case Urgency::none:
      break;
  }
  return Document::Tone::good;
}

/// Files without a name may be of one robot or of several.
std::string fleet_headline(const std::vector<ComparedRobot>& robots) {
  const std::size_t unnamed = names_of_unnamed(robots).size(), named = robots.size() - unnamed;
  std::string text = named > 0 || unnamed == 0 ? fmt::format("{} robot{}", named, named == 1 ? "" : "s") : "";
  if (unnamed > 0)
    text += fmt::format("{}{} file{} that name{} no robot", text.empty() ? "" : " and ", unnamed,
                        unnamed == 1 ? "" : "s", unnamed == 1 ? "s" : "");
  for (const Urgency urgency : {Urgency::refused, Urgency::changed, Urgency::warnings, Urgency::none}) {
    const auto count = std::count_if(robots.begin(), robots.end(), [&](const ComparedRobot& robot) {
      return robot.standing.urgency == urgency;
    });
    if (count > 0) text += fmt::format(", {} {}", count, comparison::name_of(urgency));
  }
  return text;
}

// --- CSV -------------------------------------------------------------------------------------------------

constexpr const char* kNoChange = ",,,\n";

std::string value_fields(const std::string& name, const Quantity& quantity) {
  return fmt::format(",{},{},{},{}", name, quantity.unit, quantity.value,
                     quantity.std >= 0.0 ? fmt::format("{}", quantity.std) : "");
}

std::string change_fields(const std::vector<Change>& changes, const std::string& name) {
  for (const Change& one : changes)
    if (one.name == name) return fmt::format(",{},{},{}\n", one.difference(), one.std, one.p_value);
  return kNoChange;
}

/// An effect that came has no change, but a p-value of chance.
std::string effect_fields(const Difference* since, const std::string& name) {
  if (since == nullptr) return kNoChange;
  for (const LoneEffect& effect : since->came)
    if (effect.value.name == name) return fmt::format(",,,{}\n", effect.p_value);
  return change_fields(since->effects, name);
}

/// An effect that went has a line without a value.
std::string went_lines(const std::string& of, const Difference& since) {
  std::string out;
  for (const LoneEffect& effect : since.went)
    if (effect.smallest)
      out +=
          fmt::format("{},{},{},,,,,{}\n", of, effect.value.name, effect.value.quantity.unit, effect.p_value);
  return out;
}

}  // namespace

Document describe(const std::vector<ComparedRobot>& robots, const ComparisonOptions& options, Extent extent) {
  if (!options.by_robot) {
    const ComparedRobot& robot = robots.front();
    return {robot_name(robot) + ": " + finding(robot), sections_of(robot, options, extent),
            tone_of_robots(robots)};
  }
  Document document{fleet_headline(robots), {fleet_section(robots, options)}, tone_of_robots(robots)};
  for (const ComparedRobot& robot : robots) {
    if (!options.trend && extent == Extent::summary) continue;
    std::vector<Section> sections = sections_of(robot, options, extent);
    const std::string which = robot.robot_id.empty() ? " (" + file_name(robot.files.front().path) + ")" : "";
    sections.front().title = robot_name(robot) + which + ": " + finding(robot);
    for (Section& section : sections) document.sections.push_back(std::move(section));
  }
  return document;
}

std::string to_csv(const std::vector<ComparedRobot>& robots) {
  std::string out =
      "robot,file,driven_begin,odometer,verdict,parameter,unit,value,std,change,change_std,p_value\n";
  const auto text = [](const std::string& field) {
    if (field.find_first_of(",\"\n") == std::string::npos) return field;
    std::string quoted = "\"";
    for (const char c : field) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
  };
  for (const ComparedRobot& robot : robots)
    for (std::size_t k = 0; k < robot.usable.size(); ++k) {
      const ComparedFile& file = robot.usable_file(k);
      const auto& odometer = file.calibration.odometer;
      const std::string of =
          fmt::format("{},{},{},{},{}", text(robot.robot_id), text(file.path),
                      file.calibration.driven ? utc_text(file.calibration.driven->begin) : "",
                      odometer ? fmt::format("{}", *odometer) : "", name_of(file.calibration.verdict));
      const Difference* since = k > 0 ? &robot.steps[k - 1] : nullptr;
      for (const auto& [name, quantity] : file.calibration.parameters)
        if (std::isfinite(quantity.value))
          out += of + value_fields(name, quantity) +
                 (since == nullptr ? kNoChange : change_fields(since->parameters, name));
      for (const EffectResult& effect : file.calibration.effects)
        for (const comparison::EffectValue& value : comparison::effect_values(effect))
          out += of + value_fields(value.name, value.quantity) + effect_fields(since, value.name);
      if (since != nullptr) out += went_lines(of, *since);
    }
  return out;
}

}  // namespace odomcalib::cli
