// A lidar at the other end of a serial line or socket: bytes in, bytes out, time passed in. It turns in a
// room whose walls move away while time passes, so that a beam's range tells both its direction and its
// moment.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace odomcalib::sim {

/// Range in m along `direction` (rad, counter-clockwise, 0 = the sensor's front) at time t, s.
double moving_wall(double direction, double t);

class LidarDevice {
 public:
  virtual ~LidarDevice() = default;
  /// Bytes from the host.
  virtual void from_host(std::string_view bytes, double now) = 0;
  /// Measures until now.
  virtual void advance(double now) = 0;
  /// Bytes that have been transmitted up to now.
  std::string take(double now);
  /// Noise instead of data: what a wrong baud rate makes of them.
  void set_garbled(bool garbled) { garbled_ = garbled; }

 protected:
  /// @param bytes_per_s of the line; 0: a network
  explicit LidarDevice(double bytes_per_s) : bytes_per_s_(bytes_per_s) {}
  /// To be sent from `ready` on, after what is already under way.
  void send(const std::string& bytes, double ready);

 private:
  struct Chunk {
    double due = 0.0;
    std::string bytes;
  };
  double bytes_per_s_, line_free_ = 0.0;
  bool garbled_ = false;
  std::deque<Chunk> waiting_;
};

/// Little- and big-endian numbers for the encoders.
std::string little(std::uint64_t value, int bytes);
std::string big(std::uint64_t value, int bytes);
std::string text_of_hex(std::string_view digits);

}  // namespace odomcalib::sim
