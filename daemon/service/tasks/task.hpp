// Uses of the robot: one task at a time. Motion, recording, solving and writing are the four kinds.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "daemon/routines/motion.hpp"
#include "daemon/service/json_text.hpp"
#include "daemon/service/parts/outbox.hpp"
#include "proto/control/control.hpp"

namespace odomcalib {

class Task;

/// Results of a task's turn.
struct Running {};
struct Done {
  std::string reply;  ///< frame for the caller
};
struct Failed {
  Error error;
};
/// The caller waits for the end of another task, which follows from this one.
struct Then {
  std::unique_ptr<Task> task;
};
using TaskTurn = std::variant<Running, Done, Failed, Then>;

[[nodiscard]] inline Done done_with(const ordered_json& parameters) {
  return {control::encode_reply(json_text(parameters))};
}

/// Begins when it is made, with the parts of the service that it uses, and has something to do in every turn
/// of the loop until that says how it ended. `now` is the begin of the turn, s.
class Task {
 public:
  explicit Task(const Caller& waits) : caller(waits) {}
  virtual ~Task() = default;
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  /// Part of the loop as which the duration of its turns is counted (LoopWatch).
  [[nodiscard]] virtual const char* part() const = 0;
  /// Text that `odomcalibctl status` shows.
  [[nodiscard]] virtual std::string activity() const = 0;
  virtual TaskTurn turn(double now) = 0;

  /// Somebody wants the robot to stand still: the task ends as soon as it may, and turn() says how.
  virtual void stop(double now) = 0;
  /// The client `caller` has closed its connection.
  virtual void abandoned(double now) = 0;
  /// The drive has stopped by itself.
  virtual void drive_stopped(const std::string& /*why*/) {}
  /// A whole turn of the lidar; odometry is up to date.
  virtual void scanned(const Scan& /*scan*/) {}
  /// The daemon ends. A task that moves the robot has ended it when this returns; others go on as they can.
  /// @return how it ended, Running where it did not
  virtual TaskTurn daemon_ends(const Error& /*why*/, double /*now*/) { return Running{}; }

  [[nodiscard]] virtual bool moves() const { return false; }
  /// Nothing else may be asked of the controller meanwhile.
  [[nodiscard]] virtual bool uses_controller() const { return moves(); }
  /// Twist of the robot now.
  [[nodiscard]] virtual routines::Twist twist() const { return {}; }

  const Caller caller;
};

}  // namespace odomcalib
