// How the simulated bus reaches the program under test: an slcan adapter on a pseudo-terminal, or the
// kernel's SocketCAN.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "proto/result.hpp"
#include "tests/sim/wires/frame.hpp"
#include "tests/sim/wires/pty.hpp"
#include "tests/sim/wires/slcan_adapter.hpp"

namespace odomcalib::sim {

class CanPort {
 public:
  CanPort() = default;
  CanPort(const CanPort&) = delete;
  CanPort& operator=(const CanPort&) = delete;
  virtual ~CanPort() = default;
  /// Frames that the program sent.
  virtual std::vector<Frame> receive() = 0;
  /// Frames that nodes on the bus sent.
  virtual void deliver(const std::vector<Frame>& frames, double now) = 0;
  /// Device string for the daemon.
  [[nodiscard]] virtual std::string device() const = 0;
};

class SlcanPort : public CanPort {
 public:
  explicit SlcanPort(std::unique_ptr<Pty> pty) : pty_(std::move(pty)) {}
  std::vector<Frame> receive() override;
  void deliver(const std::vector<Frame>& frames, double now) override;
  [[nodiscard]] std::string device() const override;
  /// Bytes to the program that no adapter would send.
  void inject(const std::string& bytes) { pty_->write(bytes); }
  [[nodiscard]] const Pty& pty() const { return *pty_; }
  [[nodiscard]] const SlcanAdapter& adapter() const { return adapter_; }

 private:
  std::unique_ptr<Pty> pty_;
  SlcanAdapter adapter_;
};

/// Error io where the kernel has no AF_CAN, or no such interface.
Result<std::unique_ptr<CanPort>> open_socketcan_port(const std::string& interface);

}  // namespace odomcalib::sim
