#include "tests/vm/can_bench.hpp"

#include <fcntl.h>
#include <linux/can/raw.h>
#include <linux/sockios.h>
#include <linux/tty.h>
#include <net/if.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>
#include <utility>

#include "tests/unit/drivers/ready_can.hpp"

namespace odomcalib::vm {

int ip(const std::string& arguments) {
  return std::system(("ip " + arguments + " >/tmp/ip.log 2>&1").c_str());
}

bool cards_up() {
  for (const std::string name : {"can0", "can1"}) {
    if (ip("link show " + name) != 0) return false;
    ip("link set " + name + " down");
    EXPECT_EQ(ip("link set " + name + " up type can bitrate 500000"), 0) << name;
  }
  return true;
}

Vcan::Vcan(std::string name) : name_(std::move(name)) {
  remove();
  create();
}

void Vcan::create() const {
  EXPECT_EQ(ip("link add " + name_ + " type vcan"), 0);
  EXPECT_EQ(ip("link set " + name_ + " mtu 72 up"), 0);
}

Peer::Peer(const std::string& interface, bool flexible_rate)
    : fd_(socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW)) {
  const int on = flexible_rate ? 1 : 0;
  setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  EXPECT_NE(address.can_ifindex, 0) << interface;
  EXPECT_EQ(bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
}

Peer::~Peer() { close(fd_); }

bool Peer::send(const can_frame& frame) const {
  return write(fd_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame);
}

bool Peer::send_flexible(const canfd_frame& frame) const {
  return write(fd_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame);
}

std::optional<can_frame> Peer::receive(double seconds) const {
  pollfd polled{fd_, POLLIN, 0};
  can_frame frame{};
  if (poll(&polled, 1, static_cast<int>(1e3 * seconds)) != 1) return std::nullopt;
  if (read(fd_, &frame, sizeof frame) != static_cast<ssize_t>(sizeof frame)) return std::nullopt;
  return frame;
}

can_frame frame_of(canid_t id, const std::vector<int>& bytes) {
  can_frame frame{};
  frame.can_id = id;
  for (const int byte : bytes) frame.data[frame.len++] = static_cast<std::uint8_t>(byte);
  return frame;
}

can_frame error_of(canid_t classes, const std::vector<int>& bytes) {
  return frame_of(CAN_ERR_FLAG | classes, bytes);
}

KernelSlcan::KernelSlcan() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  EXPECT_EQ(grantpt(master_) + unlockpt(master_), 0);
  slave_ = open(ptsname(master_), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios raw{};
  tcgetattr(slave_, &raw);
  cfmakeraw(&raw);
  tcsetattr(slave_, TCSANOW, &raw);
  const int discipline = N_SLCAN;
  EXPECT_EQ(ioctl(slave_, TIOCSETD, &discipline), 0) << "N_SLCAN";
  std::array<char, IFNAMSIZ> name{};
  EXPECT_EQ(ioctl(slave_, SIOCGIFNAME, name.data()), 0);
  name_ = name.data();
  listener_ = std::jthread([this](const std::stop_token& stop) { listen(stop); });
}

KernelSlcan::~KernelSlcan() { unplug(); }

void KernelSlcan::up(const std::string& options) const {
  EXPECT_EQ(ip("link set " + name_ + " up " + options + " type can bitrate 500000"), 0);
}

void KernelSlcan::say(const std::string& line) const {
  const std::string bytes = line + "\r";
  EXPECT_EQ(write(master_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
}

void KernelSlcan::listen(const std::stop_token& stop) {
  std::array<char, 4096> bytes{};
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const ssize_t count = deaf_ ? 0 : read(master_, bytes.data(), bytes.size());
    if (count <= 0) continue;
    const std::lock_guard lock(mutex_);
    heard_.append(bytes.data(), static_cast<std::size_t>(count));
  }
}

std::string KernelSlcan::heard() {
  const std::lock_guard lock(mutex_);
  return std::exchange(heard_, "");
}

void KernelSlcan::unplug() {
  if (slave_ >= 0) close(slave_);
  listener_ = {};
  if (master_ >= 0) close(master_);
  slave_ = master_ = -1;
}

std::unique_ptr<drivers::CanTransport> opened(const std::string& device) {
  auto transport = drivers::test::open_ready_can(device);
  EXPECT_TRUE(transport.ok()) << transport.error().text();
  return transport.ok() ? std::move(transport).value() : nullptr;
}

std::vector<drivers::CanFrame> frames_from(drivers::CanTransport& transport, std::size_t count,
                                           double seconds) {
  std::vector<drivers::CanFrame> all;
  for (const double end = monotonic() + seconds; all.size() < count && monotonic() < end;) {
    pollfd polled{transport.fd(), POLLIN, 0};
    poll(&polled, 1, 10);
    const auto some = transport.receive(monotonic());
    if (!some) break;
    all.insert(all.end(), some.value().begin(), some.value().end());
  }
  return all;
}

}  // namespace odomcalib::vm
