// odomcalibd without its main: one loop over devices, clients, a motion, a solver and a write-back.
#pragma once

#include <memory>
#include <string>

#include "daemon/config/config.hpp"
#include "daemon/service/calibrator.hpp"
#include "daemon/service/clock.hpp"
#include "daemon/service/event_log.hpp"
#include "daemon/service/urgency.hpp"
#include "daemon/writeback/background.hpp"
#include "proto/result.hpp"

namespace odomcalib {

class Loop;

class Service {
 public:
  /// Opens the control socket and the journal; devices may be absent and are opened by the loop.
  /// Errors: io, usage, format (configuration, profile).
  /// @param disk null: a thread of its own
  /// @param log empty: events are not logged
  /// @param urgency of the thread that calls poll_once(), for `check`
  static Result<std::unique_ptr<Service>> create(const Config& config, Clock& clock, Calibrator calibrator,
                                                 std::unique_ptr<Background> disk = nullptr,
                                                 EventLog log = {}, Urgency urgency = {});
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// One turn of the loop: waits at most `timeout_ms` for input (less while the robot moves), then serves
  /// everything that is due by the clock.
  void poll_once(int timeout_ms);

  /// Zero command, quick stop, end of whatever runs (SIGTERM, ExecStop). From then on nothing new begins: of
  /// what clients ask for, status is reported and stops are obeyed. A write-back that runs goes on.
  void stop_all(const std::string& why);
  /// The axes have no torque, as far as the controller says: the program may end.
  [[nodiscard]] bool drive_off() const;
  /// Values are on their way to the controller: to end now would leave it to the next start to find out
  /// which.
  [[nodiscard]] bool writing() const;
  /// One line for systemd's STATUS and for people.
  [[nodiscard]] std::string status_line() const;
  /// Output of `odomcalibctl status --json`.
  [[nodiscard]] std::string status_json() const;

 private:
  explicit Service(std::unique_ptr<Loop> loop);
  std::unique_ptr<Loop> loop_;
};

}  // namespace odomcalib
