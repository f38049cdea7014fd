// The main loop: waits for input, then serves the parts that are always there and the task that runs.
#pragma once

#include <poll.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "daemon/service/loop_watch.hpp"
#include "daemon/service/parts/robot_parts.hpp"
#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

class Loop {
 public:
  Loop(const Config& configuration, Clock& clock, Calibrator functions, Opened opened,
       std::unique_ptr<Background> disk, EventLog log);

  /// Waits at most so long for input.
  void wait(int timeout_ms);
  /// Serves everything that is due by the clock.
  void turn();
  void stop_all(const std::string& why);

  [[nodiscard]] const RobotParts& parts() const { return parts_; }
  [[nodiscard]] const Task* task() const { return task_.get(); }

 private:
  void rest();
  /// Whether this woke the loop, or was not looked at for a while; then `next` is set anew.
  bool due(bool woke, double& next) const;
  void serve_drive();
  void serve_lidar();
  void serve_clients();
  void serve_disk();
  void serve_write_back();
  void serve_task();
  void serve_telemetry();
  void report(const char* line, const std::optional<LinkWatch::News>& news);
  void forget(ClientId gone);
  void settle(TaskTurn turn);
  /// Ends the process when the loop hangs; the service manager starts it again.
  void abort_if_stuck();

  RobotParts parts_;
  std::unique_ptr<Task> task_;  // after the parts: its end may stop the drive
  std::vector<pollfd> polled_;  // what the last wait was for: drive, lidar, disk, then the control socket
  static constexpr std::array kPolled = {"base", "lidar", "disk", "control socket", "client"};
  LoopGuard guard_{kPolled};
  std::uint64_t served_ = 0;  // calls, up to the last turn
  bool at_once_ = false;      // the last wait was none: calls were waiting
  bool lidar_woke_ = false, clients_woke_ = false;
  double next_lidar_ = 0.0, next_clients_ = 0.0;
  double slept_ = 0.0;  // s, when the last wait had nothing to do
};

}  // namespace odomcalib
