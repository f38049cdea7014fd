#include "daemon/service/tasks/reading_task.hpp"

#include "daemon/service/settings.hpp"
#include "daemon/service/write_outcome.hpp"

namespace odomcalib {

/// Axes that still have torque after a motion are waited for.
TaskTurn ReadingTask::begin(double now) {
  if (parts_.write_back.busy()) return Running{};
  const auto begun = parts_.drive.controller().start_read_parameters(now);
  reading_ = begun.ok();
  const bool waits = reading_ || now - asked_at_ < service::settings::kComesToRest_s;
  return waits ? TaskTurn(Running{}) : Failed{begun.error()};
}

TaskTurn ReadingTask::turn(double now) {
  const auto result =
      reading_ ? parts_.drive.controller().take_job_result() : std::optional<drivers::ParameterJobResult>();
  if (reading_ && !result) return Running{};
  if (parts_.write_back.ending()) cancelled_ = "the daemon ends";
  if (cancelled_ != nullptr) return Failed{{ErrorCode::cancelled, cancelled_, part(), "start again"}};
  if (!reading_) return begin(now);
  if (result->error) return Failed{*result->error};
  settle_reading(parts_.drive, parts_.outbox, result->parameters);
  auto task = next_();
  return task ? TaskTurn(Then{std::move(task).value()}) : Failed{task.error()};
}

}  // namespace odomcalib
