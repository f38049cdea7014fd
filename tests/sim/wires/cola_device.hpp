// A SICK LMS111-like sensor with CoLa over TCP: 541 beams of half a degree, 50 turns a second.
#pragma once

#include "tests/sim/wires/lidar_device.hpp"

namespace odomcalib::sim {

class ColaDevice final : public LidarDevice {
 public:
  struct Options {
    bool binary = true;          ///< dialect B; requests in the other one are not answered
    double period = 0.02011;     ///< s; it says 50 Hz
    double clock_zero = 4294.0;  ///< s on the device's clock at time 0: it wraps at 4294.97 s
    double ready_at = 0.0;       ///< s; before, it says that it is not ready
    bool refuses = false;        ///< answers the subscription with an error
  };
  explicit ColaDevice(const Options& options) : LidarDevice(0.0), options_(options) {}

  void from_host(std::string_view bytes, double now) override;
  void advance(double now) override;
  [[nodiscard]] bool streaming() const { return streaming_; }
  /// Goes on without sending, as after a restart that the host has not noticed.
  void forget() { streaming_ = false; }

 private:
  void on_command(const std::string& command, double now);
  void reply(const std::string& text, const std::string& binary, const std::string& ascii, double ready);
  void send_scan(double first_beam);
  [[nodiscard]] std::string number(std::uint64_t value, int bytes) const;

  Options options_;
  std::string input_;
  bool streaming_ = false;
  double next_ = 0.0;
  unsigned counter_ = 65'500;  // wraps soon
};

}  // namespace odomcalib::sim
