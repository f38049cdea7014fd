#include "daemon/service/tasks/proof_task.hpp"

#include "daemon/service/settings.hpp"
#include "daemon/service/tasks/write_task.hpp"
#include "daemon/service/write_gate.hpp"

namespace odomcalib {

TaskTurn ProofTask::store(Bench& bench) {
  if (const auto lacking = bench.write_back.proof.lacking()) return Failed{*lacking};
  if (comes_to_rest(bench) && bench.now - asked_at_ < service::settings::kComesToRest_s) return Running{};
  if (bench.drive.controller().state() != drivers::ControllerState::disabled)
    return Failed{axes_not_off(bench)};
  if (auto stored = bench.write_back.store(); !stored) return Failed{stored.error()};
  begun_ = true;
  return Running{};
}

TaskTurn ProofTask::turn(Bench& bench) {
  if (!begun_ && proven_) return store(bench);
  // What is not proven goes back once the axes are off, whether somebody waits for it or not.
  if (!begun_) {
    bench.write_back.take_back("whoever drove the proof takes the values back");
    bench.write_back.place = kBeforeProof;
  }
  begun_ = true;
  const bool waits = bench.write_back.transaction.proving();
  if (waits && bench.now - asked_at_ > service::settings::kComesToRest_s) return Failed{axes_not_off(bench)};
  const auto end = bench.write_back.take_end();
  if (!end) return Running{};
  const WriteReport& report = end->report;
  if (!proven_ && report.outcome == WriteOutcome::rolled_back)
    return done_with(write_reply(bench, report, report.after, report.before, {}));
  return turn_of(bench, *end);
}

}  // namespace odomcalib
