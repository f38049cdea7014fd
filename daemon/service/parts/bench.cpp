#include "daemon/service/parts/bench.hpp"

namespace odomcalib {

Bench::Bench(const Config& configuration, Clock& time, Calibrator functions, BaseLink base_link,
             LidarLink lidar_link, ControlServer control_server, Journal write_journal,
             std::unique_ptr<Background> disk_worker)
    : config(configuration),
      clock(time),
      calibrator(std::move(functions)),
      now(time.now()),
      disk(std::move(disk_worker)),
      outbox(std::move(control_server), config, clock),
      drive(std::move(base_link), config),
      surroundings(std::move(lidar_link), config),
      applied(config.state_dir, calibrator),
      write_back(std::move(write_journal), config.state_dir, *disk) {
  outbox.begin_turn(now);
  drive.link.watch_frames([this](const drivers::CanFrame& frame) { outbox.frame(frame); });
}

// A quick stop makes the controller refuse parameters for a moment: in the middle of a write-back, which
// begins only when the axes are off, it would stop nothing and leave the values half written.
void stop_drive(Bench& bench) {
  if (bench.write_back.busy() && bench.drive.off()) return;
  bench.drive.controller().quick_stop(bench.now);
  bench.drive.link.flush();
}

}  // namespace odomcalib
