#include "daemon/cli/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "daemon/cli/settings.hpp"
#include "proto/number_text.hpp"

namespace odomcalib::cli {
namespace {

namespace comparison = calib::comparison;

/// Robots in the order in which they are named first. A file that names none is of the only robot there is;
/// of several, and in a fleet, nobody knows of which: it stands alone.
std::vector<ComparedRobot> grouped(std::vector<ComparedFile> files, bool is_fleet) {
  std::set<std::string> named;
  for (const ComparedFile& file : files)
    if (const auto& id = file.calibration.robot.robot_id; !id.empty()) named.insert(id);
  std::vector<ComparedRobot> robots;
  for (ComparedFile& file : files) {
    const std::string& own = file.calibration.robot.robot_id;
    const std::string id = own.empty() && named.size() == 1 && !is_fleet ? *named.begin() : own;
    const auto same = [&](const ComparedRobot& robot) {
      return robot.robot_id == id && (!id.empty() || (named.empty() && !is_fleet));
    };
    auto found = std::find_if(robots.begin(), robots.end(), same);
    if (found == robots.end()) {
      robots.emplace_back().robot_id = id;
      found = std::prev(robots.end());
    }
    found->files.push_back(std::move(file));
  }
  return robots;
}

bool share_a_recording(const Calibration& a, const Calibration& b) {
  return std::any_of(a.data.begin(), a.data.end(), [&](const DataUse& one) {
    return !one.sha256.empty() && std::any_of(b.data.begin(), b.data.end(), [&](const DataUse& other) {
      return other.sha256 == one.sha256;
    });
  });
}

/// Calibrations of one recording err alike: their difference says nothing of the robot. That of more
/// recordings is compared, and of as many the one that was named last.
void leave_out_repeated(std::vector<ComparedFile>& files) {
  for (std::size_t i = 0; i < files.size(); ++i)
    for (std::size_t k = i + 1; k < files.size(); ++k) {
      ComparedFile &a = files[i], &b = files[k];
      if (!a.left_out.empty() || !b.left_out.empty()) continue;
      if (!share_a_recording(a.calibration, b.calibration)) continue;
      const bool first_has_more = a.calibration.data.size() > b.calibration.data.size();
      (first_has_more ? b : a).left_out = "same recording as " + file_name((first_has_more ? a : b).path);
    }
}

void put_in_order(ComparedRobot& robot) {
  for (ComparedFile& file : robot.files)
    if (file.calibration.verdict == Verdict::refused) file.left_out = "refused";
  leave_out_repeated(robot.files);
  robot.by_date = std::all_of(robot.files.begin(), robot.files.end(),
                              [](const ComparedFile& file) { return file.calibration.driven.has_value(); });
  if (robot.by_date)
    std::stable_sort(robot.files.begin(), robot.files.end(),
                     [](const ComparedFile& a, const ComparedFile& b) {
                       return a.calibration.driven->begin < b.calibration.driven->begin;
                     });
  for (std::size_t k = 0; k < robot.files.size(); ++k)
    if (robot.files[k].left_out.empty()) robot.usable.push_back(k);
}

double middle_of(const Driven& driven) { return 0.5 * (driven.begin + driven.end); }

/// Dates and distances where all files have them; the number of a calibration where they have neither.
std::vector<TrendAxis> axes_of(const std::vector<const Calibration*>& calibrations, bool by_date) {
  TrendAxis date{TrendAxis::Kind::date, 0.0, {}}, distance{TrendAxis::Kind::distance, 0.0, {}},
      number{TrendAxis::Kind::number, 0.0, {}};
  if (by_date) date.zero = std::floor(middle_of(*calibrations.front()->driven) / kDay_s) * kDay_s;
  for (const Calibration* one : calibrations) {
    if (by_date) date.x.push_back((middle_of(*one->driven) - date.zero) / kDay_s);
    if (const auto counted = one->odometer) distance.x.push_back(*counted);
    number.x.push_back(static_cast<double>(number.x.size() + 1));
  }
  std::vector<TrendAxis> axes;
  if (by_date) axes.push_back(std::move(date));
  if (distance.x.size() == calibrations.size()) axes.push_back(std::move(distance));
  if (axes.empty()) axes.push_back(std::move(number));
  return axes;
}

void compute(ComparedRobot& robot) {
  std::vector<const Calibration*> usable;
  for (const std::size_t k : robot.usable) usable.push_back(&robot.files[k].calibration);
  robot.standing = comparison::standing_of(robot.files.back().calibration, usable);
  for (std::size_t k = 1; k < usable.size(); ++k)
    robot.steps.push_back(comparison::difference(*usable[k - 1], *usable[k]));
  robot.all = comparison::homogeneity(usable);
  if (usable.size() > 2) robot.overall = comparison::difference(*usable.front(), *usable.back());
  if (usable.size() < 2) return;
  for (TrendAxis& axis : axes_of(usable, robot.by_date)) {
    auto parameters = comparison::parameter_trends(usable, axis.x);
    robot.trends.push_back({std::move(axis), std::move(parameters)});
  }
}

std::optional<Error> not_comparable(const std::vector<ComparedRobot>& robots) {
  if (robots.size() > 1)
    return Error{ErrorCode::usage,
                 fmt::format(R"(is of robot "{}", but "{}" of "{}")", robots[1].robot_id,
                             robots[0].files.front().path, robots[0].robot_id),
                 robots[1].files.front().path, "compare each robot alone, or all as a table: --by robot"};
  const ComparedRobot& only = robots.front();
  const std::string& last = only.files.back().path;
  if (only.files.size() < 2)
    return Error{ErrorCode::usage, "is one calibration alone", last, "name two or more of one robot"};
  if (only.usable.size() > 1) return std::nullopt;
  const auto repeated = std::find_if(only.files.begin(), only.files.end(), [](const ComparedFile& file) {
    return !file.left_out.empty() && file.calibration.verdict != Verdict::refused;
  });
  if (repeated != only.files.end())
    return Error{ErrorCode::usage, "is of the " + repeated->left_out, repeated->path,
                 "compare calibrations of different drives; one drive is no proof of itself"};
  return Error{ErrorCode::refused,
               fmt::format("{} of {} calibrations were refused", only.files.size() - only.usable.size(),
                           only.files.size()),
               last, "a refused calibration has no values to compare; odomcalibctl report FILE says why"};
}

/// Nobody could say whether something changed.
std::optional<Error> nothing_in_common(const ComparedRobot& robot) {
  const auto is_empty = [](const comparison::Difference& step) { return step.joint.is_empty(); };
  if (!std::all_of(robot.steps.begin(), robot.steps.end(), is_empty)) return std::nullopt;
  return Error{
      ErrorCode::usage,
      "has no value in common with " + file_name(robot.usable_file(0).path) + " that has a deviation in both",
      robot.usable_file(1).path, "compare calibrations of the same values; odomcalibctl report FILE"};
}

std::optional<double> leading_number(const std::string& text, std::string_view unit) {
  if (!text.ends_with(unit)) return std::nullopt;
  return number_from<double>(std::string_view(text).substr(0, text.size() - unit.size()));
}

}  // namespace

Result<double> error_of_metre_from_text(const std::string& text) {
  std::optional<double> bound;
  if (const auto per_mille = leading_number(text, "mm/m")) bound = 1e-3 * *per_mille;
  if (const auto percent = leading_number(text, "%")) bound = 1e-2 * *percent;
  if (bound && *bound > 0.0 && *bound <= settings::kMostErrorOfMetre) return *bound;
  return Error{ErrorCode::usage, "\"" + text + "\" is no bound for the error of a metre", "--until",
               fmt::format("state it in mm/m or %, up to {} %: 5mm/m", 100.0 * settings::kMostErrorOfMetre)};
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

Result<std::vector<ComparedRobot>> compare(std::vector<ComparedFile> files,
                                           const ComparisonOptions& options) {
  std::vector<ComparedRobot> robots = grouped(std::move(files), options.by_robot);
  for (ComparedRobot& robot : robots) put_in_order(robot);
  if (!options.by_robot)
    if (auto error = not_comparable(robots)) return *error;
  for (ComparedRobot& robot : robots) compute(robot);
  if (!options.by_robot)
    if (auto error = nothing_in_common(robots.front())) return *error;
  std::stable_sort(robots.begin(), robots.end(), [](const ComparedRobot& a, const ComparedRobot& b) {
    return a.standing.is_before(b.standing);
  });
  return robots;
}

}  // namespace odomcalib::cli
