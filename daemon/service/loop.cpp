#include "daemon/service/loop.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "daemon/service/methods/methods.hpp"
#include "daemon/service/settings.hpp"
#include "daemon/service/status_report.hpp"
#include "daemon/service/write_outcome.hpp"

namespace odomcalib {
Loop::Loop(const Config& configuration, Clock& clock, Calibrator functions, Opened opened,
           std::unique_ptr<Background> disk, EventLog log)
    : parts_(configuration, clock, std::move(functions), std::move(opened), std::move(disk), std::move(log)) {
  // The end of a write-back may have been written down and nothing after it.
  settle_from_journal(parts_);
}

void Loop::wait(int timeout_ms) {
  polled_ = {{parts_.drive.link.fd(), POLLIN, 0},
             {parts_.surroundings.link.fd(), POLLIN, 0},
             {parts_.disk->fd(), POLLIN, 0}};  // one that is absent is -1: poll passes it over
  const auto clients = static_cast<std::ptrdiff_t>(polled_.size());
  parts_.outbox.server.watch(polled_);
  const int most =
      task_ && task_->moves() ? std::min(timeout_ms, service::settings::kMovingTurn_ms) : timeout_ms;
  at_once_ = parts_.outbox.server.calls_wait();
  const int limit = at_once_ ? 0 : most;
  parts_.loop.begin(parts_.clock.now(), 1e-3 * limit);
  if (timeout_ms > 0) rest();
  const int count = poll(polled_.data(), polled_.size(), limit);
  if (count == 0 && limit > 0) slept_ = parts_.clock.now();
  guard_.polled(polled_, count);
  const bool any = count > 0;
  lidar_woke_ = any && polled_[1].revents != 0;
  clients_woke_ = any && std::any_of(polled_.begin() + clients, polled_.end(),
                                     [](const pollfd& file) { return file.revents != 0; });
}

// Where there is always something to do, as urgent a loop would leave its processor to nobody, and the kernel
// ends one that never sleeps (LimitRTTIME).
void Loop::rest() {
  if (parts_.clock.now() - slept_ < service::settings::kLongestAwake_s) return;
  (void)poll(nullptr, 0, service::settings::kRest_ms);
  slept_ = parts_.clock.now();
}

// A counter that reports every millisecond must not make everything else turn as often.
bool Loop::due(bool woke, double& next) const {
  if (!woke && parts_.now < next) return false;
  next = parts_.now + service::settings::kIdleStep_s;
  return true;
}

void Loop::turn() {
  using Part = std::pair<const char*, void (Loop::*)()>;
  static constexpr std::array<Part, 7> kParts = {{{"base", &Loop::serve_drive},
                                                  {"lidar", &Loop::serve_lidar},
                                                  {"clients", &Loop::serve_clients},
                                                  {"disk", &Loop::serve_disk},
                                                  {"write-back", &Loop::serve_write_back},
                                                  {nullptr, &Loop::serve_task},
                                                  {"telemetry", &Loop::serve_telemetry}}};
  const auto& clock = parts_.clock;
  parts_.now = clock.now();
  parts_.outbox.begin_turn(parts_.now);
  parts_.loop.passed("waiting", parts_.now);
  for (const auto& [name, serve] : kParts) {
    const char* const of_task = task_ ? task_->part() : "idle";
    (this->*serve)();
    parts_.loop.passed(name != nullptr ? name : of_task, clock.now());
  }
  parts_.drive.link.flush();
  abort_if_stuck();
  const double end = clock.now();
  parts_.loop.passed("sending", end);
  parts_.loop.end(end);
}

void Loop::report(const char* line, const std::optional<LinkWatch::News>& news) {
  if (!news) return;
  parts_.outbox.event(news->good ? messages::Severity::info : messages::Severity::warning, line, news->text);
}

void Loop::abort_if_stuck() {
  const auto& clients = parts_.outbox.server.counters();
  const std::array<std::uint64_t, kPolled.size()> taken = {
      parts_.drive.link.taken(), parts_.surroundings.link.taken(), parts_.disk->taken(),
      clients.accepted + clients.not_permitted, clients.bytes};
  guard_.turned(at_once_, clients.served != std::exchange(served_, clients.served), taken);
  if (guard_.hangs_at().empty()) return;
  stop_drive(parts_.drive, parts_.write_back, parts_.now);
  spdlog::critical("the loop hangs at {}", guard_.hangs_at());
  std::abort();
}

void Loop::serve_drive() {
  const auto news = parts_.drive.serve(parts_.clock, parts_.now);
  report("bus", news.line);
  const RobotDescription robot = news.ticks.empty() ? RobotDescription{} : parts_.drive.robot();
  for (const TickSample& sample : news.ticks) {
    parts_.odometry.add(sample, robot);
    if (parts_.outbox.telemetry.recorder.active()) parts_.recorded.add(sample, robot);
    parts_.outbox.ticks(sample, parts_.odometry.pose(), parts_.applied.corrected(sample));
  }
  for (const auto& happened : news.events) {
    parts_.outbox.event(happened.stop ? messages::Severity::stop : messages::Severity::info, happened.code,
                        happened.text);
    if (happened.stop && task_) task_->drive_stopped(happened.code + ": " + happened.text);
  }
  if (news.state) parts_.outbox.event(messages::Severity::info, "controller_state", name_of(*news.state));
}

void Loop::serve_lidar() {
  if (!due(lidar_woke_, next_lidar_)) return;
  for (const Scan& scan : parts_.surroundings.serve(parts_.clock)) {
    parts_.surroundings.judge(scan, task_ ? task_->twist() : routines::Twist{}, parts_.now);
    parts_.outbox.scan(scan);
    if (task_) task_->scanned(scan);
  }
  report("lidar", parts_.surroundings.take_news());
}

void Loop::serve_clients() {
  ControlServer& server = parts_.outbox.server;
  // The last wait saw every client: where nothing woke it, nothing had arrived.
  if (!due(clients_woke_ || server.calls_wait(), next_clients_)) return parts_.lease.looked(parts_.now);
  const double begin = parts_.clock.now();
  server.step(begin);
  for (const ClientId gone : server.take_gone()) forget(gone);
  if (server.take_stop()) stop_robot({parts_, task_.get()});
  while (const auto call =
             parts_.clock.now() - begin < service::settings::kCallTime_s ? server.next_call() : std::nullopt)
    if (auto begun = handle_call({parts_, task_.get()}, *call)) task_ = std::move(begun);
  parts_.lease.looked(parts_.now);
}

void Loop::forget(ClientId gone) {
  parts_.lease.lost(gone);
  parts_.write_back.forget(gone);
  parts_.outbox.forget(gone);
  if (task_ && task_->caller.client == gone) task_->abandoned(parts_.now);
}

void Loop::serve_disk() {
  parts_.outbox.telemetry.recorder.serve();
  parts_.disk->serve();
}

void Loop::serve_write_back() {
  Drive& drive = parts_.drive;
  const bool may_begin = !task_ || !task_->uses_controller();
  if (const auto report = parts_.write_back.serve(drive.controller(), drive.values_known, may_begin,
                                                  parts_.now, parts_.clock.wall_us()))
    settle_write(parts_, *report);
  look_again_at_history(parts_);
}

void Loop::serve_task() {
  if (task_) settle(task_->turn(parts_.now));
}

void Loop::settle(TaskTurn turn) {
  if (auto* next = std::get_if<Then>(&turn)) task_ = std::move(next->task);
  if (const auto* failed = std::get_if<Failed>(&turn)) {
    parts_.outbox.event(messages::Severity::warning, "failed", failed->error.text());
    parts_.outbox.refuse(task_->caller, failed->error);
    task_.reset();
  }
  if (const auto* done = std::get_if<Done>(&turn)) {
    parts_.outbox.reply(task_->caller, done->reply);
    task_.reset();
  }
}

void Loop::serve_telemetry() {
  if (parts_.outbox.robot_due()) parts_.outbox.send_robot(parts_.drive.described());
  if (parts_.outbox.status_due()) parts_.outbox.send_status(status_report(parts_, task_.get()));
}

void Loop::stop_all(const std::string& why) {
  parts_.now = parts_.clock.now();
  parts_.outbox.begin_turn(parts_.now);
  parts_.ending = true;
  parts_.write_back.end();
  parts_.last_run.daemon_ends();
  const bool moves = task_ && task_->moves();
  if (!moves) return stop_drive(parts_.drive, parts_.write_back, parts_.now);
  settle(task_->daemon_ends({ErrorCode::cancelled, why, "odomcalibd", "start again"}, parts_.now));
}

}  // namespace odomcalib
