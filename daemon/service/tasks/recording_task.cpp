#include "daemon/service/tasks/recording_task.hpp"

namespace odomcalib {

Result<std::unique_ptr<Task>> RecordingTask::begin(const Parts& parts, const Caller& caller,
                                                   const Order& order, double now) {
  const auto path = parts.outbox.telemetry.recorder.start(order.name);
  if (!path) return path.error();
  parts.recorded = {};
  parts.outbox.send_robot_soon();
  const auto until = order.duration > 0.0 ? std::optional(now + order.duration) : std::nullopt;
  return std::unique_ptr<Task>(new RecordingTask(parts, caller, until));
}

std::string RecordingTask::activity() const {
  if (parts_.write_back.busy()) return "reading or writing parameters";
  return parts_.outbox.telemetry.recorder.finishing() ? "writing the recording" : "recording";
}

TaskTurn RecordingTask::turn(double now) {
  Recorder& recorder = parts_.outbox.telemetry.recorder;
  if (const auto& path = written_.result()) {
    if (!*path) return Failed{path->error()};
    return done_with({{"path", path->value().string()}});
  }
  if (ending_) return Running{};
  const auto left = until_ ? std::optional(*until_ - now) : std::nullopt;
  parts_.outbox.progress(caller, "recording", 0.0, left);
  ending_ = (left && *left <= 0.0) || recorder.problem();
  if (ending_) written_.finish(recorder);
  return Running{};
}

}  // namespace odomcalib
