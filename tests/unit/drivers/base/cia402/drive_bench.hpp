// The controller of a two-axis drive against the simulated one, frame by frame and without a clock.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/base/controller.hpp"
#include "tests/sim/wires/drive_node.hpp"
#include "tests/sim/wires/frame_line.hpp"

namespace odomcalib::drivers::drive_bench {

inline constexpr double kStep = 0.001;
inline constexpr double kTicksPerRad = 16384.0 / (2.0 * 3.14159265358979323846);

inline CanFrame to_can(const sim::Frame& frame, double t) {
  CanFrame out;
  out.id = frame.id;
  out.extended = frame.extended;
  out.remote = frame.remote;
  out.length = frame.length;
  out.data = frame.data;
  out.t = t;
  return out;
}

inline sim::Frame to_sim(const CanFrame& frame) {
  return {frame.id, frame.extended, frame.remote, frame.length, frame.data};
}

class Bench {
 public:
  explicit Bench(const std::string& profile = "drivers/base/profiles/sim-dual.toml") : node({}) {
    auto made = make_controller(profile);
    EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().text());
    controller = std::move(made).value();
    node.reset(0.0);
  }

  void run(double duration) {
    for (const double end = now + duration; now < end;) step();
  }

  bool run_until(const std::function<bool()>& done, double longest) {
    for (const double end = now + longest; now < end && !done();) step();
    return done();
  }

  bool ready() {
    return run_until([&] { return controller->state() == ControllerState::disabled; }, 5.0);
  }

  bool enabled() {
    if (!ready()) return false;
    controller->enable(now);
    return enabled_within(2.0);
  }

  bool enabled_within(double longest) {
    return run_until([&] { return controller->state() == ControllerState::enabled; }, longest);
  }

  void drive(double left, double right, double duration) {
    for (const double end = now + duration; now < end;) {
      (void)controller->command(left, right, now);
      run(0.02);
    }
  }

  ParameterJobResult job() {
    std::optional<ParameterJobResult> out;
    const auto arrived = [&] {
      if (!out) out = controller->take_job_result();
      return out.has_value();
    };
    EXPECT_TRUE(run_until(arrived, 10.0));
    return out.value_or(ParameterJobResult{});
  }

  /// Somebody else sends this on the bus.
  void foreign(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
    sim::Frame frame{id, false, false, static_cast<std::uint8_t>(data.size()), {}};
    std::copy(data.begin(), data.end(), frame.data.begin());
    node.receive(frame, now);
    controller->on_frame(to_can(frame, now));
  }

  [[nodiscard]] const ControllerEvent* find(const std::string& code) const {
    for (const ControllerEvent& event : events)
      if (event.code == code) return &event;
    return nullptr;
  }

  sim::DriveNode node;
  std::unique_ptr<Controller> controller;
  std::vector<ControllerEvent> events;
  std::vector<TickSample> ticks;
  std::vector<CanFrame> sent;
  std::uint32_t lost_id = ~0U;  ///< what does not reach the node
  bool link_to_node = true, link_from_node = true, wheels_turn = true;
  sim::FrameLine from_node{{}, 1}, to_node{{}, 2};
  double now = 0.0;

 private:
  void step() {
    now += kStep;
    for (std::size_t side = 0; side < 2; ++side) {
      wheels_.rate[side] = node.order().torque ? node.order().rate[side] : 0.0;
      if (wheels_turn) angle_[side] += wheels_.rate[side] * kStep;
      wheels_.counts[side] = std::llround(angle_[side] * kTicksPerRad);
    }
    node.advance(now, wheels_);
    for (const sim::Frame& frame : node.take_frames(now))
      if (link_from_node) from_node.send(frame, now);
    for (const sim::Frame& frame : from_node.take(now)) controller->on_frame(to_can(frame, now));
    controller->on_time(now);
    for (const CanFrame& frame : controller->take_frames()) {
      sent.push_back(frame);
      if (link_to_node && frame.id != lost_id) to_node.send(to_sim(frame), now);
    }
    for (const sim::Frame& frame : to_node.take(now)) node.receive(frame, now);
    for (auto& event : controller->take_events()) events.push_back(event);
    for (auto& tick : controller->take_ticks()) ticks.push_back(tick);
  }

  sim::WheelState wheels_;
  std::array<double, 2> angle_{};
};

/// A test ends here where the drive does not get so far.
struct Ready : Bench {
  Ready() {
    if (!ready()) throw std::runtime_error("not ready");
  }
};
struct Enabled : Bench {
  Enabled() {
    if (!enabled()) throw std::runtime_error("not enabled");
  }
};

}  // namespace odomcalib::drivers::drive_bench
