// The main loop: waits for input, then serves the parts that are always there and the task that runs.
#pragma once

#include <poll.h>

#include <memory>
#include <string>
#include <vector>

#include "daemon/service/parts/bench.hpp"
#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

class Loop {
 public:
  Loop(const Config& configuration, Clock& clock, Calibrator functions, BaseLink base, LidarLink lidar,
       ControlServer server, Journal journal, std::unique_ptr<Background> disk);

  /// Waits at most so long for input.
  void wait(int timeout_ms);
  /// Serves everything that is due by the clock.
  void turn();
  void stop_all(const std::string& why);

  [[nodiscard]] const Bench& bench() const { return bench_; }
  [[nodiscard]] const Task* task() const { return task_.get(); }

 private:
  /// Whether this woke the loop, or was not looked at for a while; then `next` is set anew.
  bool due(bool woke, double& next) const;
  void serve_drive();
  void serve_lidar();
  void serve_clients();
  void serve_disk();
  void serve_write_back();
  void serve_task();
  void serve_telemetry();
  void forget(ClientId gone);
  void settle(TaskTurn turn);

  Bench bench_;
  std::unique_ptr<Task> task_;  // after the bench: its end may stop the drive
  std::vector<pollfd> polled_;  // what the last wait was for: drive, lidar, disk, then the control socket
  bool lidar_woke_ = false, clients_woke_ = false;
  double next_lidar_ = 0.0, next_clients_ = 0.0;
};

}  // namespace odomcalib
