#include "tests/sim/wires/can_port.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace odomcalib::sim {

namespace {

class SocketCanPort : public CanPort {
 public:
  SocketCanPort(int fd, std::string interface) : fd_(fd), interface_(std::move(interface)) {}
  ~SocketCanPort() override { ::close(fd_); }

  std::vector<Frame> receive() override {
    std::vector<Frame> out;
    can_frame raw{};
    while (::read(fd_, &raw, sizeof raw) == static_cast<ssize_t>(sizeof raw)) out.push_back(from_kernel(raw));
    return out;
  }

  void deliver(const std::vector<Frame>& frames, double /*now*/) override {
    for (const Frame& frame : frames) {
      const can_frame raw = to_kernel(frame);
      if (::write(fd_, &raw, sizeof raw) < 0) return;  // the queue is full: lost, as on a real bus
    }
  }

  [[nodiscard]] std::string device() const override { return "socketcan:" + interface_; }

 private:
  static Frame from_kernel(const can_frame& raw) {
    Frame frame;
    frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
    frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
    frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.length = std::min<std::uint8_t>(raw.can_dlc, 8);
    std::copy_n(raw.data, frame.length, frame.data.begin());
    return frame;
  }

  static can_frame to_kernel(const Frame& frame) {
    can_frame raw{};
    raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
    raw.can_dlc = frame.length;
    std::copy(frame.data.begin(), frame.data.end(), raw.data);
    return raw;
  }

  int fd_;
  std::string interface_;
};

}  // namespace

std::vector<Frame> SlcanPort::receive() {
  adapter_.from_host(pty_->read());
  return adapter_.take_frames();
}

void SlcanPort::deliver(const std::vector<Frame>& frames, double now) {
  for (const Frame& frame : frames) adapter_.from_bus(frame, now);
  pty_->write(adapter_.take_output());
}

std::string SlcanPort::device() const { return "slcan:" + pty_->path() + "?bitrate=500000"; }

Result<std::unique_ptr<CanPort>> open_socketcan_port(const std::string& interface) {
  const auto failed = [&interface](const char* what) {
    return Error{ErrorCode::io, std::string(what) + ": " + std::strerror(errno), interface,
                 "ip link add " + interface + " type vcan && ip link set " + interface + " up"};
  };
  const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
  if (fd < 0) return failed("the kernel gives no CAN socket");
  auto port = std::make_unique<SocketCanPort>(fd, interface);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
  if (address.can_ifindex == 0) return failed("no such interface");
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return failed("cannot bind");
  return std::unique_ptr<CanPort>(std::move(port));
}

}  // namespace odomcalib::sim
