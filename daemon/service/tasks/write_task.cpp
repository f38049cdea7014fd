#include "daemon/service/tasks/write_task.hpp"

#include "daemon/service/status_report.hpp"

namespace odomcalib {

ordered_json to_json(const RoundingError& error) {
  return {{"length", error.length}, {"heading", error.heading}, {"turn", error.turn}};
}

Result<std::unique_ptr<Task>> WriteTask::begin(Bench& bench, const Caller& caller, const Order& order) {
  const auto calibration =
      order.replaces_calibration
          ? bench.applied.file.announce(order.calibration, bench.write_back.journaled_calibration())
          : Result<std::string>(std::string());
  if (!calibration) return calibration.error();
  const auto begun = bench.write_back.write(order.label, order.rounded.values, calibration.value());
  if (!begun) return begun.error();
  return std::unique_ptr<Task>(new WriteTask(caller, order.rounded.remaining));
}

TaskTurn WriteTask::turn(Bench& bench) {
  const auto end = bench.write_back.take_end();
  if (!end) return Running{};
  const WriteReport& report = end->report;
  if (report.outcome != WriteOutcome::committed)
    return Failed{report.error.value_or(Error{ErrorCode::write_failed, "write-back failed", "", ""})};
  if (end->unsettled) return Failed{*end->unsettled};
  return Done{{{"result",
                {{"outcome", name_of(report.outcome)},
                 {"steps", report.steps},
                 {"before", report.before},
                 {"after", report.after},
                 {"rounding_error", to_json(rounding_)},
                 {"parameters", parameter_report(bench, bench.applied.get())}}}}};
}

}  // namespace odomcalib
