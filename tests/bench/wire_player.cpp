#include "tests/bench/wire_player.hpp"

#include <time.h>

#include <algorithm>

namespace odomcalib::bench {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;  // ns
constexpr double kTurn = 0.025;                   // s, 40 scans a second

std::int64_t now_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

void sleep_until(std::int64_t monotonic_ns) {
  const timespec time{monotonic_ns / 1'000'000'000, monotonic_ns % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) != 0) continue;
}

sim::ScipDevice::Options lidar_options() {
  sim::ScipDevice::Options options;
  options.period = kTurn;
  options.still_after = 5.0;
  return options;
}

bool is_report(const sim::Frame& frame) { return frame.id == 0x181; }

std::int64_t count_of(const sim::Frame& frame) {
  std::uint32_t count = 0;
  for (std::size_t i = 4; i-- > 0;) count = count << 8 | frame.data[i];
  return count;
}

}  // namespace

std::int64_t wall_ns() { return now_of(CLOCK_REALTIME); }

WirePlayer::WirePlayer(double seconds)
    : can_(std::move(sim::Pty::open()).value()),
      tcp_(std::move(sim::TcpPort::open()).value()),
      node_({}),
      lidar_(lidar_options()),
      sent_(static_cast<std::size_t>(1000.0 * seconds)),
      scans_sent_at_(static_cast<std::size_t>(seconds / kTurn)),
      thread_([this] { play(); }) {}

WirePlayer::~WirePlayer() {
  ended_ = true;
  thread_.join();
}

std::string WirePlayer::lidar_device() const { return "tcp:127.0.0.1:" + std::to_string(tcp_->port()); }

std::int64_t WirePlayer::sent_at(std::int64_t count) const {
  const bool known = count >= 0 && count < static_cast<std::int64_t>(sent_.size());
  return known ? sent_[static_cast<std::size_t>(count)] : 0;
}

std::int64_t WirePlayer::scan_sent_at(std::size_t i) const {
  return i < scans_sent_at_.size() ? scans_sent_at_[i] : 0;
}

void WirePlayer::turn_drive() {
  const double now = 1e-3 * static_cast<double>(millisecond_);
  sim::WheelState wheels;
  wheels.counts = {millisecond_, millisecond_};
  node_.advance(now, wheels);
  for (const sim::Frame& frame : can_.receive()) node_.receive(frame, now);
  const auto frames = node_.take_frames(now);
  for (const sim::Frame& frame : frames) {
    if (!is_report(frame)) continue;
    const std::int64_t count = count_of(frame);
    if (count < static_cast<std::int64_t>(sent_.size())) sent_[static_cast<std::size_t>(count)] = wall_ns();
    newest_ = count;
  }
  can_.deliver(frames, now);
}

void WirePlayer::turn_lidar() {
  const double now = 1e-3 * static_cast<double>(millisecond_);
  tcp_->accept();
  lidar_.from_host(tcp_->read(), now);
  lidar_.advance(now);
  const std::string bytes = lidar_.take(now);
  if (bytes.size() > 3000) {  // a scan; other replies are short
    if (scans_ < scans_sent_at_.size()) scans_sent_at_[scans_] = wall_ns();
    ++scans_;
  }
  tcp_->write(bytes);
}

void WirePlayer::play() {
  const std::int64_t start = now_of(CLOCK_MONOTONIC);
  while (!ended_) {
    const std::int64_t due = start + ++millisecond_ * kMillisecond;
    sleep_until(due);
    if (now_of(CLOCK_MONOTONIC) - due > kMillisecond / 2) ++late_;
    turn_drive();
    turn_lidar();
  }
}

}  // namespace odomcalib::bench
