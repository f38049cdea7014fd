// A recording without a motion: for a time, or until somebody stops it.
#pragma once

#include <memory>
#include <optional>

#include "daemon/service/tasks/task.hpp"
#include "daemon/service/tasks/written_recording.hpp"

namespace odomcalib {

class RecordingTask final : public Task {
 public:
  /// @param duration s; 0: until it is stopped. Errors: those of Recorder::start
  static Result<std::unique_ptr<Task>> begin(RobotParts& parts, const Caller& caller, const std::string& name,
                                             double duration);

  [[nodiscard]] const char* part() const override { return "recording"; }
  [[nodiscard]] std::string activity(const RobotParts& parts) const override;
  TaskTurn turn(RobotParts& parts) override;
  void stop(RobotParts& parts) override { until_ = parts.now; }
  /// Nobody would end a recording without a duration. What was recorded is kept.
  void abandoned(RobotParts& parts) override { until_ = parts.now; }

 private:
  RecordingTask(const Caller& waits, std::optional<double> until) : Task(waits), until_(until) {}

  std::optional<double> until_;  // s
  bool ending_ = false;          // it is written to its end
  WrittenRecording written_;
};

}  // namespace odomcalib
