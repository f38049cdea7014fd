#include "calib/vehicle/channel.hpp"

#include <array>

namespace odomcalib::calib::vehicle {

namespace {

struct CovariateRow {
  const char* name;
  const char* manoeuvre;  ///< that shows the most of what depends on it, in a small area; empty: none
  CovariateGroups groups = {};
};

/// In the order of Covariate.
constexpr std::array<CovariateRow, static_cast<std::size_t>(kLastCovariate) + 1> kCovariates = {{
    {"left_speed", "straights"},
    {"right_speed", "straights"},
    {"wheel_speed", "straights"},
    {"speed", "straights"},
    {"turn_rate", "turns"},
    {"lateral_acceleration", "arcs"},
    {"left_acceleration", "accelerations"},
    {"right_acceleration", "accelerations"},
    {"acceleration", "accelerations"},
    {"turn_acceleration", "", {CovariateGroup::sway}},
    {"left_phase", "slow_straights"},
    {"right_phase", "slow_straights"},
    {"time", ""},
    {"heading", "headings"},
    {"position", ""},
    {"distance", ""},
    {"since_reversal", "reversals"},
    {"left_since_reversal", "reversals"},
    {"right_since_reversal", "reversals"},
    {"since_stop", "accelerations", {CovariateGroup::stops}},
    {"previous_turn", "turns", {CovariateGroup::previous_turn}},
    {"previous_push", "accelerations", {CovariateGroup::previous_acceleration}},
}};

}  // namespace

std::string to_string(Covariate covariate) {
  return kCovariates.at(static_cast<std::size_t>(covariate)).name;
}

CovariateGroups groups_of(Covariate covariate) {
  return kCovariates.at(static_cast<std::size_t>(covariate)).groups;
}

std::optional<Covariate> covariate_from(const std::string& name) {
  for (std::size_t k = 0; k < kCovariates.size(); ++k)
    if (kCovariates.at(k).name == name) return static_cast<Covariate>(k);
  return std::nullopt;
}

std::string manoeuvre_for(Covariate covariate) {
  return kCovariates.at(static_cast<std::size_t>(covariate)).manoeuvre;
}

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

bool belongs_to_the_place(Covariate covariate) {
  return covariate == Covariate::time || covariate == Covariate::heading || covariate == Covariate::position;
}

bool begins_with_the_recording(Covariate covariate) {
  return belongs_to_the_place(covariate) || is_phase(covariate) || covariate == Covariate::distance;
}

bool is_signed_speed(Covariate covariate) {
  return covariate == Covariate::left_speed || covariate == Covariate::right_speed ||
         covariate == Covariate::wheel_speed || covariate == Covariate::speed ||
         covariate == Covariate::turn_rate;
}

bool is_acceleration(Covariate covariate) {
  return covariate == Covariate::left_acceleration || covariate == Covariate::right_acceleration ||
         covariate == Covariate::acceleration || covariate == Covariate::lateral_acceleration;
}

bool is_phase(Covariate covariate) {
  return covariate == Covariate::left_phase || covariate == Covariate::right_phase;
}

bool is_angle(Covariate covariate) { return is_phase(covariate) || covariate == Covariate::heading; }

bool is_memory(Covariate covariate) {
  return covariate == Covariate::previous_turn || covariate == Covariate::previous_acceleration;
}

bool is_distance_since(Covariate covariate) {
  return covariate == Covariate::since_reversal || covariate == Covariate::left_since_reversal ||
         covariate == Covariate::right_since_reversal || covariate == Covariate::since_stop;
}

std::size_t memories_of(Covariate covariate) {
  switch (covariate) {
    case Covariate::previous_turn:
      return kMemorySpans.size();
    case Covariate::previous_acceleration:
      return kMemorySpans.size() + kAccelerationThresholds.size();
    case Covariate::turn_acceleration:
      return kSwayLags.size();
    case Covariate::since_stop:
      return kStops.size();
    default:
      return kUsualMemory + 1;
  }
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
