#include "daemon/service/service.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "daemon/service/json_text.hpp"
#include "daemon/service/service_impl.hpp"

namespace odomcalib {
namespace {

constexpr std::size_t kKeptEvents = 100;
constexpr int kMovingTimeout = 5;       // ms: control steps every 10 ms need a loop that turns faster
constexpr double kControlStep = 0.010;  // s
constexpr double kIdleStep = 0.020;     // s, between looks at a device or client that says nothing

PoseSample pose_sample(double t, const routines::Pose& pose) {
  return {t, pose.x, pose.y, routines::wrapped(pose.yaw)};
}

}  // namespace

Service::Impl::Impl(const Config& configuration, Clock& time, Calibrator functions, BaseLink base_link,
                    LidarLink lidar_link, ControlServer control_server, Journal write_journal)
    : config(configuration),
      clock(time),
      calibrator(std::move(functions)),
      base(std::move(base_link)),
      lidar(std::move(lidar_link)),
      server(std::move(control_server)),
      journal(std::move(write_journal)),
      transaction(journal),
      history(config.state_dir / "history"),
      in_force_file(config.state_dir),
      telemetry(config.lcm_enabled ? config.lcm_url : "", config.channel_prefix,
                config.state_dir / "recordings"),
      obstacles({.footprint = config.footprint, .acceleration = config.limits.acceleration}) {
  operator_needed = journal.unfinished().has_value();
  base.watch_frames([this](const drivers::CanFrame& frame) {
    if (telemetry.recorder.active()) telemetry.recorder.write_frame(stamp(frame.t).utime, frame);
  });
  // The end of a write-back may have been written down and nothing after it.
  const auto& last = journal.last();
  const bool committed = last && last->state == JournalState::commit;
  (void)settle_calibration(committed ? last->calibration : "");
}

void Service::Impl::wait(int timeout_ms) {
  polled = {{base.fd(), POLLIN, 0},
            {lidar.fd(), POLLIN, 0}};  // one that is absent is -1: poll passes it over
  const auto clients = static_cast<std::ptrdiff_t>(polled.size());
  server.watch(polled);
  const int limit = run ? std::min(timeout_ms, kMovingTimeout) : timeout_ms;
  loop.begin(clock.now(), 1e-3 * limit);
  const bool any = poll(polled.data(), polled.size(), limit) > 0;
  lidar_woke = any && polled[1].revents != 0;
  clients_woke = any && std::any_of(polled.begin() + clients, polled.end(),
                                    [](const pollfd& file) { return file.revents != 0; });
}

// A counter that reports every millisecond must not make everything else turn as often.
bool Service::Impl::due(bool woke, double& next) const {
  if (!woke && now < next) return false;
  next = now + kIdleStep;
  return true;
}

void Service::Impl::turn() {
  using Part = std::pair<const char*, void (Impl::*)()>;
  static constexpr std::array<Part, 8> kParts = {{{"base", &Impl::serve_base},
                                                  {"lidar", &Impl::serve_lidar},
                                                  {"clients", &Impl::serve_clients},
                                                  {"motion", &Impl::serve_motion},
                                                  {"solver", &Impl::serve_solver},
                                                  {"write-back", &Impl::serve_writeback},
                                                  {"recording", &Impl::serve_recording},
                                                  {"telemetry", &Impl::serve_telemetry}}};
  now = clock.now();
  loop.passed("waiting", now);
  for (const auto& [name, serve] : kParts) {
    (this->*serve)();
    loop.passed(name, clock.now());
  }
  base.flush();
  const double end = clock.now();
  loop.passed("sending", end);
  loop.end(end);
}

void Service::Impl::serve_base() {
  base.step(clock);
  const auto samples = base.controller().take_ticks();
  const RobotDescription description = samples.empty() ? RobotDescription{} : robot();
  for (const TickSample& sample : samples) {
    ++tick_count;
    encoders.seen(sample, now);
    newest_ticks = sample;
    odometry.add(sample, description);
    telemetry.emit(stamp(sample.t).utime, "TICKS", messages::encode(stamp(sample.t), sample));
    telemetry.publisher.send("ODOM",
                             messages::encode(stamp(sample.t), pose_sample(sample.t, odometry.pose())));
    if (corrected)
      telemetry.publisher.send("ODOM_CALIBRATED", messages::encode(stamp(sample.t), (*corrected)(sample)));
  }
  for (const auto& happened : base.controller().take_events()) {
    event(happened.stop ? messages::Severity::stop : messages::Severity::info, happened.code, happened.text);
    if (happened.stop && run) run->fault(happened.code + ": " + happened.text);
  }
  const auto state = base.controller().state();
  if (state != controller_state) event(messages::Severity::info, "controller_state", name_of(state));
  controller_state = state;
}

void Service::Impl::serve_lidar() {
  if (!due(lidar_woke, next_lidar)) return;
  lidar.step(clock);
  for (Scan& scan : lidar.take_scans()) {
    ++scan_count;
    scans.seen(scan, now);
    cover.seen(scan, config.lidar_pose, config.footprint, now);
    newest_points = safety::points_of(scan, config.lidar_pose);
    obstacles.seen(newest_points, run ? run->twist() : routines::Twist{});
    const messages::Stamp when = stamp(scan.t);
    telemetry.emit(when.utime, "SCAN", messages::encode(when, scan));
    if (run) run->seen(scan);
    if (run && run->driving()) watch_agreement(scan);
    newest_scan = std::move(scan);
  }
}

void Service::Impl::serve_motion() {
  if (!run || now < next_command) return;
  next_command = now + kControlStep;
  watch_loop();
  if (const auto problem = telemetry.recorder.problem()) run->stop(*problem);
  Situation situation;
  situation.now = now;
  situation.odometry = odometry.pose();
  situation.ticks = newest_ticks;
  situation.lapsed = lapsed();
  situation.stale = encoders.stale(now) ? encoders.stale(now) : scans.stale(now);
  situation.disagreement = disagreement;
  situation.blocked = obstacles.blocked();
  run->step(situation);
  const auto rates = routines::to_wheels(run->twist(), geometry());
  encoders.commanded(rates.left, rates.right, now);
  if (run->ended()) return motion_ended();
  progress(run->activity(), run->fraction(), run->remaining(now));
}

void Service::Impl::serve_solver() {
  if (!solver) return;
  const auto [phase, fraction] = solver->progress();
  progress("solve: " + phase, fraction, std::nullopt);
  auto result = solver->take_result();
  if (!result) return;
  if (const auto problem = solver->not_kept())
    event(messages::Severity::warning, "not_kept", problem->text());
  solver.reset();
  if (*solve_cancelled)
    return fail_pending({ErrorCode::cancelled, "stopped on request", "solve",
                         "the recording is kept: odomcalibctl solve " + recording_path.string()});
  if (!*result) return fail_pending(result->error());
  const std::string text = to_json(result->value());
  telemetry.publisher.send("RESULT", messages::encode_json(clock.wall_us(), "odomcalib-calibration/1", text));
  ordered_json answer_body = {{"recording", recording_path.string()},
                              {"calibration", ordered_json::parse(text)}};
  if (calibrator.next_manoeuvre)
    if (const auto next = calibrator.next_manoeuvre(result->value()))
      answer_body["next"] = {{"manoeuvre", next->name}, {"why", next->why}};
  finish_pending(answer_body);
}

void Service::Impl::serve_recording() {
  telemetry.recorder.serve();
  if (!pending || pending->method != "Record" || pending->ending) return;
  const bool over = pending->until > 0.0 && now >= pending->until;
  progress("recording", 0.0, pending->until > 0.0 ? std::optional(pending->until - now) : std::nullopt);
  if (!over && !telemetry.recorder.problem()) return;
  pending->ending = true;
  telemetry.recorder.finish([this](const Result<std::filesystem::path>& path) {
    if (!path) return fail_pending(path.error());
    answer(pending->client, {{"path", path.value().string()}});
    pending.reset();
  });
}

void Service::Impl::serve_telemetry() {
  if (now >= next_robot) {
    next_robot = now + 10.0;
    const std::int64_t utime = clock.wall_us();
    telemetry.emit(utime, "ROBOT", messages::encode(utime, robot()));
  }
  if (now >= next_status) {
    next_status = now + 1.0;
    telemetry.publisher.serve(now);
    telemetry.publisher.send(
        "STATUS", messages::encode_json(clock.wall_us(), "odomcalib-status/1", json_text(status())));
  }
}

void Service::Impl::progress(const std::string& phase, double fraction, std::optional<double> eta) {
  if (now < next_progress) return;
  next_progress = now + 0.2;
  ordered_json body = {{"phase", phase}, {"fraction", fraction}, {"eta", nullptr}, {"hint", nullptr}};
  if (eta) body["eta"] = *eta;
  telemetry.publisher.send("PROGRESS",
                           messages::encode_json(clock.wall_us(), "odomcalib-progress/1", json_text(body)));
  if (pending && pending->more)
    server.reply(pending->client, control::encode_reply(json_text({{"progress", body}}), true));
}

void Service::Impl::event(messages::Severity severity, const std::string& code, const std::string& text) {
  telemetry.emit(clock.wall_us(), "EVENT", messages::encode_event(stamp(now), severity, code, text));
  events.push_back(
      {{"time", clock.wall_us()}, {"severity", static_cast<int>(severity)}, {"code", code}, {"text", text}});
  if (events.size() > kKeptEvents) events.pop_front();
  for (const ClientId client : monitors)
    server.reply(client, control::encode_reply(json_text({{"event", events.back()}}), true));
}

messages::Stamp Service::Impl::stamp(double t) const {
  const auto age_us = static_cast<std::int64_t>(std::llround((now - t) * 1e6));
  return {clock.wall_us() - age_us, static_cast<std::int64_t>(std::llround(t * 1e9))};
}

RobotDescription Service::Impl::nominal() const {
  RobotDescription all = base.controller().description();
  const RobotDescription& given = config.robot;
  if (given.left_wheel_diameter > 0.0) all.left_wheel_diameter = given.left_wheel_diameter;
  if (given.right_wheel_diameter > 0.0) all.right_wheel_diameter = given.right_wheel_diameter;
  if (given.track_width > 0.0) all.track_width = given.track_width;
  all.lidar_pose = config.lidar_pose;
  if (!given.robot_id.empty()) all.robot_id = given.robot_id;
  return all;
}

RobotDescription Service::Impl::robot() const {
  RobotDescription all = nominal();
  for (const auto& parameter : in_force) {
    if (parameter.quantity == "left_wheel_diameter") all.left_wheel_diameter = parameter.value;
    if (parameter.quantity == "right_wheel_diameter") all.right_wheel_diameter = parameter.value;
    if (parameter.quantity == "track_width") all.track_width = parameter.value;
  }
  return all;
}

Service::Service(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Service::~Service() { stop_all("the daemon ends"); }

Result<std::unique_ptr<Service>> Service::create(const Config& config, Clock& clock, Calibrator calibrator) {
  auto base = BaseLink::create(config.controller_device, config.controller_profile);
  if (!base) return base.error();
  auto lidar = LidarLink::create(config.lidar_device, config.lidar_type);
  if (!lidar) return lidar.error();
  auto journal = Journal::open(config.state_dir / "journal");
  if (!journal) return journal.error();
  auto server = ControlServer::create(config.socket, config.group);
  if (!server) return server.error();
  auto impl =
      std::make_unique<Impl>(config, clock, std::move(calibrator), std::move(base).value(),
                             std::move(lidar).value(), std::move(server).value(), std::move(journal).value());
  impl->now = clock.now();
  return std::unique_ptr<Service>(new Service(std::move(impl)));
}

void Service::poll_once(int timeout_ms) {
  impl_->wait(timeout_ms);
  impl_->turn();
}

void Service::stop_all(const std::string& why) {
  impl_->now = impl_->clock.now();
  impl_->ending = true;
  impl_->next_read = std::numeric_limits<double>::infinity();
  const Error error{ErrorCode::cancelled, why, "odomcalibd", "start again"};
  if (impl_->run) {
    impl_->run->stop(error);
    impl_->motion_ended();
  } else {
    impl_->stop_drive();
  }
}

bool Service::Impl::drive_off() const {
  const auto state = base.controller().state();
  return !base.connected() ||
         (state != drivers::ControllerState::enabled && state != drivers::ControllerState::enabling);
}

// A quick stop makes the controller refuse parameters for a moment: in the middle of a write-back, which
// begins only when the axes are off, it would stop nothing and leave the values half written.
void Service::Impl::stop_drive() {
  if (transaction.busy() && drive_off()) return;
  base.controller().quick_stop(now);
  base.flush();
}

bool Service::drive_off() const { return impl_->drive_off(); }

bool Service::writing() const { return impl_->transaction.busy(); }

std::string Service::status_line() const { return impl_->activity(); }
std::string Service::status_json() const { return json_text(impl_->status()); }

}  // namespace odomcalib
