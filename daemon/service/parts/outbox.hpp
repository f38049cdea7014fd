// Output of the service: replies to clients, events and progress, telemetry and recordings.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/service/clock.hpp"
#include "daemon/service/control_server.hpp"
#include "daemon/service/event_log.hpp"
#include "daemon/service/event_rate.hpp"
#include "daemon/service/telemetry.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib {

using nlohmann::ordered_json;

/// The client that waits for the end of what it asked for.
struct Caller {
  ClientId client = 0;
  bool more = false;    ///< it takes progress reports meanwhile
  bool oneway = false;  ///< it wants no reply at all
};

class Outbox {
 public:
  /// @param time outlives this
  Outbox(ControlServer control_server, const Config& config, const Clock& time, EventLog log);
  /// Messages sent until the next turn carry this time.
  void begin_turn(double now) { now_ = now; }

  void reply(const Caller& caller, const std::string& frame);
  void answer(const Caller& caller, const ordered_json& parameters);
  void refuse(const Caller& caller, const Error& error);
  /// A member of the call is missing or of a wrong type.
  void refuse_parameter(const Caller& caller, const std::string& name);
  void refuse_method(const Caller& caller, const std::string& name);

  /// To the journal, the recording, over LCM and to every client that monitors; see EventRate.
  void event(messages::Severity severity, const std::string& code, const std::string& text);
  void monitor(ClientId client) { monitors_.insert(client); }
  void forget(ClientId client) { monitors_.erase(client); }
  /// Some times a second at most, however often it is called.
  void progress(const Caller& caller, const std::string& phase, double fraction, std::optional<double> eta);

  /// Progress as it was sent last: phase, fraction, eta; null when nothing was sent for a second.
  [[nodiscard]] ordered_json last_progress() const;

  /// The robot's description goes into recordings: again in this turn, or at once.
  void send_robot_soon() { next_robot_ = now_; }
  void send_robot(const RobotDescription& robot);
  [[nodiscard]] bool robot_due() const { return now_ >= next_robot_; }
  [[nodiscard]] bool status_due() const { return now_ >= next_status_; }
  void send_status(const ordered_json& status);
  void send_result(const std::string& calibration);
  /// Sends the paths of the drive that was solved, for viewers: one message a path, all in one frame.
  void send_paths(const std::vector<PathTrace>& paths);
  void ticks(const TickSample& sample, const routines::Pose& odometry,
             const std::optional<PoseSample>& corrected);
  void scan(const Scan& scan);
  void frame(const drivers::CanFrame& frame);

  ControlServer server;
  Telemetry telemetry;

 private:
  [[nodiscard]] messages::Stamp stamp(double t) const;

  const Clock& clock_;
  EventLog log_;
  EventRate rate_;
  double now_ = 0.0;
  std::set<ClientId> monitors_;
  ordered_json last_progress_;
  double last_progress_at_ = 0.0;
  bool lcm_told_ = false;  // that it cannot be opened
  double next_robot_ = 0.0, next_status_ = 0.0, next_progress_ = 0.0;
};

}  // namespace odomcalib
