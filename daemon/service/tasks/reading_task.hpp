// Before a motion or a write: the controller is read again, since others may have changed it, on a bus that
// does not show them too. What differs refuses what was to follow.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

class ReadingTask final : public Task {
 public:
  using Next = std::function<Result<std::unique_ptr<Task>>(RobotParts& parts)>;
  /// @param next makes what follows, or says why it may not
  ReadingTask(const Caller& waits, double now, Next next)
      : Task(waits), asked_at_(now), next_(std::move(next)) {}

  [[nodiscard]] const char* part() const override { return "reading"; }
  [[nodiscard]] std::string activity(const RobotParts& /*parts*/) const override {
    return "reading the controller";
  }
  TaskTurn turn(RobotParts& parts) override;
  void stop(RobotParts& /*parts*/) override { cancelled_ = "stopped on request"; }
  void abandoned(RobotParts& /*parts*/) override { cancelled_ = "the client closed its connection"; }
  [[nodiscard]] bool uses_controller() const override { return true; }

 private:
  TaskTurn begin(RobotParts& parts);

  double asked_at_;  // s
  Next next_;
  bool reading_ = false;  // the controller's job has begun; it ends by itself
  const char* cancelled_ = nullptr;
};

}  // namespace odomcalib
