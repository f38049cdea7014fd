#include "daemon/service/base_link.hpp"

namespace odomcalib {
namespace {
constexpr double kRetry = 0.5;  // s: a device is back in use within 2 s without spinning while it is away
}

BaseLink::BaseLink(std::string device, std::unique_ptr<drivers::Controller> controller)
    : device_(std::move(device)), controller_(std::move(controller)) {}

Result<BaseLink> BaseLink::create(std::string device, const std::string& profile) {
  auto controller = drivers::make_controller(profile);
  if (!controller) return controller.error();
  return BaseLink(std::move(device), std::move(controller).value());
}

int BaseLink::fd() const { return transport_ ? transport_->fd() : -1; }

void BaseLink::lose(const Error& error, double now) {
  problem_ = error;
  transport_.reset();
  next_try_ = now + kRetry;
}

void BaseLink::open_when_due(double now) {
  if (transport_ || now < next_try_) return;
  auto opened = drivers::open_can(device_);
  if (!opened) return lose(opened.error(), now);
  transport_ = std::move(opened).value();
  problem_.reset();
  ++opened_;
}

void BaseLink::receive(double now) {
  if (!transport_) return;
  auto frames = transport_->receive(now);
  if (!frames) return lose(frames.error(), now);
  for (const auto& frame : frames.value()) controller_->on_frame(frame);
}

void BaseLink::flush() {
  for (const auto& frame : controller_->take_frames()) {
    if (!transport_) continue;
    // A full queue drops the frame: the controller repeats what matters, and late commands are worse than
    // none.
    if (auto sent = transport_->send(frame); !sent) problem_ = sent.error();
  }
}

void BaseLink::step(double now) {
  open_when_due(now);
  receive(now);
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
