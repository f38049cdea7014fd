#include "daemon/service/parts/outbox.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "daemon/service/json_text.hpp"
#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

PoseSample pose_sample(double t, const routines::Pose& pose) {
  return {t, pose.x, pose.y, routines::wrapped(pose.yaw)};
}

/// The reference is called by its usual kind on LCM.
std::string lcm_name_of(const PathTrace& path) { return path.name == "reference" ? "scan" : path.name; }

}  // namespace

Outbox::Outbox(ControlServer control_server, const Config& config, const Clock& time, EventLog log)
    : server(std::move(control_server)),
      telemetry(config.lcm_enabled ? config.lcm_url : "", config.channel_prefix,
                config.state_dir / "recordings", config.keep_recordings),
      clock_(time),
      log_(std::move(log)) {}

void Outbox::reply(const Caller& caller, const std::string& frame) {
  if (!caller.oneway) server.reply(caller.client, frame);
}

void Outbox::answer(const Caller& caller, const ordered_json& parameters) {
  reply(caller, control::encode_reply(json_text(parameters)));
}

void Outbox::refuse(const Caller& caller, const Error& error) { reply(caller, control::encode_error(error)); }

void Outbox::refuse_parameter(const Caller& caller, const std::string& name) {
  reply(caller, control::encode_invalid_parameter(name));
}

void Outbox::refuse_method(const Caller& caller, const std::string& name) {
  reply(caller, control::encode_method_not_implemented(name));
}

void Outbox::event(messages::Severity severity, const std::string& code, const std::string& happened) {
  const auto left_out = rate_.admit(code, now_);
  if (!left_out) return;
  const std::string text =
      *left_out > 0 ? fmt::format("{} (after {} more that are left out)", happened, *left_out) : happened;
  if (log_) log_(severity, code, text);
  const std::int64_t time = clock_.wall_us();
  telemetry.emit(time, "EVENT", messages::encode_event(stamp(now_), severity, code, text));
  const ordered_json body = {
      {"time", time}, {"severity", static_cast<int>(severity)}, {"code", code}, {"text", text}};
  for (const ClientId client : monitors_)
    server.reply(client, control::encode_reply(json_text({{"event", body}}), true));
}

void Outbox::progress(const Caller& caller, const std::string& phase, double fraction,
                      std::optional<double> eta) {
  if (now_ < next_progress_) return;
  next_progress_ = now_ + service::settings::kProgressPeriod_s;
  ordered_json body = {{"phase", phase}, {"fraction", fraction}, {"eta", nullptr}, {"hint", nullptr}};
  if (eta) body["eta"] = *eta;
  last_progress_ = {{"phase", phase}, {"fraction", fraction}, {"eta", body["eta"]}};
  last_progress_at_ = now_;
  telemetry.publisher.send("PROGRESS",
                           messages::encode_json(clock_.wall_us(), "odomcalib-progress/1", json_text(body)));
  if (caller.more) server.reply(caller.client, control::encode_reply(json_text({{"progress", body}}), true));
}

ordered_json Outbox::last_progress() const {
  return now_ - last_progress_at_ < service::settings::kProgressLasts_s ? last_progress_ : ordered_json();
}

void Outbox::send_robot(const RobotDescription& robot) {
  next_robot_ = now_ + service::settings::kRobotPeriod_s;
  const std::int64_t utime = clock_.wall_us();
  telemetry.emit(utime, "ROBOT", messages::encode(utime, robot));
}

void Outbox::send_status(const ordered_json& status) {
  next_status_ = now_ + service::settings::kStatusPeriod_s;
  telemetry.publisher.serve(now_);
  // LCM itself writes the cause to standard error, without the key.
  if (const auto url = telemetry.publisher.refused(); !url.empty() && !std::exchange(lcm_told_, true))
    event(messages::Severity::warning, "lcm",
          fmt::format(
              "lcm.url = \"{}\" cannot be opened: no telemetry leaves; correct it, see that multicast has "
              "a route, or set lcm.enabled = false; it is tried again every {:.0f} s",
              url, service::settings::kPublisherRetry_s));
  telemetry.publisher.send("STATUS",
                           messages::encode_json(clock_.wall_us(), "odomcalib-status/1", json_text(status)));
}

void Outbox::send_result(const std::string& calibration) {
  telemetry.publisher.send("RESULT",
                           messages::encode_json(clock_.wall_us(), "odomcalib-calibration/1", calibration));
}

void Outbox::send_paths(const std::vector<PathTrace>& paths) {
  const std::int64_t utime = clock_.wall_us();
  for (const PathTrace& path : paths) {
    std::vector<PoseSample> poses;
    for (const auto& [x, y, yaw] : path.points) poses.push_back({0.0, x, y, yaw});
    telemetry.publisher.send("PATH", messages::encode_path(utime, lcm_name_of(path), poses));
  }
}

void Outbox::ticks(const TickSample& sample, const routines::Pose& odometry,
                   const std::optional<PoseSample>& corrected) {
  const messages::Stamp when = stamp(sample.t);
  telemetry.emit(when.utime, "TICKS", messages::encode(when, sample));
  telemetry.publisher.send("ODOM", messages::encode(when, pose_sample(sample.t, odometry)));
  if (corrected) telemetry.publisher.send("ODOM_CALIBRATED", messages::encode(when, *corrected));
}

void Outbox::scan(const Scan& scan) {
  const messages::Stamp when = stamp(scan.t);
  telemetry.emit(when.utime, "SCAN", messages::encode(when, scan));
}

void Outbox::frame(const drivers::CanFrame& frame) {
  if (telemetry.recorder.active()) telemetry.recorder.write_frame(stamp(frame.t).utime, frame);
}

messages::Stamp Outbox::stamp(double t) const {
  const auto age_us = static_cast<std::int64_t>(std::llround((now_ - t) * 1e6));
  return {clock_.wall_us() - age_us, static_cast<std::int64_t>(std::llround(t * 1e9))};
}

}  // namespace odomcalib
