#include "drivers/can/socketcan.hpp"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <utility>

#include "drivers/can/settings.hpp"

namespace odomcalib::drivers {
namespace {

using namespace can;

Error bus_error(const std::string& interface, const std::string& what, const std::string& remedy) {
  return {ErrorCode::device, what, interface, remedy};
}

Error bus_off(const std::string& interface) {
  return bus_error(
      interface, "the interface is off the bus (bus-off)",
      "see to wiring, termination and bit rate, then: ip link set " + interface + " type can restart");
}

/// Whether an interface that is up has a carrier.
bool has_carrier(const std::string& interface) {
  std::ifstream file("/sys/class/net/" + interface + "/carrier");
  return file.get() != '0';
}

double read_clock(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Received {
  CanFrame frame;
  std::optional<double> wall_time;         // s, kernel's software stamp
  std::optional<std::uint32_t> overflows;  // frames lost at this socket since it was opened
};

void read_control(const cmsghdr& header, Received& out) {
  if (header.cmsg_level != SOL_SOCKET) return;
  if (header.cmsg_type == SO_TIMESTAMPING && header.cmsg_len >= CMSG_LEN(sizeof(scm_timestamping))) {
    scm_timestamping stamps{};
    std::memcpy(&stamps, CMSG_DATA(&header), sizeof stamps);
    if (stamps.ts[0].tv_sec != 0 || stamps.ts[0].tv_nsec != 0)
      out.wall_time =
          static_cast<double>(stamps.ts[0].tv_sec) + 1e-9 * static_cast<double>(stamps.ts[0].tv_nsec);
  }
  if (header.cmsg_type == SO_RXQ_OVFL && header.cmsg_len >= CMSG_LEN(sizeof(std::uint32_t))) {
    std::uint32_t count = 0;
    std::memcpy(&count, CMSG_DATA(&header), sizeof count);
    out.overflows = count;
  }
}

class SocketCan final : public CanTransport {
 public:
  SocketCan(int fd, std::string interface) : fd_(fd), interface_(std::move(interface)) {}
  ~SocketCan() override { ::close(fd_); }
  SocketCan(const SocketCan&) = delete;
  SocketCan& operator=(const SocketCan&) = delete;

  [[nodiscard]] int fd() const override { return fd_; }

  Result<void> send(const CanFrame& frame) override {
    if (frame.error || frame.length > 8)
      return Error{ErrorCode::usage, "not a frame to send", interface_, ""};
    if (off_the_bus()) {
      ++send_failed_;
      return bus_off(interface_);
    }
    const can_frame raw = to_kernel(frame);
    if (::write(fd_, &raw, sizeof raw) == static_cast<ssize_t>(sizeof raw)) {
      ++sent_;
      return {};
    }
    ++send_failed_;
    if (errno == ENOBUFS || errno == EAGAIN)
      return bus_error(
          interface_, "send queue is full: no other node acknowledges, or the bus is overloaded",
          "check wiring, termination and bit rate: ip -details -statistics link show " + interface_);
    return gone(errno);
  }

  Result<std::vector<CanFrame>> receive(double now) override {
    std::vector<CanFrame> out;
    if (failed_ != 0) return take_failure();
    const double wall_now = read_clock(CLOCK_REALTIME);
    const bool stepped = wall_clock_stepped(wall_now);
    for (int i = 0; i < kFramesAtMost; ++i) {
      Received got;
      const int status = read_one(got);
      if (status == EAGAIN) break;
      if (status != 0) {  // the kernel says it once: told after these frames
        failed_ = status;
        if (out.empty()) return take_failure();
        break;
      }
      if (got.overflows) lost_ = *got.overflows;
      got.frame.t = now - (stepped ? 0.0 : age_of(got, wall_now));
      if (!rejected_last_) out.push_back(got.frame);
    }
    return out;
  }

  [[nodiscard]] Counters counters() const override {
    return {{"frames", frames_},
            {"frames_sent", sent_},
            {"send_failed", send_failed_},
            {"lost_in_socket", lost_},
            {"error_frames", error_frames_},
            {"bus_off", bus_off_},
            {"bytes_in", bytes_in_},
            {"good", bytes_in_ - skipped_},
            {"skipped", skipped_},
            {"bad_frame", bad_frame_},
            {"buffered", 0}};
  }
  [[nodiscard]] std::uint64_t taken() const override { return bytes_in_; }

 private:
  /// s; 0 for a frame without stamp.
  static double age_of(const Received& got, double wall_now) {
    const double age = got.wall_time ? std::max(wall_now - *got.wall_time, 0.0) : 0.0;
    return age < kOldest_s ? age : 0.0;
  }

  /// Stamps are wall-clock times: those taken before the clock was set cannot be separated from those after.
  bool wall_clock_stepped(double wall_now) {
    const double offset = wall_now - read_clock(CLOCK_MONOTONIC);
    const double before = std::exchange(offset_, offset);
    return std::abs(offset - before) > kStep_s;
  }

  /// Without carrier the kernel takes frames, says "sent" and drops them. The carrier goes with bus-off and
  /// comes back with the restart.
  bool off_the_bus() {
    off_ = off_ && !has_carrier(interface_);
    return off_;
  }

  /// @return 0, or errno; EAGAIN when nothing is left
  int read_one(Received& out) {
    can_frame raw{};
    iovec part{&raw, sizeof raw};
    alignas(cmsghdr) std::array<char, 256> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t n = recvmsg(fd_, &message, 0);
    if (n < 0) return errno == EWOULDBLOCK || errno == EINTR ? EAGAIN : errno;
    for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr; header = CMSG_NXTHDR(&message, header))
      read_control(*header, out);
    count(raw, static_cast<std::size_t>(n), out);
    return 0;
  }

  void count(const can_frame& raw, std::size_t size, Received& out) {
    bytes_in_ += size;
    const auto frame = from_kernel(raw, size);
    rejected_last_ = !frame.has_value();
    if (!frame) {
      ++bad_frame_;
      skipped_ += size;
      return;
    }
    out.frame = *frame;
    ++(frame->error ? error_frames_ : frames_);
    if (!frame->error || (frame->id & CAN_ERR_BUSOFF) == 0) return;
    ++bus_off_;
    off_ = true;
  }

  /// A socket whose interface went down lives again when it comes up; any other failure is for ever.
  Error take_failure() {
    Error error = gone(failed_);
    if (failed_ == ENETDOWN) failed_ = 0;
    return error;
  }

  [[nodiscard]] Error gone(int cause) const {
    const std::string command =
        cause == ENETDOWN ? "ip link set " + interface_ + " up" : "ip link show " + interface_;
    return bus_error(interface_, std::string("CAN interface failed: ") + std::strerror(cause), command);
  }

  int fd_;
  std::string interface_;
  bool rejected_last_ = false;
  int failed_ = 0;    // errno that is still to be reported
  bool off_ = false;  // an error frame said bus-off, and no carrier was seen since
  double offset_ = read_clock(CLOCK_REALTIME) - read_clock(CLOCK_MONOTONIC);  // s, wall minus monotonic
  std::uint64_t frames_ = 0, sent_ = 0, send_failed_ = 0, lost_ = 0, error_frames_ = 0, bus_off_ = 0;
  std::uint64_t bytes_in_ = 0, skipped_ = 0, bad_frame_ = 0;
};

/// Kernel stamps and the loss counter are wanted, but their absence is no reason to fail.
void set_can_options(int fd) {
  const can_err_mask_t errors = CAN_ERR_MASK;
  setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors);
  const int stamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE;
  setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPING, &stamps, sizeof stamps);
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  const int buffer = 1 << 20;  // a frame costs several hundred bytes of kernel memory
  setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
}

std::optional<Error> bind_to(int fd, const std::string& interface) {
  if (interface.size() >= IFNAMSIZ) return bus_error(interface, "interface name is too long", "");
  ifreq request{};
  std::copy(interface.begin(), interface.end(), std::begin(request.ifr_name));
  if (ioctl(fd, SIOCGIFINDEX, &request) != 0)
    return bus_error(interface, "no such network interface",
                     "plug the adapter in; see: ip link show type can");
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return bus_error(interface, std::string("cannot bind: ") + std::strerror(errno),
                     "is it a CAN interface?");
  if (ioctl(fd, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) == 0)
    return bus_error(interface, "interface is down",
                     "ip link set " + interface + " up type can bitrate 500000");
  if (!has_carrier(interface)) return bus_off(interface);
  return std::nullopt;
}

}  // namespace

std::optional<CanFrame> from_kernel(const can_frame& raw, std::size_t size) {
  if (size != CAN_MTU || raw.can_dlc > CAN_MAX_DLEN) return std::nullopt;
  CanFrame frame;
  frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
  frame.extended = !frame.error && (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = !frame.error && (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.error || frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = raw.can_dlc;
  if (!frame.remote) std::copy_n(std::begin(raw.data), frame.length, frame.data.begin());
  return frame;
}

can_frame to_kernel(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  if (frame.remote) raw.can_id |= CAN_RTR_FLAG;
  raw.can_dlc = std::min<std::uint8_t>(frame.length, CAN_MAX_DLEN);
  if (!frame.remote) std::copy_n(frame.data.begin(), raw.can_dlc, std::begin(raw.data));
  return raw;
}

Result<std::unique_ptr<CanTransport>> open_socketcan(const std::string& interface) {
  const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
  if (fd < 0 && (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT))
    return bus_error(interface, "this kernel has no CAN sockets (AF_CAN)",
                     "modprobe can_raw, or use an slcan adapter: slcan:/dev/ttyACM0?bitrate=500000");
  if (fd < 0)
    return bus_error(interface, std::string("cannot make a CAN socket: ") + std::strerror(errno), "");
  auto transport = std::make_unique<SocketCan>(fd, interface);
  set_can_options(fd);
  if (auto problem = bind_to(fd, interface)) return *problem;
  return std::unique_ptr<CanTransport>(std::move(transport));
}

}  // namespace odomcalib::drivers
