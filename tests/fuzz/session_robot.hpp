// The simulated robot for a daemon in the same process: wires are memory, time is virtual, and nothing
// depends on the machine. The program under test opens it by open_can() and open_serial(), which
// fuzz_control_session.cpp defines in place of those of the drivers.
#pragma once

#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "drivers/can/transport.hpp"
#include "tests/sim/wires/drive_node.hpp"
#include "tests/sim/wires/ld06_stream.hpp"
#include "tests/sim/world/body.hpp"
#include "tests/sim/world/lidar_head.hpp"

namespace odomcalib::fuzz {

class SessionRobot {
 public:
  void advance(double seconds) {
    wanted_ += seconds;
    const double half = 0.5 * body_.step_length();
    while (body_.time() + half < wanted_) step();
  }

  /// Takes a frame that the program sends.
  void receive(const drivers::CanFrame& given) {
    sim::Frame frame;
    frame.id = given.id;
    frame.extended = given.extended;
    frame.remote = given.remote;
    frame.length = given.length;
    frame.data = given.data;
    node_.receive(frame, body_.time());
  }
  /// Frames that the program finds on its bus.
  std::vector<drivers::CanFrame> take_frames(double now) {
    std::vector<drivers::CanFrame> out;
    for (const sim::Frame& given : std::exchange(frames_, {})) {
      drivers::CanFrame& frame = out.emplace_back();
      frame.id = given.id;
      frame.extended = given.extended;
      frame.remote = given.remote;
      frame.length = given.length;
      frame.data = given.data;
      frame.t = now;
    }
    return out;
  }
  std::vector<std::uint8_t> take_lidar_bytes() { return std::exchange(lidar_bytes_, {}); }

  /// The drive has torque and is told to turn a wheel.
  [[nodiscard]] bool driven() const {
    const sim::MotorOrder order = node_.order();
    return order.torque && (order.rate[0] != 0.0 || order.rate[1] != 0.0);
  }

 private:
  void step() {
    const sim::MotorOrder order = node_.order();
    if (order.torque) {
      body_.set_ramps(order.acceleration, order.deceleration);
      body_.command(order.rate[0], order.rate[1]);
    } else {
      body_.release();
    }
    body_.advance();
    const double now = body_.time();
    node_.advance(now, {body_.counts(), body_.rate(), 0.0});
    for (const sim::Frame& frame : node_.take_frames(now)) frames_.push_back(frame);
    measure(now);
  }

  // A wide empty round room that goes along with the robot: no turn of the lidar is like the one before, and
  // nothing stands in the way. Casting rays would take most of the time.
  void measure(double now) {
    const double interval = 1.0 / (lidar_.turns_per_second * lidar_.beams_per_turn);
    for (; static_cast<double>(beams_) * interval <= now; ++beams_) {
      const auto index = static_cast<int>(beams_ % lidar_.beams_per_turn);
      const double range = 4.0 + 0.001 * static_cast<double>(beams_ * 7919 % 17);
      stream_.add({beams_ / lidar_.beams_per_turn, index, static_cast<double>(beams_) * interval,
                   2.0 * std::numbers::pi * index / lidar_.beams_per_turn, range, 200.0});
    }
    for (const std::uint8_t byte : stream_.take(now)) lidar_bytes_.push_back(byte);
  }

  static sim::BodyOptions body_options() {
    sim::BodyOptions options;
    options.step = 0.005;  // s; the drive's timers count in tens of milliseconds
    return options;
  }

  sim::Body body_{sim::Geometry{}, body_options(), 1};
  sim::DriveNode node_{sim::DriveNodeOptions{}};
  static sim::LidarOptions lidar_options() {
    sim::LidarOptions options;
    options.turns_per_second = 5.5;  // each turn takes the daemon a while
    return options;
  }

  sim::LidarOptions lidar_ = lidar_options();
  sim::Ld06Stream stream_{lidar_, 0.0, 0.0};
  std::int64_t beams_ = 0;
  std::vector<sim::Frame> frames_;
  std::vector<std::uint8_t> lidar_bytes_;
  double wanted_ = 0.0;  // s
};

}  // namespace odomcalib::fuzz
