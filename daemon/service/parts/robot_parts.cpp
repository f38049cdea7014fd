#include "daemon/service/parts/robot_parts.hpp"

namespace odomcalib {

RobotParts::RobotParts(const Config& configuration, Clock& time, Calibrator functions, Opened opened,
                       std::unique_ptr<Background> disk_worker, EventLog log)
    : config(configuration),
      clock(time),
      calibrator(std::move(functions)),
      now(time.now()),
      folder(std::move(opened.folder)),
      urgency(std::move(opened.urgency)),
      disk(std::move(disk_worker)),
      outbox(std::move(opened.server), config, clock, std::move(log)),
      drive(std::move(opened.base), config),
      surroundings(std::move(opened.lidar), config),
      applied(config.state_dir, calibrator),
      write_back(std::move(opened.journal), config.state_dir, *disk),
      last_run(config.state_dir / "last_run.json", *disk) {
  outbox.begin_turn(now);
  if (const auto& why = folder.read_only())
    outbox.event(messages::Severity::warning, "read_only", why->text());
  if (!urgency.remedy.empty())
    outbox.event(messages::Severity::warning, "not_urgent", urgency.found + ": " + urgency.remedy);
  // Where nothing is installed there is no group of the usual name.
  if (const auto& why = outbox.server.warning(); !why.empty() && config.group != Config{}.group)
    outbox.event(messages::Severity::warning, "control_group", why);
  if (drive.nominal().robot_id.empty())
    outbox.event(messages::Severity::warning, "robot_id",
                 "robot.id is not configured: this daemon cannot tell robots apart, and asks at each apply");
  if (const auto& why = last_run.damage()) outbox.event(messages::Severity::warning, "last_run", why->text());
  if (last_run.after_crash()) outbox.event(messages::Severity::warning, "restarted", last_run.last_stop());
  drive.link.watch_frames([this](const drivers::CanFrame& frame) { outbox.frame(frame); });
}

// A quick stop makes the controller refuse parameters for a moment: in the middle of a write-back, which
// begins only when the axes are off, it would stop nothing and leave the values half written.
void stop_drive(Drive& drive, const WriteBack& write_back, double now) {
  if (write_back.busy() && drive.off()) return;
  drive.controller().quick_stop(now);
  drive.link.flush();
}

}  // namespace odomcalib
