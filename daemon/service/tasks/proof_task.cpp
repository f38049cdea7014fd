#include "daemon/service/tasks/proof_task.hpp"

#include "daemon/service/settings.hpp"
#include "daemon/service/tasks/write_task.hpp"
#include "daemon/service/write_gate.hpp"

namespace odomcalib {

TaskTurn ProofTask::store(RobotParts& parts) {
  if (const auto lacking = parts.write_back.proof.lacking()) return Failed{*lacking};
  if (comes_to_rest(parts) && parts.now - asked_at_ < service::settings::kComesToRest_s) return Running{};
  if (parts.drive.controller().state() != drivers::ControllerState::disabled)
    return Failed{axes_not_off(parts)};
  if (auto stored = parts.write_back.store(); !stored) return Failed{stored.error()};
  begun_ = true;
  return Running{};
}

TaskTurn ProofTask::turn(RobotParts& parts) {
  if (!begun_ && proven_) return store(parts);
  // What is not proven goes back once the axes are off, whether somebody waits for it or not.
  if (!begun_) {
    parts.write_back.take_back("whoever drove the proof takes the values back");
    parts.write_back.place = kBeforeProof;
  }
  begun_ = true;
  const bool waits = parts.write_back.transaction.proving();
  if (waits && parts.now - asked_at_ > service::settings::kComesToRest_s) return Failed{axes_not_off(parts)};
  const auto end = parts.write_back.take_end();
  if (!end) return Running{};
  const WriteReport& report = end->report;
  if (!proven_ && report.outcome == WriteOutcome::rolled_back)
    return done_with(write_reply(parts, report, report.after, report.before, {}));
  return turn_of(parts, *end);
}

}  // namespace odomcalib
