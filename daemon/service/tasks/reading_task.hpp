// Before a motion or a write: the controller is read again, since others may have changed it, on a bus that
// does not show them too. What differs refuses what was to follow.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "daemon/service/parts/drive.hpp"
#include "daemon/service/parts/write_back.hpp"
#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

class ReadingTask final : public Task {
 public:
  using Next = std::function<Result<std::unique_ptr<Task>>()>;
  /// All of it outlives the task.
  struct Parts {
    WriteBack& write_back;
    Drive& drive;
    Outbox& outbox;
  };
  /// @param next makes what follows, or says why it may not
  ReadingTask(const Parts& parts, const Caller& waits, double now, Next next)
      : Task(waits), parts_(parts), asked_at_(now), next_(std::move(next)) {}

  [[nodiscard]] const char* part() const override { return "reading"; }
  [[nodiscard]] std::string activity() const override { return "reading the controller"; }
  TaskTurn turn(double now) override;
  void stop(double /*now*/) override { cancelled_ = "stopped on request"; }
  void abandoned(double /*now*/) override { cancelled_ = "the client closed its connection"; }
  [[nodiscard]] bool uses_controller() const override { return true; }

 private:
  TaskTurn begin(double now);

  const Parts parts_;
  double asked_at_;  // s
  Next next_;
  bool reading_ = false;  // the controller's job has begun; it ends by itself
  const char* cancelled_ = nullptr;
};

}  // namespace odomcalib
