// The motor controller behind its bus or serial line: opens it, reopens it after it was lost, carries frames
// or bytes both ways.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/clock.hpp"
#include "drivers/base/controller.hpp"
#include "drivers/can/transport.hpp"
#include "drivers/serial/port.hpp"

namespace odomcalib {

class BaseLink {
 public:
  /// Errors: what make_controller says about the profile; usage when the device is no line for this
  /// controller. The device may be absent.
  static Result<BaseLink> create(std::string device, const std::string& profile);

  /// Every CAN frame that comes in or goes out is shown to it, with its time in CanFrame::t.
  void watch_frames(std::function<void(const drivers::CanFrame&)> watcher) { watcher_ = std::move(watcher); }

  /// To poll for reading; -1 while the bus is away.
  [[nodiscard]] int fd() const;
  /// Call every few ms: receives, lets the controller work, sends.
  void step(const Clock& clock);
  /// Sends what the controller has to say now, e.g. a quick stop that must not wait.
  void flush();

  [[nodiscard]] drivers::Controller& controller() const { return *controller_; }
  [[nodiscard]] bool connected() const { return connected_; }
  /// The line is open, its adapter is being set up.
  [[nodiscard]] bool opening() const { return transport_ != nullptr && !connected_; }
  /// Why the bus is away, or what was sent last could not be; empty while all is well.
  [[nodiscard]] const std::optional<Error>& problem() const { return problem_; }
  [[nodiscard]] drivers::Counters counters() const;
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Bytes or frames that were taken from the line so far, and how often it was lost.
  [[nodiscard]] std::uint64_t taken() const {
    return taken_ + lost_ + (transport_ ? transport_->taken() : 0);
  }
  [[nodiscard]] std::uint64_t reconnects() const { return opened_ > 0 ? opened_ - 1 : 0; }

 private:
  BaseLink(std::string device, std::unique_ptr<drivers::Controller> controller);
  void open_when_due(double now);
  void finish_opening(double now);
  Result<void> open();
  Result<void> open_port();
  void receive(const Clock& clock);
  void receive_bytes(const Clock& clock);
  void flush_bytes();
  void note(const Result<void>& sent);
  void lose(const Error& error, double now);

  std::string device_;
  std::unique_ptr<drivers::Controller> controller_;
  std::unique_ptr<drivers::CanTransport> transport_;  // one of the two
  std::unique_ptr<drivers::ByteStream> port_;
  std::optional<Error> problem_;
  std::function<void(const drivers::CanFrame&)> watcher_;
  std::optional<unsigned> baud_;  // bit/s, of a serial line
  bool connected_ = false;
  double next_try_ = 0.0, now_ = 0.0;
  std::uint64_t opened_ = 0, lost_ = 0, taken_ = 0;
};

}  // namespace odomcalib
