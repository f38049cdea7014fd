#include "tests/sim/wires/sim_robot.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

namespace odomcalib::sim {

namespace {

constexpr double kLidarClockOffset = 12.345;  // s, the device was on before
constexpr double kLidarClockError = 25e-6;    // s/s, its crystal

DriveNodeOptions with_geometry(DriveNodeOptions options, const Geometry& nominal) {
  const auto micrometres = [](double metres) {
    return static_cast<std::uint32_t>(std::llround(1e6 * metres));
  };
  options.geometry_um = {micrometres(nominal.left_diameter), micrometres(nominal.right_diameter),
                         micrometres(nominal.track_width)};
  return options;
}

}  // namespace

SimRobot::SimRobot(const SimRobotOptions& options)
    : options_(options),
      room_(options.room),
      body_(options.truth, options.body, options.seed, options.disturbances),
      head_(room_, options.truth.lidar, options.lidar, options.seed, options.disturbances),
      node_(with_geometry(options.node, options.nominal)),
      stream_(options.lidar, kLidarClockOffset, kLidarClockError) {}

Result<std::unique_ptr<SimRobot>> SimRobot::create(const SimRobotOptions& options) {
  std::unique_ptr<SimRobot> robot(new SimRobot(options));
  if (const auto plugged = robot->plug_can(); !plugged) return plugged.error();
  if (const auto plugged = robot->plug_lidar(); !plugged) return plugged.error();
  return robot;
}

Result<void> SimRobot::plug_can() {
  if (options_.socketcan) {
    auto port = open_socketcan_port(*options_.socketcan);
    if (!port) return port.error();
    can_ = std::move(port).value();
    return {};
  }
  auto pty = Pty::open();
  if (!pty) return pty.error();
  if (!options_.link_dir.empty())
    if (auto linked = pty.value()->link_as(options_.link_dir / "can"); !linked) return linked;
  can_ = std::make_unique<SlcanPort>(std::move(pty).value());
  return {};
}

Result<void> SimRobot::plug_lidar() {
  auto pty = Pty::open();
  if (!pty) return pty.error();
  if (!options_.link_dir.empty())
    if (auto linked = pty.value()->link_as(options_.link_dir / "lidar"); !linked) return linked;
  lidar_pty_ = std::move(pty).value();
  return {};
}

std::string SimRobot::can_path() const {
  if (options_.socketcan) return *options_.socketcan;
  if (!options_.link_dir.empty()) return (options_.link_dir / "can").string();
  const auto* slcan = dynamic_cast<const SlcanPort*>(can_.get());
  return slcan == nullptr ? "" : slcan->pty().path();
}

std::string SimRobot::lidar_path() const {
  if (!options_.link_dir.empty()) return (options_.link_dir / "lidar").string();
  return lidar_pty_ ? lidar_pty_->path() : "";
}

std::string SimRobot::can_device() const {
  return options_.socketcan ? "socketcan:" + *options_.socketcan : "slcan:" + can_path() + "?bitrate=500000";
}

std::string SimRobot::lidar_device() const { return "serial:" + lidar_path() + "?baud=230400"; }

double SimRobot::fastest_rim() const {
  return std::max(std::abs(body_.rate()[kLeft]) * 0.5 * options_.truth.left_diameter,
                  std::abs(body_.rate()[kRight]) * 0.5 * options_.truth.right_diameter);
}

void SimRobot::shift_counts(std::int64_t left, std::int64_t right) {
  shift_[kLeft] += left;
  shift_[kRight] += right;
}

void SimRobot::hold_encoder(std::size_t side, bool held) {
  held_[side] = held ? std::optional(wheel_state().counts[side]) : std::nullopt;
}

void SimRobot::scale_encoder(std::size_t side, double gain) {
  const std::int64_t before = wheel_state().counts[side];
  gain_[side] = gain;
  shift_[side] += before - wheel_state().counts[side];
}

void SimRobot::inject(const Frame& frame) {
  node_.receive(frame, now());
  if (can_) can_->deliver({frame}, now());
}

void SimRobot::inject_can_bytes(const std::string& bytes) {
  if (auto* slcan = dynamic_cast<SlcanPort*>(can_.get())) slcan->inject(bytes);
}

void SimRobot::inject_lidar_bytes(const std::string& bytes) {
  if (lidar_pty_) lidar_pty_->write(bytes);
}

TickReading SimRobot::read_counters() {
  TickReading reading{now(), now(), body_.counts(), false};
  for (const auto& effect : options_.disturbances) effect->on_ticks(reading);
  return reading;
}

WheelState SimRobot::wheel_state() {
  const TickReading reading = read_counters();
  WheelState state;
  state.rate = body_.rate();
  state.lateness = std::max(0.0, reading.stamp - reading.t);
  for (std::size_t side = 0; side < 2; ++side)
    state.counts[side] = held_[side].value_or(
        std::llround(gain_[side] * static_cast<double>(reading.counts[side])) + shift_[side]);
  return state;
}

void SimRobot::exchange_can() {
  node_.advance(now(), wheel_state());
  if (can_)
    for (const Frame& frame : can_->receive())
      if (!can_cut_) node_.receive(frame, now());
  const std::vector<Frame> frames = node_.take_frames(now());
  if (can_) can_->deliver(can_cut_ ? std::vector<Frame>{} : frames, now());
}

void SimRobot::move_body() {
  const MotorOrder order = node_.order();
  if (order.torque) {
    body_.set_ramps(order.acceleration, order.deceleration);
    body_.command(order.rate[kLeft], order.rate[kRight]);
  } else {
    body_.release();
  }
  const Pose before = body_.pose();
  const double from = now();
  body_.advance();
  beams_.clear();
  head_.advance(from, before, now(), body_.pose(), beams_);
}

// A stamp that comes late on the host's side is a sweep that arrives late.
void SimRobot::queue_beams() {
  for (const Beam& beam : beams_) {
    if (beam.index == 0) {
      ScanStamp stamp{beam.t, 1.0 / options_.lidar.turns_per_second, beam.t};
      for (const auto& effect : options_.disturbances) effect->on_scan(stamp);
      stream_.set_lateness(std::max(0.0, stamp.stamp - stamp.t));
    }
    stream_.add(beam);
  }
}

void SimRobot::fine_step() {
  move_body();
  exchange_can();
  queue_beams();
  const auto bytes = stream_.take(now());
  if (lidar_pty_) lidar_pty_->write(bytes);
}

void SimRobot::serve_during(const std::function<void()>& work) {
  std::atomic<bool> finished = false;
  std::thread robot([this, &finished] {
    constexpr std::chrono::milliseconds kChunk(1);
    while (!finished) {
      step(0.001);
      std::this_thread::sleep_for(kChunk);
    }
  });
  work();
  finished = true;
  robot.join();
}

void SimRobot::step(double dt) {
  wanted_ += dt;
  const double half = 0.5 * body_.step_length();
  while (now() + half < wanted_) fine_step();
}

}  // namespace odomcalib::sim
