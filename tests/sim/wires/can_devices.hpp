// Controllers on CAN that are not CANopen, as the other end of the wire sees them. Written from their
// manuals; nothing here is shared with the drivers. Each takes frames, follows the commands and talks by
// itself.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/sim/wires/frame.hpp"
#include "tests/sim/wires/wheel_pair.hpp"

namespace odomcalib::sim {

class CanDevice {
 public:
  virtual ~CanDevice() = default;
  virtual void receive(const Frame& frame, double now) = 0;
  /// Call every millisecond. Frames that it sends in this one.
  std::vector<Frame> advance(double now);
  [[nodiscard]] const WheelPair& wheels() const { return wheels_; }
  bool silent = false;  ///< says nothing any more

 protected:
  virtual void talk(double now, std::vector<Frame>& out) = 0;
  /// The device's own command time-out.
  virtual void watch(double now) = 0;
  WheelPair wheels_;

 private:
  double last_ = 0.0;
  unsigned ticks_ = 0;
};

/// AgileX Tracer, protocol V2: wheels 0.127 m, track 0.344 m, 4096 pulses a turn in 24 bits.
class AgilexChassis : public CanDevice {
 public:
  void receive(const Frame& frame, double now) override;
  bool emergency_stop = false;

 protected:
  void talk(double now, std::vector<Frame>& out) override;
  void watch(double now) override;

 private:
  bool can_control_ = false;
  double commanded_at_ = -1.0;
  unsigned slot_ = 0;
};

/// Two VESC controllers, ids 1 and 2, 23 pole pairs.
class VescPair : public CanDevice {
 public:
  void receive(const Frame& frame, double now) override;
  [[nodiscard]] unsigned configurations_asked() const { return asked_; }

 protected:
  void talk(double now, std::vector<Frame>& out) override;
  void watch(double now) override;

 private:
  std::array<double, 2> commanded_at_{-1.0, -1.0};
  std::vector<Frame> answers_;
  unsigned slot_ = 0, asked_ = 0;
};

/// ODrive with two axes, nodes 1 and 2, 8192 counts a turn, axis watchdog of 0.1 s switched on.
class OdrivePair : public CanDevice {
 public:
  void receive(const Frame& frame, double now) override;

 protected:
  void talk(double now, std::vector<Frame>& out) override;
  void watch(double now) override;

 private:
  std::array<int, 2> state_{1, 1};
  std::array<std::uint32_t, 2> error_{};
  std::array<double, 2> fed_at_{};
  std::vector<Frame> answers_;
  unsigned slot_ = 0;
};

}  // namespace odomcalib::sim
