#include "daemon/service/tasks/solving_task.hpp"

#include <fmt/format.h>

namespace odomcalib {
namespace {

std::filesystem::path kept_at(const Config& config, const std::filesystem::path& recording) {
  return config.state_dir / "calibrations" / (recording.stem().string() + ".json");
}

ordered_json report_of(const Calibrator& calibrator, const Calibration& calibration, const std::string& text,
                       const std::filesystem::path& recording) {
  ordered_json report = {{"recording", recording.string()}, {"calibration", ordered_json::parse(text)}};
  if (!calibrator.next_manoeuvre) return report;
  if (const auto next = calibrator.next_manoeuvre(calibration))
    report["next"] = {{"manoeuvre", next->name}, {"why", next->why}};
  return report;
}

/// For the journal.
std::string in_a_line(const Calibration& calibration, const std::filesystem::path& recording) {
  std::string line = recording.filename().string() + ": " + name_of(calibration.verdict);
  for (const auto& [name, quantity] : calibration.parameters)
    line += fmt::format(", {} {:.6g} ± {:.2g} {}", name, quantity.value, quantity.std, quantity.unit);
  for (const std::string& reason : calibration.reasons) line += "; " + reason;
  return line;
}

}  // namespace

SolvingTask::SolvingTask(const Bench& bench, const Caller& waits, const Order& order)
    : Task(waits),
      recording_(order.recordings.back()),
      cancelled_(std::make_shared<std::atomic<bool>>(false)),
      job_(cancellable(bench.calibrator, cancelled_), order.recordings, order.effects,
           kept_at(bench.config, recording_)) {}

TaskTurn SolvingTask::turn(Bench& bench) {
  const auto [phase, fraction] = job_.progress();
  bench.outbox.progress(caller, "solve: " + phase, fraction, std::nullopt);
  const auto result = job_.take_result();
  if (!result) return Running{};
  if (const auto problem = job_.not_kept())
    bench.outbox.event(messages::Severity::warning, "not_kept", problem->text());
  if (*cancelled_)
    return Failed{{ErrorCode::cancelled, "stopped on request", "solve",
                   "the recording is kept: odomcalibctl solve " + recording_.string()}};
  if (!*result) return Failed{result->error()};
  const std::string text = job_.text();
  bench.outbox.event(messages::Severity::info, "calibration", in_a_line(result->value(), recording_));
  bench.outbox.send_result(text);
  bench.outbox.send_paths(report_data_of(result->value()).paths);
  return Done{{{"result", report_of(bench.calibrator, result->value(), text, recording_)}}};
}

}  // namespace odomcalib
