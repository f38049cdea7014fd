// The state of the service, shared by the files service*.cpp and by nobody else.
#pragma once

#include <poll.h>

#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/safety/cover.hpp"
#include "daemon/safety/freshness.hpp"
#include "daemon/safety/lease.hpp"
#include "daemon/safety/obstacle.hpp"
#include "daemon/service/base_link.hpp"
#include "daemon/service/call_parameters.hpp"
#include "daemon/service/cancellable.hpp"
#include "daemon/service/control_server.hpp"
#include "daemon/service/dead_reckoning.hpp"
#include "daemon/service/lidar_link.hpp"
#include "daemon/service/loop_watch.hpp"
#include "daemon/service/motion_run.hpp"
#include "daemon/service/service.hpp"
#include "daemon/service/solver_job.hpp"
#include "daemon/service/telemetry.hpp"
#include "daemon/writeback/calibration_in_force.hpp"
#include "daemon/writeback/history.hpp"
#include "daemon/writeback/journal.hpp"
#include "daemon/writeback/rounding.hpp"
#include "daemon/writeback/transaction.hpp"

namespace odomcalib {

using nlohmann::ordered_json;

/// The call that a client waits for; one at a time.
struct PendingCall {
  ClientId client = 0;
  std::string method;
  bool more = false;
  std::string lease;
  std::vector<std::string> effects{"auto"};
  std::vector<std::filesystem::path> earlier;  ///< recordings to be solved together with the new one
  std::optional<std::string> calibration;      ///< JSON text, apply and rollback
  RoundingError rounding;                      ///< of what is written
  double until = 0.0;                          ///< s, end of a recording without motion; 0: until Stop
  bool ending = false;                         ///< the recording is being written to its end
};

/// What a rollback goes back to.
struct FormerValues {
  ParameterMap values;
  std::optional<std::string> calibration;  ///< JSON text; nullopt: none was in force
};

/// Share of a length; one that is further from what is known of it is another robot's.
inline constexpr double kPlausible = 0.15;

struct Service::Impl {
  Impl(const Config& configuration, Clock& time, Calibrator functions, BaseLink base_link,
       LidarLink lidar_link, ControlServer control_server, Journal write_journal);

  // service.cpp: the loop
  void wait(int timeout_ms);
  /// Whether this woke the loop, or was not looked at for a while; then `next` is set anew.
  bool due(bool woke, double& next) const;
  void turn();
  void serve_base();
  void serve_lidar();
  void serve_motion();
  void serve_solver();
  void serve_writeback();
  void serve_recording();
  void serve_telemetry();

  void stop_drive();
  [[nodiscard]] bool drive_off() const;

  // service_calls.cpp: what clients ask for
  void serve_clients();
  void forget(ClientId gone);
  void handle(const IncomingCall& incoming);
  void dispatch(const IncomingCall& incoming, const ordered_json& parameters);
  void call_monitor(const IncomingCall& incoming);
  void call_stop(const IncomingCall& incoming);
  void call_straight(const IncomingCall& incoming, const ordered_json& parameters);
  void call_spin(const IncomingCall& incoming, const ordered_json& parameters);
  void call_calibrate(const IncomingCall& incoming, const ordered_json& parameters);
  Result<routines::Plan> calibration_plan(CallParameters& options) const;
  void call_record(const IncomingCall& incoming, const ordered_json& parameters);
  void call_apply(const IncomingCall& incoming, const ordered_json& parameters);
  void call_set(const IncomingCall& incoming, const ordered_json& parameters);
  void call_rollback(const IncomingCall& incoming, const ordered_json& parameters);
  void call_history(const IncomingCall& incoming, const ordered_json& parameters);
  void answer(ClientId client, const ordered_json& parameters);
  void refuse(ClientId client, const Error& error);
  /// A member of the call is missing or of a wrong type.
  void refuse_parameter(ClientId client, const std::string& name);

  // service_check.cpp
  void call_check(const IncomingCall& incoming, const ordered_json& parameters);
  ordered_json nudge_report(const std::vector<Leg>& legs) const;

  // service_motion.cpp: guided motions
  std::optional<Error> motion_forbidden(const routines::Preview& preview) const;
  /// Why the wheels' dimensions are no base for a speed.
  std::optional<Error> geometry_forbidden() const;
  void start_motion(const IncomingCall& incoming, const routines::Plan& plan, const ordered_json& parameters,
                    PendingCall pending);
  void motion_ended();
  ordered_json motion_report() const;
  void recording_written(const Result<std::filesystem::path>& path, ordered_json report);
  ordered_json leg_report(const Leg& leg) const;
  void watch_agreement(const Scan& scan);
  void watch_loop();
  std::optional<std::string> lapsed() const;
  routines::WheelGeometry geometry() const;

  // service_writeback.cpp
  std::optional<Error> write_forbidden(const std::string& lease) const;
  void start_write(const IncomingCall& incoming, const ParameterMap& values, PendingCall pending,
                   bool dry_run);
  void begin_reading();
  void learn(const WriteReport& report);
  void write_ended(const WriteReport& report);
  void note_in_history(const WriteReport& report);
  std::optional<Error> settle_calibration(const std::string& id);
  std::optional<FormerValues> former_values(const std::string& id) const;
  void load_active();

  // service_status.cpp
  ordered_json status() const;
  ordered_json describe() const;
  ordered_json checks() const;
  /// @param calibration whose values are shown beside those in force
  ordered_json parameters(const std::optional<Calibration>& calibration) const;
  std::string activity() const;

  void finish_pending(const ordered_json& result);
  void fail_pending(const Error& error);
  void progress(const std::string& phase, double fraction, std::optional<double> eta);
  void event(messages::Severity severity, const std::string& code, const std::string& text);
  [[nodiscard]] messages::Stamp stamp(double t) const;
  /// From profile and configuration.
  [[nodiscard]] RobotDescription nominal() const;
  /// The same with what the controller holds.
  [[nodiscard]] RobotDescription robot() const;

  Config config;
  Clock& clock;
  Calibrator calibrator;
  BaseLink base;
  LidarLink lidar;
  ControlServer server;
  Journal journal;
  Transaction transaction;
  History history;
  CalibrationInForce in_force_file;
  Telemetry telemetry;

  double now = 0.0;
  LoopWatch loop;
  std::vector<pollfd> polled;  ///< what the last wait was for: base, lidar, then the control socket
  bool lidar_woke = false, clients_woke = false;
  safety::Lease lease;
  safety::EncoderFreshness encoders;
  safety::ScanFreshness scans;
  safety::ObstacleGuard obstacles;
  safety::Cover cover;
  DeadReckoning odometry;
  std::optional<Calibrator::Odometry> corrected;
  std::optional<Calibration> active;  ///< applied calibration
  std::vector<drivers::StoredParameter> in_force;
  TickSample newest_ticks;
  std::optional<Scan> newest_scan;
  std::vector<safety::Point> newest_points;
  std::optional<Scan> agreement_scan;  ///< reference of the comparison of odometry and lidar
  routines::Pose agreement_pose;
  std::optional<std::string> disagreement;
  int disagreements = 0;

  std::optional<PendingCall> pending;
  std::optional<MotionRun> run;
  std::optional<SolverJob> solver;
  CancelFlag solve_cancelled;  ///< of the job above
  std::filesystem::path recording_path;
  std::set<ClientId> monitors;
  std::deque<ordered_json> events;  ///< newest last, bounded
  std::string last_stop;            ///< why the robot was stopped last
  bool parameters_known = false;
  bool operator_needed = false;
  std::string write_problem = "an interrupted write-back waits for the controller";  ///< operator_needed: why
  bool recovery_tried = false;  ///< on this connection to the controller
  bool ending = false;          ///< the daemon was told to end
  drivers::ControllerState controller_state = drivers::ControllerState::absent;
  std::uint64_t tick_count = 0, scan_count = 0, late_steps = 0;
  double next_robot = 0.0, next_status = 0.0, next_progress = 0.0, next_command = 0.0, next_read = 0.0;
  double next_lidar = 0.0, next_clients = 0.0;
  double stepped_at = 0.0;    ///< s, last control step of the motion
  double suspended_at = 0.0;  ///< s, Clock::suspended() then
};

std::string name_of(drivers::ControllerState state);

/// The call as something that is waited for.
PendingCall pending_of(const IncomingCall& incoming, const ordered_json& parameters);

}  // namespace odomcalib
