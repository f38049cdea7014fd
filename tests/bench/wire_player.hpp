// The devices of the daemon's bench, in real time: a CANopen drive behind an slcan adapter that reports its
// counts every millisecond, and a Hokuyo of 40 turns a second with 1081 beams. The left count goes up by one
// with every report, so that each message of the daemon names the frame it came from.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/sim/wires/can_port.hpp"
#include "tests/sim/wires/drive_node.hpp"
#include "tests/sim/wires/scip_device.hpp"
#include "tests/sim/wires/tcp_port.hpp"

namespace odomcalib::bench {

/// ns of CLOCK_REALTIME: the clock of LCM's kernel time stamps.
std::int64_t wall_ns();

class WirePlayer {
 public:
  /// @param seconds room for as many seconds of time stamps
  explicit WirePlayer(double seconds);
  ~WirePlayer();
  WirePlayer(const WirePlayer&) = delete;
  WirePlayer& operator=(const WirePlayer&) = delete;

  [[nodiscard]] std::string can_device() const { return can_.device(); }
  [[nodiscard]] std::string lidar_device() const;

  /// When the report with this left count was handed to the kernel, ns; 0: never.
  [[nodiscard]] std::int64_t sent_at(std::int64_t count) const;
  /// When scan number i was handed to the kernel, ns; 0: never.
  [[nodiscard]] std::int64_t scan_sent_at(std::size_t i) const;
  [[nodiscard]] std::size_t scans_sent() const { return scans_; }
  /// Reports so far: the newest left count.
  [[nodiscard]] std::int64_t newest() const { return newest_; }
  /// Milliseconds that were played late by more than half of one.
  [[nodiscard]] std::uint64_t late() const { return late_; }
  /// Bytes that the daemon's ports did not take.
  [[nodiscard]] std::uint64_t overrun() const { return can_.pty().overrun(); }

 private:
  void play();
  void turn_drive();
  void turn_lidar();

  sim::SlcanPort can_;
  std::unique_ptr<sim::TcpPort> tcp_;
  sim::DriveNode node_;
  sim::ScipDevice lidar_;
  std::vector<std::int64_t> sent_, scans_sent_at_;
  std::atomic<std::int64_t> newest_ = 0;
  std::atomic<std::size_t> scans_ = 0;
  std::atomic<std::uint64_t> late_ = 0;
  std::atomic<bool> ended_ = false;
  std::int64_t millisecond_ = 0;
  std::thread thread_;
};

}  // namespace odomcalib::bench
