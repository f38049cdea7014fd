// Bases on a serial line, as the other end of the wire sees them. Written from their firmware and manuals;
// nothing here is shared with the drivers.
#pragma once

#include <string>
#include <vector>

#include "tests/sim/wires/wheel_pair.hpp"

namespace odomcalib::sim {

class SerialDevice {
 public:
  virtual ~SerialDevice() = default;
  virtual void receive(const std::string& bytes, double now) = 0;
  /// Call every millisecond. Bytes that it sends in this one.
  std::string advance(double now);
  [[nodiscard]] const WheelPair& wheels() const { return wheels_; }
  bool silent = false;

 protected:
  virtual void talk(double now, std::string& out) = 0;
  virtual void watch(double now) = 0;
  WheelPair wheels_;

 private:
  double last_ = 0.0;
};

/// A board with ros_arduino_bridge: 8384 counts a turn, control interval 1/30 s, stops after 2 s.
class ArduinoBoard : public SerialDevice {
 public:
  void receive(const std::string& bytes, double now) override;

 protected:
  void talk(double now, std::string& out) override;
  void watch(double now) override;

 private:
  void execute(double now);
  std::string line_, answers_;
  double moved_at_ = -10.0;
};

/// A Pioneer 3-DX: 82500 counts a wheel turn, wheels 0.195 m, track 0.381 m, watchdog 2 s.
class PioneerBase : public SerialDevice {
 public:
  void receive(const std::string& bytes, double now) override;
  bool emergency_stop = false;
  bool tells_configuration = true;
  int watchdog_ms = 2000;  ///< as it tells
  [[nodiscard]] unsigned bad_packets() const { return bad_packets_; }

 protected:
  void talk(double now, std::string& out) override;
  void watch(double now) override;

 private:
  void execute(const std::string& data, double now);
  void send(const std::string& data);
  void send_configuration();
  std::string input_, answers_;
  int synchronised_ = 0;
  bool open_ = false, enabled_ = false, encoders_ = false;
  double heard_at_ = 0.0, speed_ = 0.0, turn_ = 0.0;
  unsigned slot_ = 0, bad_packets_ = 0;
};

}  // namespace odomcalib::sim
