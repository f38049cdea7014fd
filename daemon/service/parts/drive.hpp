// The motor controller as the daemon sees it: its line, what it counts and what it holds.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/safety/freshness.hpp"
#include "daemon/service/base_link.hpp"
#include "daemon/service/parts/link_watch.hpp"
#include "daemon/writeback/transaction.hpp"

namespace odomcalib {

std::string name_of(drivers::ControllerState state);

class Drive {
 public:
  /// News of one turn.
  struct News {
    std::vector<TickSample> ticks;
    std::vector<drivers::ControllerEvent> events;
    std::optional<drivers::ControllerState> state;  ///< when it has changed
    std::optional<LinkWatch::News> line;
  };

  /// @param config outlives this
  Drive(BaseLink base_link, const Config& config) : link(std::move(base_link)), config_(config) {}

  News serve(const Clock& clock, double now);
  [[nodiscard]] drivers::Controller& controller() const { return link.controller(); }
  /// The axes have no torque, as far as the controller says.
  [[nodiscard]] bool off() const;

  /// From profile and configuration.
  [[nodiscard]] RobotDescription nominal() const;
  /// The same with what the controller holds.
  [[nodiscard]] RobotDescription robot() const;
  /// The same with who the controller is, for recordings.
  [[nodiscard]] RobotDescription described() const;
  [[nodiscard]] routines::WheelGeometry geometry() const;
  /// Why the wheels' dimensions are no base for a speed, as they were last read.
  [[nodiscard]] std::optional<Error> geometry_forbidden() const;
  /// Why it is not known what the controller holds; nullopt also of one that holds nothing.
  [[nodiscard]] std::optional<Error> unread() const;

  /// Takes the values that the controller holds, as they were just read. @param written quantities that were
  /// written by us since the last time. @return somebody else has changed one of the others
  bool take(const std::vector<drivers::StoredParameter>& found, const ParameterMap& written);
  /// Nobody knows what it should hold.
  void forget_values();
  /// Values that somebody else has changed and that are not among those about to be written.
  [[nodiscard]] std::optional<Error> changed_besides(const ParameterMap& values) const;

  BaseLink link;
  safety::EncoderFreshness encoders;
  TickSample newest_ticks;
  std::uint64_t tick_count = 0;
  std::vector<drivers::StoredParameter> in_force;  ///< newest reading
  bool values_known = false;                       ///< `in_force` was read since the controller came
  std::string trouble;  ///< why the controller is not configured, in its driver's words; empty: it is

 private:
  /// A quantity of which the controller holds something else than it was left with.
  struct Change {
    drivers::StoredParameter expected, found;
  };
  void note_trouble(const News& news);
  void compare(const drivers::StoredParameter& found, bool written);

  const Config& config_;
  std::map<std::string, drivers::StoredParameter> expected_;  // by quantity, as it was left or first found
  std::map<std::string, Change> changed_;                     // by quantity
  std::string device_;                                        // whose they are, see device_of()
  LinkWatch watch_;
  drivers::ControllerState state_ = drivers::ControllerState::absent;
};

}  // namespace odomcalib
