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
    : bench_(configuration, clock, std::move(functions), std::move(opened), std::move(disk), std::move(log)) {
  // The end of a write-back may have been written down and nothing after it.
  settle_from_journal(bench_);
}

void Loop::wait(int timeout_ms) {
  polled_ = {{bench_.drive.link.fd(), POLLIN, 0},
             {bench_.surroundings.link.fd(), POLLIN, 0},
             {bench_.disk->fd(), POLLIN, 0}};  // one that is absent is -1: poll passes it over
  const auto clients = static_cast<std::ptrdiff_t>(polled_.size());
  bench_.outbox.server.watch(polled_);
  const int most =
      task_ && task_->moves() ? std::min(timeout_ms, service::settings::kMovingTurn_ms) : timeout_ms;
  at_once_ = bench_.outbox.server.calls_wait();
  const int limit = at_once_ ? 0 : most;
  bench_.loop.begin(bench_.clock.now(), 1e-3 * limit);
  if (timeout_ms > 0) rest();
  const int count = poll(polled_.data(), polled_.size(), limit);
  if (count == 0 && limit > 0) slept_ = bench_.clock.now();
  guard_.polled(polled_, count);
  const bool any = count > 0;
  lidar_woke_ = any && polled_[1].revents != 0;
  clients_woke_ = any && std::any_of(polled_.begin() + clients, polled_.end(),
                                     [](const pollfd& file) { return file.revents != 0; });
}

// Where there is always something to do, as urgent a loop would leave its processor to nobody, and the kernel
// ends one that never sleeps (LimitRTTIME).
void Loop::rest() {
  if (bench_.clock.now() - slept_ < service::settings::kLongestAwake_s) return;
  (void)poll(nullptr, 0, service::settings::kRest_ms);
  slept_ = bench_.clock.now();
}

// A counter that reports every millisecond must not make everything else turn as often.
bool Loop::due(bool woke, double& next) const {
  if (!woke && bench_.now < next) return false;
  next = bench_.now + service::settings::kIdleStep_s;
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
  const auto& clock = bench_.clock;
  bench_.now = clock.now();
  bench_.outbox.begin_turn(bench_.now);
  bench_.loop.passed("waiting", bench_.now);
  for (const auto& [name, serve] : kParts) {
    const char* const of_task = task_ ? task_->part() : "idle";
    (this->*serve)();
    bench_.loop.passed(name != nullptr ? name : of_task, clock.now());
  }
  bench_.drive.link.flush();
  see_that_it_gets_on();
  const double end = clock.now();
  bench_.loop.passed("sending", end);
  bench_.loop.end(end);
}

void Loop::report(const char* line, const std::optional<LinkWatch::News>& news) {
  if (!news) return;
  bench_.outbox.event(news->good ? messages::Severity::info : messages::Severity::warning, line, news->text);
}

void Loop::see_that_it_gets_on() {
  const auto& clients = bench_.outbox.server.counters();
  const std::array<std::uint64_t, kPolled.size()> taken = {
      bench_.drive.link.taken(), bench_.surroundings.link.taken(), bench_.disk->taken(),
      clients.accepted + clients.not_permitted, clients.bytes};
  guard_.turned(at_once_, clients.served != std::exchange(served_, clients.served), taken);
  if (guard_.hangs_at().empty()) return;
  stop_drive(bench_);
  spdlog::critical("the loop hangs at {}", guard_.hangs_at());
  std::abort();
}

void Loop::serve_drive() {
  const auto news = bench_.drive.serve(bench_.clock, bench_.now);
  report("bus", news.line);
  const RobotDescription robot = news.ticks.empty() ? RobotDescription{} : bench_.drive.robot();
  for (const TickSample& sample : news.ticks) {
    bench_.odometry.add(sample, robot);
    if (bench_.outbox.telemetry.recorder.active()) bench_.recorded.add(sample, robot);
    bench_.outbox.ticks(sample, bench_.odometry.pose(), bench_.applied.corrected(sample));
  }
  for (const auto& happened : news.events) {
    bench_.outbox.event(happened.stop ? messages::Severity::stop : messages::Severity::info, happened.code,
                        happened.text);
    if (happened.stop && task_) task_->drive_stopped(happened.code + ": " + happened.text);
  }
  if (news.state) bench_.outbox.event(messages::Severity::info, "controller_state", name_of(*news.state));
}

void Loop::serve_lidar() {
  if (!due(lidar_woke_, next_lidar_)) return;
  for (const Scan& scan : bench_.surroundings.serve(bench_.clock)) {
    bench_.surroundings.judge(scan, task_ ? task_->twist() : routines::Twist{}, bench_.now);
    bench_.outbox.scan(scan);
    if (task_) task_->scanned(bench_, scan);
  }
  report("lidar", bench_.surroundings.take_news());
}

void Loop::serve_clients() {
  ControlServer& server = bench_.outbox.server;
  // The last wait saw every client: where nothing woke it, nothing had arrived.
  if (!due(clients_woke_ || server.calls_wait(), next_clients_)) return bench_.lease.looked(bench_.now);
  const double begin = bench_.clock.now();
  server.step(begin);
  for (const ClientId gone : server.take_gone()) forget(gone);
  if (server.take_stop()) stop_robot({bench_, task_.get()});
  while (const auto call =
             bench_.clock.now() - begin < service::settings::kCallTime_s ? server.next_call() : std::nullopt)
    if (auto begun = handle_call({bench_, task_.get()}, *call)) task_ = std::move(begun);
  bench_.lease.looked(bench_.now);
}

void Loop::forget(ClientId gone) {
  bench_.lease.lost(gone);
  bench_.write_back.forget(gone);
  bench_.outbox.forget(gone);
  if (task_ && task_->caller.client == gone) task_->abandoned(bench_);
}

void Loop::serve_disk() {
  bench_.outbox.telemetry.recorder.serve();
  bench_.disk->serve();
}

void Loop::serve_write_back() {
  Drive& drive = bench_.drive;
  const bool may_begin = !task_ || !task_->uses_controller();
  if (const auto report = bench_.write_back.serve(drive.controller(), drive.values_known, may_begin,
                                                  bench_.now, bench_.clock.wall_us()))
    settle_write(bench_, *report);
}

void Loop::serve_task() {
  if (task_) settle(task_->turn(bench_));
}

void Loop::settle(TaskTurn turn) {
  if (auto* next = std::get_if<Then>(&turn)) task_ = std::move(next->task);
  if (const auto* failed = std::get_if<Failed>(&turn)) {
    bench_.outbox.event(messages::Severity::warning, "failed", failed->error.text());
    bench_.outbox.refuse(task_->caller, failed->error);
    task_.reset();
  }
  if (const auto* done = std::get_if<Done>(&turn)) {
    bench_.outbox.reply(task_->caller, done->reply);
    task_.reset();
  }
}

void Loop::serve_telemetry() {
  if (bench_.outbox.robot_due()) bench_.outbox.send_robot(bench_.drive.described());
  if (bench_.outbox.status_due()) bench_.outbox.send_status(status_report(bench_, task_.get()));
}

void Loop::stop_all(const std::string& why) {
  bench_.now = bench_.clock.now();
  bench_.outbox.begin_turn(bench_.now);
  bench_.ending = true;
  bench_.write_back.end();
  bench_.last_run.daemon_ends();
  const bool moves = task_ && task_->moves();
  if (!moves) return stop_drive(bench_);
  settle(task_->daemon_ends(bench_, {ErrorCode::cancelled, why, "odomcalibd", "start again"}));
}

}  // namespace odomcalib
