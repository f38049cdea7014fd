#include "daemon/service/tasks/solving_task.hpp"

#include <stdexcept>
#include <utility>

namespace odomcalib {
namespace {

std::filesystem::path kept_at(const Config& config, const std::filesystem::path& recording) {
  return config.state_dir / "calibrations" / (recording.stem().string() + ".json");
}

/// The same functions; `solve` ends with an exception at the first progress report after the flag was set.
Calibrator cancellable(Calibrator calibrator, std::shared_ptr<std::atomic<bool>> cancelled) {
  if (!calibrator.solve) return calibrator;
  calibrator.solve = [solve = std::move(calibrator.solve), cancelled = std::move(cancelled)](
                         const std::vector<std::filesystem::path>& recordings,
                         const std::vector<std::string>& effects, const Calibrator::Progress& progress) {
    const auto report = [&](const std::string& phase, double fraction) {
      if (*cancelled) throw std::runtime_error("stopped on request");
      if (progress) progress(phase, fraction);
    };
    return solve(recordings, effects, report);
  };
  return calibrator;
}

}  // namespace

SolvingTask::SolvingTask(const Parts& parts, const Caller& waits, const Order& order)
    : Task(waits),
      outbox_(parts.outbox),
      recording_(order.recordings.back()),
      cancelled_(std::make_shared<std::atomic<bool>>(false)),
      job_(cancellable(parts.calibrator, cancelled_), order.recordings, order.effects,
           kept_at(parts.config, recording_)) {}

TaskTurn SolvingTask::turn(double /*now*/) {
  const auto [phase, fraction] = job_.progress();
  outbox_.progress(caller, "solve: " + phase, fraction, std::nullopt);
  auto result = job_.take_result();
  if (!result) return Running{};
  if (const auto problem = job_.not_kept())
    outbox_.event(messages::Severity::warning, "not_kept", problem->text());
  if (*cancelled_)
    return Failed{{ErrorCode::cancelled, "stopped on request", "solve",
                   "the recording is kept: odomcalibctl solve " + recording_.string()}};
  if (!*result) return Failed{result->error()};
  Solution solution = std::move(*result).value();
  outbox_.event(messages::Severity::info, "calibration", solution.line);
  outbox_.send_result(solution.calibration);
  outbox_.send_paths(solution.paths);
  return Done{std::move(solution.reply)};
}

}  // namespace odomcalib
