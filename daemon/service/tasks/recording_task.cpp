#include "daemon/service/tasks/recording_task.hpp"

namespace odomcalib {

Result<std::unique_ptr<Task>> RecordingTask::begin(RobotParts& parts, const Caller& caller,
                                                   const std::string& name, double duration) {
  const auto path = parts.outbox.telemetry.recorder.start(name);
  if (!path) return path.error();
  parts.recorded = {};
  parts.outbox.send_robot_soon();
  const auto until = duration > 0.0 ? std::optional(parts.now + duration) : std::nullopt;
  return std::unique_ptr<Task>(new RecordingTask(caller, until));
}

std::string RecordingTask::activity(const RobotParts& parts) const {
  if (parts.write_back.busy()) return "reading or writing parameters";
  return parts.outbox.telemetry.recorder.finishing() ? "writing the recording" : "recording";
}

TaskTurn RecordingTask::turn(RobotParts& parts) {
  Recorder& recorder = parts.outbox.telemetry.recorder;
  if (const auto& path = written_.result()) {
    if (!*path) return Failed{path->error()};
    return done_with({{"path", path->value().string()}});
  }
  if (ending_) return Running{};
  const auto left = until_ ? std::optional(*until_ - parts.now) : std::nullopt;
  parts.outbox.progress(caller, "recording", 0.0, left);
  ending_ = (left && *left <= 0.0) || recorder.problem();
  if (ending_) written_.finish(recorder);
  return Running{};
}

}  // namespace odomcalib
