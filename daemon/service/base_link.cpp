#include "daemon/service/base_link.hpp"

#include "daemon/service/settings.hpp"

namespace odomcalib {

BaseLink::BaseLink(std::string device, std::unique_ptr<drivers::Controller> controller)
    : device_(std::move(device)), controller_(std::move(controller)) {}

Result<BaseLink> BaseLink::create(std::string device, const std::string& profile) {
  auto controller = drivers::make_controller(profile);
  if (!controller) return controller.error();
  const bool serial = controller.value()->wire() == drivers::Wire::serial;
  if (serial != device.starts_with("serial:"))
    return Error{ErrorCode::usage, "\"" + device + "\" is no line to the controller of profile " + profile,
                 "controller.device",
                 serial ? "use serial:/dev/ttyUSB0?baud=57600"
                        : "use socketcan:can0 or slcan:/dev/ttyACM0?bitrate=500000"};
  return BaseLink(std::move(device), std::move(controller).value());
}

int BaseLink::fd() const {
  if (transport_) return transport_->fd();
  return port_ ? port_->fd() : -1;
}

void BaseLink::lose(const Error& error, double now) {
  problem_ = error;
  ++lost_;
  if (transport_) taken_ += transport_->taken();
  transport_.reset();
  port_.reset();
  connected_ = false;
  next_try_ = now + service::settings::kBaseRetry_s;
}

void BaseLink::open_when_due(double now) {
  if (transport_ || port_ || now < next_try_) return;
  if (auto opened = open(); !opened) lose(opened.error(), now);
}

// An adapter is set up in steps, a look at it each turn: the loop does not wait for its answers.
void BaseLink::finish_opening(double now) {
  if (connected_ || (!transport_ && !port_)) return;
  if (transport_) {
    const auto ready = transport_->ready(now);
    if (!ready) return lose(ready.error(), now);
    if (!ready.value()) return;
  }
  connected_ = true;
  problem_.reset();
  ++opened_;
  controller_->on_connected(baud_);
}

Result<void> BaseLink::open() {
  if (controller_->wire() == drivers::Wire::serial) return open_port();
  auto opened = drivers::open_can(device_);
  if (!opened) return opened.error();
  transport_ = std::move(opened).value();
  return {};
}

Result<void> BaseLink::open_port() {
  const auto device = drivers::parse_device(device_);
  if (!device) return device.error();
  const auto baud = drivers::baud_of(device.value());
  if (!baud) return baud.error();
  auto opened = drivers::open_serial(device.value().path, baud.value());
  if (!opened) return opened.error();
  port_ = std::move(opened).value();
  baud_ = baud.value();
  return {};
}

// Arrivals are dated by a clock that is read with them: a turn that was held up in between would date
// them wrongly.
void BaseLink::receive(const Clock& clock) {
  if (!transport_ || !connected_) return;
  const double now = clock.now();
  auto frames = transport_->receive(now);
  if (!frames) return lose(frames.error(), now);
  for (const auto& frame : frames.value()) {
    if (watcher_) watcher_(frame);
    controller_->on_frame(frame);
  }
}

void BaseLink::receive_bytes(const Clock& clock) {
  if (!port_) return;
  const auto bytes = port_->read();
  const double now = clock.now();
  if (!bytes) return lose(bytes.error(), now);
  taken_ += bytes.value().size();
  controller_->on_bytes(bytes.value(), now);
}

void BaseLink::flush_bytes() {
  const auto bytes = controller_->take_bytes();
  if (!port_ || bytes.empty()) return;
  note(port_->write(bytes));
}

// A queue that was full once is no problem any more when it takes what is sent again.
void BaseLink::note(const Result<void>& sent) {
  problem_.reset();
  if (!sent) problem_ = sent.error();
}

void BaseLink::flush() {
  flush_bytes();
  for (auto& frame : controller_->take_frames()) {
    if (!transport_ || !connected_) continue;
    frame.t = now_;
    if (watcher_) watcher_(frame);
    // A full queue drops the frame: the controller repeats what matters, and late commands are worse than
    // none.
    note(transport_->send(frame));
  }
}

void BaseLink::step(const Clock& clock) {
  const double now = now_ = clock.now();
  open_when_due(now);
  finish_opening(now);
  receive(clock);
  receive_bytes(clock);
  controller_->on_time(now);
  flush();
}

drivers::Counters BaseLink::counters() const {
  drivers::Counters all = controller_->counters();
  if (transport_) all.merge(transport_->counters());
  all["reconnects"] = reconnects();
  return all;
}

}  // namespace odomcalib
