#include "daemon/service/tasks/reading_task.hpp"

#include "daemon/service/settings.hpp"
#include "daemon/service/write_outcome.hpp"

namespace odomcalib {

/// Axes that still have torque after a motion are waited for.
TaskTurn ReadingTask::begin(Bench& bench) {
  if (bench.write_back.busy()) return Running{};
  const auto begun = bench.drive.controller().start_read_parameters(bench.now);
  reading_ = begun.ok();
  const bool waits = reading_ || bench.now - asked_at_ < service::settings::kComesToRest_s;
  return waits ? TaskTurn(Running{}) : Failed{begun.error()};
}

TaskTurn ReadingTask::turn(Bench& bench) {
  const auto result =
      reading_ ? bench.drive.controller().take_job_result() : std::optional<drivers::ParameterJobResult>();
  if (reading_ && !result) return Running{};
  if (bench.ending) cancelled_ = "the daemon ends";
  if (cancelled_ != nullptr) return Failed{{ErrorCode::cancelled, cancelled_, part(), "start again"}};
  if (!reading_) return begin(bench);
  if (result->error) return Failed{*result->error};
  settle_reading(bench, result->parameters);
  auto task = next_(bench);
  return task ? TaskTurn(Then{std::move(task).value()}) : Failed{task.error()};
}

}  // namespace odomcalib
