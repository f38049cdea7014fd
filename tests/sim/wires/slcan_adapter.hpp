// A USB CAN adapter that speaks the Lawicel ASCII protocol. Bytes in, bytes out; the port itself is
// elsewhere.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/sim/wires/frame.hpp"

namespace odomcalib::sim {

class SlcanAdapter {
 public:
  /// @param bus_bitrate of the bus it is plugged into; opened at another rate it hears and says nothing
  explicit SlcanAdapter(unsigned bus_bitrate = 500'000) : bus_bitrate_(bus_bitrate) {}

  /// Bytes from the host.
  void from_host(std::string_view bytes);
  /// A frame seen on the bus.
  void from_bus(const Frame& frame, double now);
  /// Answers and frames for the host since the last call.
  std::string take_output();
  /// Frames the host wants on the bus since the last call.
  std::vector<Frame> take_frames();
  /// As after plugging in.
  void reset();
  [[nodiscard]] bool is_open() const { return open_; }
  [[nodiscard]] bool hears_bus() const { return open_ && bitrate_ == bus_bitrate_; }

 private:
  void on_line(const std::string& line);
  [[nodiscard]] bool command(const std::string& line);
  [[nodiscard]] bool transmit(const std::string& line);

  unsigned bus_bitrate_, bitrate_ = 0;
  bool open_ = false, listen_only_ = false, stamps_ = false;
  std::string line_, output_;
  std::vector<Frame> frames_;
};

/// `tiiildd..` or `Tiiiiiiiildd..` without the CR.
std::string slcan_line(const Frame& frame);
std::optional<Frame> frame_from_slcan(std::string_view line);

}  // namespace odomcalib::sim
