#include "daemon/service/tasks/proof_task.hpp"

#include "daemon/service/settings.hpp"
#include "daemon/service/tasks/write_task.hpp"
#include "daemon/service/write_gate.hpp"

namespace odomcalib {

TaskTurn ProofTask::store(double now) {
  if (const auto lacking = parts_.write_back.proof.lacking()) return Failed{*lacking};
  if (comes_to_rest(parts_.drive) && now - asked_at_ < service::settings::kComesToRest_s) return Running{};
  if (parts_.drive.controller().state() != drivers::ControllerState::disabled)
    return Failed{axes_not_off(parts_.drive)};
  if (auto stored = parts_.write_back.store(); !stored) return Failed{stored.error()};
  begun_ = true;
  return Running{};
}

TaskTurn ProofTask::turn(double now) {
  if (!begun_ && proven_) return store(now);
  // Unproven values go back once the axes are off, whether somebody waits for it or not.
  if (!begun_) {
    parts_.write_back.take_back("whoever drove the proof takes the values back");
    parts_.write_back.place = kBeforeProof;
  }
  begun_ = true;
  const bool waits = parts_.write_back.transaction.proving();
  if (waits && now - asked_at_ > service::settings::kComesToRest_s) return Failed{axes_not_off(parts_.drive)};
  const auto end = parts_.write_back.take_end();
  if (!end) return Running{};
  const WriteReport& report = end->report;
  if (!proven_ && report.outcome == WriteOutcome::rolled_back)
    return done_with(write_reply(parts_, report, report.after, report.before, {}));
  return turn_of(parts_, *end);
}

}  // namespace odomcalib
