// A controller of a shipped profile, driven through the real way onto its wire (an slcan adapter or a serial
// port, on a pseudo-terminal), with a simulated device at the other end. Virtual time, no thread but while
// opening.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "drivers/base/controller.hpp"
#include "drivers/can/transport.hpp"
#include "drivers/serial/port.hpp"
#include "tests/sim/wires/can_devices.hpp"
#include "tests/sim/wires/can_port.hpp"
#include "tests/sim/wires/serial_devices.hpp"
#include "tests/unit/drivers/ready_can.hpp"

namespace odomcalib::drivers::test {

inline std::unique_ptr<Controller> shipped(const std::string& profile) {
  auto made = make_controller("drivers/base/profiles/" + profile + ".toml");
  if (!made) ADD_FAILURE() << made.error().text();
  return made ? std::move(made).value() : nullptr;
}

class Bench {
 public:
  explicit Bench(std::unique_ptr<Controller> made) : controller(std::move(made)) {}
  virtual ~Bench() = default;
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  /// One millisecond of everything; the program looks at its port every second one.
  void turn() {
    now += 0.001;
    exchange();
    if (++turns_ % 2 != 0) return;
    receive();
    controller->on_time(now);
    send();
    for (const TickSample& tick : controller->take_ticks()) ticks.push_back(tick);
    for (const ControllerEvent& event : controller->take_events()) events.push_back(event);
  }
  void run(double seconds) {
    for (const double end = now + seconds; now < end - 1e-9;) turn();
  }
  bool run_until(ControllerState wanted, double seconds = 12.0) {
    for (const double end = now + seconds; now < end && controller->state() != wanted;) turn();
    return controller->state() == wanted;
  }
  /// Carries the controller's output to the device now, without another turn of the controller.
  void flush() {
    send();
    for (int i = 0; i < 5; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // a kernel thread carries the bytes
      exchange();
    }
  }
  void drive(double left_rad_s, double right_rad_s, double seconds) {
    for (const double end = now + seconds; now < end - 1e-9;) {
      (void)controller->command(left_rad_s, right_rad_s, now);
      turn();
    }
  }
  [[nodiscard]] bool happened(const std::string& code) const {
    for (const ControllerEvent& event : events)
      if (event.code == code) return true;
    return false;
  }
  [[nodiscard]] std::string story() const {
    std::string out;
    for (const ControllerEvent& event : events) out += event.code + ": " + event.text + "\n";
    return out;
  }

  std::unique_ptr<Controller> controller;
  std::vector<TickSample> ticks;
  std::vector<ControllerEvent> events;
  double now = 1.0;

 protected:
  virtual void exchange() = 0;
  virtual void receive() = 0;
  virtual void send() = 0;

 private:
  unsigned turns_ = 0;
};

/// Anything on a CAN bus behind an slcan adapter.
class CanBench : public Bench {
 public:
  using Exchange = std::function<std::vector<sim::Frame>(const std::vector<sim::Frame>& sent, double now)>;

  CanBench(std::unique_ptr<Controller> made, Exchange bus) : Bench(std::move(made)), bus_(std::move(bus)) {
    auto pty = sim::Pty::open();
    EXPECT_TRUE(pty.ok());
    port_ = std::make_unique<sim::SlcanPort>(std::move(pty).value());
    std::thread opening([this] { transport_ = test::open_ready_can(port_->device()).value(); });
    for (int i = 0; i < 2000 && !port_->adapter().is_open(); ++i) {
      port_->deliver({}, now);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      exchange();
    }
    opening.join();
    controller->on_connected(std::nullopt);
  }
  CanBench(std::unique_ptr<Controller> made, sim::CanDevice& device)
      : CanBench(std::move(made), [&device](const std::vector<sim::Frame>& sent, double t) {
          for (const sim::Frame& frame : sent) device.receive(frame, t);
          return device.advance(t);
        }) {}

 protected:
  void exchange() override { port_->deliver(bus_(port_->receive(), now), now); }
  void receive() override {
    const auto frames = transport_->receive(now);
    ASSERT_TRUE(frames.ok());
    for (const CanFrame& frame : frames.value()) controller->on_frame(frame);
  }
  void send() override {
    for (const CanFrame& frame : controller->take_frames()) EXPECT_TRUE(transport_->send(frame).ok());
  }

 private:
  Exchange bus_;
  std::unique_ptr<sim::SlcanPort> port_;
  std::unique_ptr<CanTransport> transport_;
};

class SerialBench : public Bench {
 public:
  SerialBench(std::unique_ptr<Controller> made, sim::SerialDevice& device)
      : Bench(std::move(made)), device_(device), pty_(sim::Pty::open().value()) {
    port_ = open_serial(pty_->path(), 57600).value();
    controller->on_connected(std::nullopt);
  }

 protected:
  void exchange() override {
    device_.receive(pty_->read(), now);
    pty_->write(device_.advance(now));
  }
  void receive() override {
    const auto bytes = port_->read();
    ASSERT_TRUE(bytes.ok());
    controller->on_bytes(bytes.value(), now);
  }
  void send() override {
    const auto bytes = controller->take_bytes();
    if (bytes.empty()) return;
    EXPECT_TRUE(port_->write(bytes).ok());
  }

 private:
  sim::SerialDevice& device_;
  std::unique_ptr<sim::Pty> pty_;
  std::unique_ptr<ByteStream> port_;
};

}  // namespace odomcalib::drivers::test
