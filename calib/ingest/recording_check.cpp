#include "calib/ingest/recording_check.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "calib/ingest/checks.hpp"
#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/ingest/stamp_check.hpp"
#include "calib/ingest/unit_check.hpp"
#include "calib/math/median.hpp"
#include "calib/math/number_text.hpp"
#include "calib/wheels/settings.hpp"
#include "proto/recording/scan_checks.hpp"

namespace odomcalib::calib::ingest {
namespace {

std::string number(double value) { return math::significant(value, 6); }

/// Samples that were dropped for their stamps say more than that they are missing.
std::optional<Error> wrong_stamps(const Recording& recording) {
  for (std::size_t k = 0; k < kForms; ++k)
    if (auto error = no_dates(recording, static_cast<Form>(k))) return error;
  for (std::size_t k = 0; k < kForms; ++k)
    if (auto error = lost_digits(recording, static_cast<Form>(k))) return error;
  return std::nullopt;
}

/// Why nearly nothing is left of a stream, where something was: the reason of most of the samples left out.
std::string what_was_dropped(const Recording& recording, const std::string& what) {
  const Discarded* most = nullptr;
  for (const Discarded& discarded : recording.discarded)
    if (discarded.what == what && (most == nullptr || discarded.count > most->count)) most = &discarded;
  return most == nullptr ? "" : ": " + std::to_string(most->count) + " were left out, " + most->reason;
}

std::optional<Error> missing_stream(const Recording& recording) {
  const bool is_missing =
      recording.ticks.size() < 2 || (recording.poses.size() < 2 && recording.scans.size() < 2);
  if (is_missing)
    if (auto error = wrong_stamps(recording)) return error;
  const Form motion = motion_of(recording);
  if (recording.ticks.size() < 2)
    return Error{ErrorCode::empty,
                 "fewer than two samples of " + std::string(many_of(motion)) +
                     what_was_dropped(recording, name_of(motion)),
                 recording.name, "check that the motion of the wheels was recorded"};
  if (recording.poses.size() == 1 && recording.scans.size() > 1)
    return Error{ErrorCode::empty,
                 "a single reference pose" + what_was_dropped(recording, "pose") + "; it replaces " +
                     std::to_string(recording.scans.size()) + " scans",
                 recording.name, "record more poses, or leave it out to use the scans"};
  if ((recording.poses.empty() ? recording.scans.size() : recording.poses.size()) < 2)
    return Error{ErrorCode::empty, "neither scans nor reference poses" + what_was_dropped(recording, "scan"),
                 recording.name, "check that the lidar was recorded"};
  if (!(recording.robot.ticks_per_rev > 0.0))
    return Error{ErrorCode::missing_units, "ticks_per_rev is missing", recording.name,
                 "add it to the robot line"};
  return std::nullopt;
}

struct Stream {
  std::string name;
  std::vector<double> times;  ///< s, sorted, two at least
};

template <typename Sample>
Stream stream(const std::string& name, const std::vector<Sample>& samples) {
  Stream out{name, {}};
  for (const Sample& sample : samples) out.times.push_back(sample.t);
  return out;
}

double spacing(const Stream& stream) {
  std::vector<double> steps;
  for (std::size_t k = 0; k + 1 < stream.times.size(); ++k)
    steps.push_back(stream.times[k + 1] - stream.times[k]);
  return math::median_of(std::move(steps));
}

std::optional<Error> too_seldom(const Recording& recording, const Stream& stream) {
  const double step = spacing(stream);
  if (step <= settings::kMaxGap_s) return std::nullopt;
  const std::string unit = unit_of_interval(step);
  if (!unit.empty())
    return Error{ErrorCode::format,
                 stream.name + " come every " + number(step) + " s: their times look like " + unit,
                 recording.name, "write every \"t\" in seconds"};
  return Error{ErrorCode::format, stream.name + " come every " + number(step) + " s only", recording.name,
               "record them at least every " + number(settings::kMaxGap_s) + " s"};
}

std::string span_text(const Stream& stream) {
  return stream.name + " run from " + number(stream.times.front()) + " to " + number(stream.times.back()) +
         " s";
}

/// Two clocks of which neither knows the other.
std::optional<Error> clocks_apart(const Recording& recording, const Stream& ticks, const Stream& reference) {
  const bool meet =
      ticks.times.front() <= reference.times.back() && reference.times.front() <= ticks.times.back();
  if (meet) return std::nullopt;
  return Error{ErrorCode::empty, span_text(ticks) + ", " + span_text(reference), recording.name,
               "stamp both with the same clock"};
}

template <typename Count>
bool stands(const Recording& recording, Count count) {
  const auto [low, high] =
      std::minmax_element(recording.ticks.begin(), recording.ticks.end(),
                          [&](const auto& a, const auto& b) { return count(a) < count(b); });
  return count(*high) - count(*low) <= wheels::settings::kStandingCounts;
}

/// One recording may well be of a turn about a wheel.
template <typename Count>
bool always_stands(std::span<const Recording> recordings, Count count) {
  return std::all_of(recordings.begin(), recordings.end(),
                     [&](const Recording& r) { return r.increments.empty() && stands(r, count); });
}

std::optional<Error> standing_counts(std::span<const Recording> recordings) {
  const bool left = always_stands(recordings, [](const TickSample& s) { return s.left; });
  const bool right = always_stands(recordings, [](const TickSample& s) { return s.right; });
  if (!left && !right) return std::nullopt;
  const std::string& name = recordings.front().name;
  if (left && right)
    return Error{ErrorCode::empty, "neither wheel turned", name,
                 "record while the robot drives, or check both encoders"};
  const std::string side = left ? "left" : "right";
  return Error{ErrorCode::empty, "the counts of the " + side + " wheel never change", name,
               "check that wheel's encoder and its cable, or drive with both wheels"};
}

struct ReadingsOutside {
  std::size_t count = 0;
  const RangeUnit* unit = nullptr;  ///< that most of them look like
};

ReadingsOutside readings_outside(const Recording& recording) {
  ReadingsOutside all;
  std::size_t most = 0;
  for (const Discarded& discarded : recording.discarded) {
    if (discarded.what != "beam" || !discarded.reason.starts_with(kOutsideLimits)) continue;
    all.count += discarded.count;
    if (discarded.count <= most) continue;
    most = discarded.count;
    all.unit = range_unit_of_reason(discarded.reason);
  }
  return all;
}

bool is_blind(const Scan& scan) {
  return std::all_of(scan.ranges.begin(), scan.ranges.end(), [](float range) { return range == 0.0F; });
}

std::optional<Error> no_readings(const Recording& recording) {
  if (!std::all_of(recording.scans.begin(), recording.scans.end(), is_blind)) return std::nullopt;
  const ReadingsOutside outside = readings_outside(recording);
  if (outside.count == 0)
    return Error{
        ErrorCode::empty, "no scan has a reading", recording.name,
        "check what covers the lidar, that nothing nearer than its range_min surrounds it, and that there "
        "are walls within its range_max"};
  const Scan& scan = recording.scans.front();
  return Error{ErrorCode::format,
               "all " + std::to_string(outside.count) + " readings lie " + kOutsideLimits + ", " +
                   number(scan.range_min) + " and " + number(scan.range_max) + " m" +
                   (outside.unit == nullptr ? "" : std::string(": they look like ") + outside.unit->name),
               recording.name,
               outside.unit == nullptr ? "ranges and their limits must be in metres"
                                       : "multiply the ranges by " + number(outside.unit->size) +
                                             ": their limits are in metres already"};
}

std::optional<Error> check_one(const Recording& recording) {
  if (!recording.increments.empty()) return std::nullopt;
  if (auto error = missing_stream(recording)) return error;
  if (auto error = told_fault(recording)) return error;
  const bool by_poses = !recording.poses.empty();
  const Stream ticks = stream(many_of(motion_of(recording)), recording.ticks);
  const Stream reference = by_poses ? stream("poses", recording.poses) : stream("scans", recording.scans);
  for (const Stream* one : {&ticks, &reference})
    if (auto error = too_seldom(recording, *one)) return error;
  if (auto error = clocks_apart(recording, ticks, reference)) return error;
  return by_poses ? std::nullopt : no_readings(recording);
}

bool same_size(const RobotDescription& a, const RobotDescription& b) {
  return a.ticks_per_rev == b.ticks_per_rev && a.left_wheel_diameter == b.left_wheel_diameter &&
         a.right_wheel_diameter == b.right_wheel_diameter && a.track_width == b.track_width;
}

std::optional<Error> two_sizes(std::span<const Recording> recordings) {
  for (const Recording& recording : recordings)
    if (!same_size(recording.robot, recordings.front().robot))
      return Error{ErrorCode::format, "nominal values differ from those of " + recordings.front().name,
                   recording.name, "solve recordings of different robots separately"};
  return std::nullopt;
}

std::optional<Error> two_names(std::span<const Recording> recordings) {
  const Recording* known = nullptr;
  for (const Recording& recording : recordings) {
    if (recording.robot.robot_id.empty()) continue;
    if (known == nullptr) known = &recording;
    if (recording.robot.robot_id == known->robot.robot_id) continue;
    return Error{ErrorCode::refused,
                 "is of robot \"" + recording.robot.robot_id + "\", but " + known->name + " of \"" +
                     known->robot.robot_id + "\"",
                 recording.name,
                 "solve each robot's recordings separately, or say --same-robot where only the name changed"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> check_recordings(std::span<const Recording> recordings) {
  for (const Recording& recording : recordings)
    if (auto error = check_one(recording)) return error;
  return standing_counts(recordings);
}

std::optional<Error> two_robots(std::span<const Recording> recordings, bool same_robot) {
  if (auto error = two_sizes(recordings)) return error;
  return same_robot ? std::nullopt : two_names(recordings);
}

}  // namespace odomcalib::calib::ingest
