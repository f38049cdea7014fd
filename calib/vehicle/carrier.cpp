#include "calib/vehicle/carrier.hpp"

#include <algorithm>
#include <array>

namespace odomcalib::calib::vehicle {

namespace {

struct CovariateRow {
  const char* name;
  const char* manoeuvre;  ///< that shows the most of what depends on it, in a small area; empty: none
};

/// In the order of Variable.
constexpr std::array<CovariateRow, static_cast<std::size_t>(kLastVariable) + 1> kCovariates = {{
    {"left_speed", "straights"},
    {"right_speed", "straights"},
    {"wheel_speed", "straights"},
    {"speed", "straights"},
    {"turn_rate", "turns"},
    {"lateral_acceleration", "arcs"},
    {"left_acceleration", "accelerations"},
    {"right_acceleration", "accelerations"},
    {"acceleration", "accelerations"},
    {"turn_acceleration", ""},
    {"left_phase", "slow_straights"},
    {"right_phase", "slow_straights"},
    {"time", ""},
    {"heading", "headings"},
    {"position", ""},
    {"distance", ""},
    {"since_reversal", "reversals"},
    {"left_since_reversal", "reversals"},
    {"right_since_reversal", "reversals"},
    {"since_stop", "accelerations"},
    {"previous_turn", "turns"},
    {"previous_push", "accelerations"},
}};

}  // namespace

std::string to_string(Variable variable) { return kCovariates.at(static_cast<std::size_t>(variable)).name; }

std::optional<Variable> variable_from(const std::string& name) {
  for (std::size_t k = 0; k < kCovariates.size(); ++k)
    if (kCovariates.at(k).name == name) return static_cast<Variable>(k);
  return std::nullopt;
}

std::string manoeuvre_for(Variable variable) {
  return kCovariates.at(static_cast<std::size_t>(variable)).manoeuvre;
}

std::string to_string(Carrier carrier) {
  static constexpr const char* kNames[] = {"left_travel",   "right_travel", "both_travel", "track",
                                           "sideways",      "left_path",    "right_path",  "both_path",
                                           "sideways_path", "yaw_path",     "turn_path",   "turn_side",
                                           "turn_ahead",    "way_turned",   "scale",       "sensor_yaw"};
  return kNames[static_cast<std::size_t>(carrier)];
}

Carrier signed_counterpart(Carrier carrier) {
  switch (carrier) {
    case Carrier::left_path:
      return Carrier::left_travel;
    case Carrier::right_path:
      return Carrier::right_travel;
    case Carrier::both_path:
      return Carrier::both_travel;
    case Carrier::sideways_path:
      return Carrier::sideways;
    default:
      return carrier;
  }
}

bool belongs_to_the_place(Variable variable) {
  return variable == Variable::time || variable == Variable::heading || variable == Variable::position;
}

bool begins_with_the_recording(Variable variable) {
  return belongs_to_the_place(variable) || is_phase(variable) || variable == Variable::distance;
}

bool is_signed_speed(Variable variable) {
  return variable == Variable::left_speed || variable == Variable::right_speed ||
         variable == Variable::wheel_speed || variable == Variable::speed || variable == Variable::turn_rate;
}

bool is_acceleration(Variable variable) {
  return variable == Variable::left_acceleration || variable == Variable::right_acceleration ||
         variable == Variable::acceleration || variable == Variable::lateral_acceleration;
}

bool is_phase(Variable variable) {
  return variable == Variable::left_phase || variable == Variable::right_phase;
}

bool is_angle(Variable variable) { return is_phase(variable) || variable == Variable::heading; }

bool is_memory(Variable variable) {
  return variable == Variable::previous_turn || variable == Variable::previous_push;
}

bool is_distance_since(Variable variable) {
  return variable == Variable::since_reversal || variable == Variable::left_since_reversal ||
         variable == Variable::right_since_reversal || variable == Variable::since_stop;
}

std::size_t memories_of(Variable variable) {
  switch (variable) {
    case Variable::previous_turn:
      return kMemorySpans.size();
    case Variable::previous_push:
      return kMemorySpans.size() + kPushes.size();
    case Variable::turn_acceleration:
      return kSwayLags.size();
    case Variable::since_stop:
      return kStops.size();
    default:
      return kUsualMemory + 1;
  }
}

bool is_relay(Variable variable, std::size_t memory) {
  return variable == Variable::previous_push && memory >= kMemorySpans.size();
}

double value_of(Variable variable, const StepContext& c, std::size_t memory) {
  switch (variable) {
    case Variable::left_speed:
    case Variable::wheel_speed:
      return c.left_speed;
    case Variable::right_speed:
      return c.right_speed;
    case Variable::speed:
      return c.speed;
    case Variable::turn_rate:
      return c.turn_rate;
    case Variable::lateral_acceleration:
      return c.speed * c.turn_rate;
    case Variable::left_acceleration:
      return c.left_acceleration;
    case Variable::right_acceleration:
      return c.right_acceleration;
    case Variable::acceleration:
      return 0.5 * (c.left_acceleration + c.right_acceleration);
    case Variable::turn_acceleration:
      return 0.5 * (c.turn_acceleration_before[memory] + c.turn_acceleration_after[memory]);
    case Variable::left_phase:
      return c.left_angle;
    case Variable::right_phase:
      return c.right_angle;
    case Variable::time:
      return c.t;
    case Variable::heading:
      return c.heading;
    case Variable::position:
      return c.x;
    case Variable::distance:
      return c.distance;
    case Variable::since_reversal:
      return c.since_reversal;
    case Variable::left_since_reversal:
      return c.left_since_reversal;
    case Variable::right_since_reversal:
      return c.right_since_reversal;
    case Variable::since_stop:
      return c.since_stop[memory];
    case Variable::previous_turn:
      return c.previous_turn[memory];
    case Variable::previous_push:
      return c.previous_push[memory];
  }
  return 0.0;
}

}  // namespace odomcalib::calib::vehicle
