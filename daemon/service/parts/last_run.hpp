// Record of what the daemon does and why it stopped the robot last, on the disk for the one that comes after
// it: after a watchdog's restart, too, `status` says what happened.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "daemon/writeback/background.hpp"
#include "proto/result.hpp"

namespace odomcalib {

class LastRun {
 public:
  /// Reads what the daemon before has left. @param disk outlives this
  LastRun(std::filesystem::path file, Background& disk);

  /// Why nobody knows all that the daemon before has left; nullopt: it is known, or there was none.
  [[nodiscard]] const std::optional<Error>& damage() const { return damage_; }
  /// The daemon before ended without being stopped.
  [[nodiscard]] bool after_crash() const { return after_crash_; }
  /// Why the robot was stopped last, by this daemon or an earlier one; empty: never. Says so where that is
  /// not known.
  [[nodiscard]] const std::string& last_stop() const { return last_stop_; }

  /// Something that moves the robot has begun before, in this state directory.
  [[nodiscard]] bool moved() const { return moved_; }

  /// Something begins that moves the robot.
  void begins(const std::string& what);
  /// It has come to its end.
  void ends();
  /// It was stopped.
  void stopped(const std::string& why);
  /// The daemon ends as it should.
  void daemon_ends();

 private:
  void write();

  std::filesystem::path file_;
  Background& disk_;
  bool after_crash_ = false, ended_ = false, moved_ = false;
  std::string doing_, last_stop_;
  std::optional<Error> damage_;
};

}  // namespace odomcalib
