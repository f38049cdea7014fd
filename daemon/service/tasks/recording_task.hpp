// A recording without a motion: for a time, or until somebody stops it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "daemon/service/motion_count.hpp"
#include "daemon/service/parts/write_back.hpp"
#include "daemon/service/tasks/task.hpp"
#include "daemon/service/tasks/written_recording.hpp"

namespace odomcalib {

class RecordingTask final : public Task {
 public:
  /// All of it outlives the task.
  struct Parts {
    Outbox& outbox;
    MotionCount& recorded;
    const WriteBack& write_back;
  };
  struct Order {
    std::string name;
    double duration = 0.0;  ///< s; 0: until it is stopped
  };
  /// Errors: those of Recorder::start
  static Result<std::unique_ptr<Task>> begin(const Parts& parts, const Caller& caller, const Order& order,
                                             double now);

  [[nodiscard]] const char* part() const override { return "recording"; }
  [[nodiscard]] std::string activity() const override;
  TaskTurn turn(double now) override;
  void stop(double now) override { until_ = now; }
  /// Nobody would end a recording without a duration. What was recorded is kept.
  void abandoned(double now) override { until_ = now; }

 private:
  RecordingTask(const Parts& parts, const Caller& waits, std::optional<double> until)
      : Task(waits), parts_(parts), until_(until) {}

  const Parts parts_;
  std::optional<double> until_;  // s
  bool ending_ = false;          // it is written to its end
  WrittenRecording written_;
};

}  // namespace odomcalib
