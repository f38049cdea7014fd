#include "calib/vehicle/channel.hpp"

#include <array>
#include <cstddef>
#include <initializer_list>

#include "calib/vehicle/enum_set.hpp"

namespace odomcalib::calib::vehicle {

namespace {

/// Properties of a covariate that terms and reports have to know, beside its value.
enum class Trait : unsigned {
  of_the_place,    ///< or of the day: no property of the robot
  from_the_begin,  ///< counted from where each recording begins
  signed_speed,    ///< its sign is the direction
  acceleration,    ///< of a wheel, or of the base forward or to the side
  phase,           ///< of a wheel
  angle,
  memory,            ///< of the last turn or acceleration, however long ago
  since_event,       ///< distance or angle since an event
  angle_of_a_wheel,  ///< the latter
};

struct Channels {
  std::array<Channel, static_cast<std::size_t>(kLastChannel) + 1> list{};
  std::size_t size = 0;
  constexpr Channels(std::initializer_list<Channel> channels) {
    for (const Channel channel : channels) list.at(size++) = channel;
  }
};

struct CovariateRow {
  const char* name;
  const char* manoeuvre;  ///< that shows the most of what depends on it, in a small area; empty: none
  CovariateGroups groups;
  std::size_t memories;  ///< see memories_of
  EnumSet<Trait> traits;
  Channels channels;  ///< see channels_of
};

constexpr std::size_t kOneMemory = kUsualMemory + 1;

using enum Channel;
using enum Trait;

/// In the order of Covariate.
constexpr std::array<CovariateRow, static_cast<std::size_t>(kLastCovariate) + 1> kCovariates = {{
    {"left_speed",
     "straights",
     {},
     kOneMemory,
     {signed_speed},
     {left_travel, left_path, right_travel, right_path}},
    {"right_speed",
     "straights",
     {},
     kOneMemory,
     {signed_speed},
     {right_travel, right_path, left_travel, left_path}},
    {"wheel_speed", "straights", {}, kOneMemory, {signed_speed}, {both_travel}},
    {"speed",
     "straights",
     {},
     kOneMemory,
     {signed_speed},
     {both_travel, left_travel, right_travel, track, sideways, turn_side, both_path, sideways_path,
      yaw_path}},
    {"turn_rate",
     "turns",
     {},
     kOneMemory,
     {signed_speed},
     {both_travel, left_travel, right_travel, track, sideways, turn_path, turn_side, both_path, left_path,
      right_path, sideways_path, yaw_path}},
    {"lateral_acceleration",
     "arcs",
     {},
     kOneMemory,
     {acceleration},
     {sideways, sideways_path, track, both_travel, left_travel, right_travel, both_path, yaw_path}},
    {"left_acceleration", "accelerations", {}, kOneMemory, {acceleration}, {left_travel, left_path}},
    {"right_acceleration", "accelerations", {}, kOneMemory, {acceleration}, {right_travel, right_path}},
    {"acceleration",
     "accelerations",
     {},
     kOneMemory,
     {acceleration},
     {both_travel, both_path, track, sideways_path, yaw_path}},
    {"turn_acceleration", "", {CovariateGroup::sway}, kSwayLags.size(), {}, {sensor_yaw}},
    {"left_phase", "slow_straights", {}, kOneMemory, {phase, angle, from_the_begin}, {left_travel}},
    {"right_phase", "slow_straights", {}, kOneMemory, {phase, angle, from_the_begin}, {right_travel}},
    {"time",
     "",
     {},
     kOneMemory,
     {of_the_place, from_the_begin},
     {both_travel, left_travel, right_travel, track, sideways, turn_side, scale, yaw_path}},
    {"heading",
     "headings",
     {},
     kOneMemory,
     {of_the_place, from_the_begin, angle},
     {both_travel, left_travel, right_travel, both_path, sideways_path, yaw_path}},
    {"position",
     "",
     {},
     kOneMemory,
     {of_the_place, from_the_begin},
     {both_travel, left_travel, right_travel, both_path, sideways_path, yaw_path}},
    {"distance", "", {}, kOneMemory, {from_the_begin}, {}},
    {"since_reversal",
     "reversals",
     {},
     kOneMemory,
     {since_event},
     {both_travel, left_travel, right_travel, track, sideways_path, yaw_path}},
    {"left_since_reversal", "reversals", {}, kOneMemory, {since_event, angle_of_a_wheel}, {left_travel}},
    {"right_since_reversal", "reversals", {}, kOneMemory, {since_event, angle_of_a_wheel}, {right_travel}},
    {"since_stop",
     "accelerations",
     {CovariateGroup::stops},
     kStops.size(),
     {since_event},
     {both_travel, left_travel, right_travel, track, sideways_path, yaw_path}},
    {"previous_turn",
     "turns",
     {CovariateGroup::previous_turn},
     kMemorySpans.size(),
     {memory},
     {both_travel, left_travel, right_travel, track, sideways_path, yaw_path}},
    {"previous_push",
     "accelerations",
     {CovariateGroup::previous_acceleration},
     AccelerationMemory::size(),
     {memory},
     {both_travel, left_travel, right_travel, track}},
}};

const CovariateRow& row_of(Covariate covariate) {
  return kCovariates.at(static_cast<std::size_t>(covariate));
}

bool has(Covariate covariate, Trait trait) { return row_of(covariate).traits.contain(trait); }

}  // namespace

std::string to_string(Covariate covariate) { return row_of(covariate).name; }

CovariateGroups groups_of(Covariate covariate) { return row_of(covariate).groups; }

std::optional<Covariate> covariate_from(const std::string& name) {
  for (std::size_t k = 0; k < kCovariates.size(); ++k)
    if (kCovariates.at(k).name == name) return static_cast<Covariate>(k);
  return std::nullopt;
}

std::string manoeuvre_for(Covariate covariate) { return row_of(covariate).manoeuvre; }

std::string to_string(Channel channel) {
  static constexpr const char* kNames[] = {"left_travel",   "right_travel", "both_travel", "track",
                                           "sideways",      "left_path",    "right_path",  "both_path",
                                           "sideways_path", "yaw_path",     "turn_path",   "turn_side",
                                           "turn_ahead",    "way_turned",   "scale",       "sensor_yaw"};
  return kNames[static_cast<std::size_t>(channel)];
}

Channel signed_counterpart(Channel channel) {
  switch (channel) {
    case Channel::left_path:
      return Channel::left_travel;
    case Channel::right_path:
      return Channel::right_travel;
    case Channel::both_path:
      return Channel::both_travel;
    case Channel::sideways_path:
      return Channel::sideways;
    default:
      return channel;
  }
}

bool belongs_to_the_place(Covariate covariate) { return has(covariate, of_the_place); }
bool begins_with_the_recording(Covariate covariate) { return has(covariate, from_the_begin); }
bool is_signed_speed(Covariate covariate) { return has(covariate, signed_speed); }
bool is_acceleration(Covariate covariate) { return has(covariate, Trait::acceleration); }
bool is_phase(Covariate covariate) { return has(covariate, phase); }
bool is_angle(Covariate covariate) { return has(covariate, angle); }
bool is_memory(Covariate covariate) { return has(covariate, memory); }
bool is_distance_since(Covariate covariate) { return has(covariate, since_event); }
bool is_angle_of_a_wheel(Covariate covariate) { return has(covariate, angle_of_a_wheel); }

std::size_t memories_of(Covariate covariate) { return row_of(covariate).memories; }

std::span<const Channel> channels_of(Covariate covariate) {
  const Channels& channels = row_of(covariate).channels;
  return std::span(channels.list).first(channels.size);
}

bool is_relay(Covariate covariate, std::size_t memory) {
  return covariate == Covariate::previous_acceleration && memory >= kMemorySpans.size();
}

double value_of(Covariate covariate, const StepContext& c, std::size_t memory) {
  switch (covariate) {
    case Covariate::left_speed:
    case Covariate::wheel_speed:
      return c.left_speed;
    case Covariate::right_speed:
      return c.right_speed;
    case Covariate::speed:
      return c.speed;
    case Covariate::turn_rate:
      return c.turn_rate;
    case Covariate::lateral_acceleration:
      return c.speed * c.turn_rate;
    case Covariate::left_acceleration:
      return c.left_acceleration;
    case Covariate::right_acceleration:
      return c.right_acceleration;
    case Covariate::acceleration:
      return 0.5 * (c.left_acceleration + c.right_acceleration);
    case Covariate::turn_acceleration:
      return 0.5 * (c.turn_acceleration_before[memory] + c.turn_acceleration_after[memory]);
    case Covariate::left_phase:
      return c.left_angle;
    case Covariate::right_phase:
      return c.right_angle;
    case Covariate::time:
      return c.t;
    case Covariate::heading:
      return c.heading;
    case Covariate::position:
      return c.x;
    case Covariate::distance:
      return c.distance;
    case Covariate::since_reversal:
      return c.since_reversal;
    case Covariate::left_since_reversal:
      return c.left_since_reversal;
    case Covariate::right_since_reversal:
      return c.right_since_reversal;
    case Covariate::since_stop:
      return c.since_stop[memory];
    case Covariate::previous_turn:
      return c.previous_turn[memory];
    case Covariate::previous_acceleration:
      return c.previous_acceleration[memory];
  }
  return 0.0;
}

}  // namespace odomcalib::calib::vehicle
