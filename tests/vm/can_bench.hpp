// Basis of the CAN tests: interfaces made and removed, a peer on the bus that shares no code with drivers/,
// and the far end of the kernel's own slcan driver.
#pragma once

#include <gtest/gtest.h>
#include <linux/can.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "drivers/can/transport.hpp"
#include "tests/integration/processes.hpp"

namespace odomcalib::vm {

/// Runs `ip` with these arguments. @return its exit status
int ip(const std::string& arguments);

using test_support::monotonic;
using test_support::wait_until;

/// The two cards of the virtual machine, on one bus at 500 kbit/s. @return whether they exist
bool cards_up();
constexpr const char* kNoCards = "two cards exist in the virtual machine only";

/// A virtual CAN interface, up, removed with the object; an older one of that name is replaced.
class Vcan {
 public:
  explicit Vcan(std::string name);
  ~Vcan() { remove(); }
  Vcan(const Vcan&) = delete;
  Vcan& operator=(const Vcan&) = delete;
  void create() const;
  void remove() const { ip("link del " + name_); }
  void up() const { ip("link set " + name_ + " up"); }
  void down() const { ip("link set " + name_ + " down"); }

 private:
  std::string name_;
};

/// Another socket on the same bus.
class Peer {
 public:
  explicit Peer(const std::string& interface, bool flexible_rate = false);
  ~Peer();
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  /// @return false when the queue of the interface is full, or the interface is gone
  [[nodiscard]] bool send(const can_frame& frame) const;
  [[nodiscard]] bool send_flexible(const canfd_frame& frame) const;
  /// nullopt when nothing comes within `seconds`.
  [[nodiscard]] std::optional<can_frame> receive(double seconds = 1.0) const;

 private:
  int fd_;
};

can_frame frame_of(canid_t id, const std::vector<int>& bytes);
/// Error frame with these class bits and data.
can_frame error_of(canid_t classes, const std::vector<int>& bytes = {0, 0, 0, 0, 0, 0, 0, 0});

/// The kernel's slcan driver on a pseudo-terminal whose far end is the test.
class KernelSlcan {
 public:
  KernelSlcan();
  ~KernelSlcan();
  KernelSlcan(const KernelSlcan&) = delete;
  KernelSlcan& operator=(const KernelSlcan&) = delete;

  [[nodiscard]] const std::string& interface() const { return name_; }
  void up(const std::string& options = "") const;
  void down() const { ip("link set " + name_ + " down"); }
  /// The adapter says a line; CR is added.
  void say(const std::string& line) const;
  /// Text that the driver wrote to the adapter since the last call.
  std::string heard();
  /// The adapter no longer reads what the driver writes (or reads again).
  void deaf(bool deaf) { deaf_ = deaf; }
  /// The port disappears, as when the plug is pulled.
  void unplug();

 private:
  void listen(const std::stop_token& stop);

  int master_ = -1, slave_ = -1;
  std::string name_;
  std::atomic<bool> deaf_{false};
  std::mutex mutex_;
  std::string heard_;
  std::jthread listener_;  // the driver waits for its commands to be taken, so somebody must always read
};

/// open_can for a device that must open.
std::unique_ptr<drivers::CanTransport> opened(const std::string& device);

/// Frames that come within `seconds`, at most `count` of them.
std::vector<drivers::CanFrame> frames_from(drivers::CanTransport& transport, std::size_t count,
                                           double seconds = 1.0);

}  // namespace odomcalib::vm
