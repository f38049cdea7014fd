// The packet of YDLIDAR's triangle protocol: AA 55, then counts, angles, checksum and samples.
// Source: YDLIDAR, development manuals of the X4, G4 and Tmini Pro, and its SDK for what differs by model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/common/frame_buffer.hpp"

namespace odomcalib::drivers::ydlidar {

/// Properties of a model that its stream does not state.
struct Model {
  const char* name = "";
  unsigned baud = 0;
  double samples_per_s = 0.0;
  unsigned intensity_bits = 0;  ///< 0: samples of two bytes; 8 or 10: of three
  double mm_per_count =
      0.25;              ///< of the range's word in samples of two bytes; in three, of its 14 upper bits
  bool parallax = true;  ///< near points are seen at another angle
  bool answers = true;   ///< takes commands; single-channel types only talk

  [[nodiscard]] std::size_t sample_bytes() const { return intensity_bits == 0 ? 2 : 3; }
};

/// nullptr when there is no such model.
const Model* find_model(const std::string& name);
const std::vector<Model>& models();
/// The model that a lidar means which says this name of itself, such as "COIN-D4"; nullptr: none.
const Model* model_that_says(const std::string& reported);

struct Sample {
  double range_mm = 0.0;   ///< 0: no echo
  double clockwise = 0.0;  ///< degrees, parallax removed
  unsigned intensity = 0;
};

struct Packet {
  bool zero = false;   ///< a new turn begins
  double turn_hz = 0;  ///< as reported by the device; 0: not reported
  double start = 0.0, end = 0.0;
  std::vector<Sample> samples;
  std::size_t bytes_after = 0;  ///< of the same read, behind this packet
  std::size_t size = 0;         ///< bytes of the packet
};

inline constexpr std::uint8_t kNameType = 0x01;

/// An answer to a command, or the name that some models send by themselves.
struct Answer {
  std::uint8_t type = 0;
  std::vector<std::uint8_t> payload;  ///< empty for the announcement of the scan
};

struct Item {
  std::optional<Packet> packet;
  Answer answer;
};

class PacketFinder {
 public:
  explicit PacketFinder(const Model& model) : model_(model) {}

  std::vector<Item> on_bytes(Bytes bytes);
  void reset() { frames_.reset(); }
  [[nodiscard]] const FrameBuffer& frames() const { return frames_; }
  /// Wrong checksums that are right with the other size of samples: a model of another kind sends.
  [[nodiscard]] std::uint64_t other_kind() const { return other_kind_; }
  [[nodiscard]] std::uint64_t packets() const { return packets_; }  ///< right ones

 private:
  Verdict look(Bytes rest, std::vector<Item>& out);
  Verdict take_answer(Bytes rest, std::vector<Item>& out) const;
  Verdict take_packet(Bytes rest, std::vector<Item>& out);

  const Model& model_;
  FrameBuffer frames_{"bad_checksum", "bad_count", "bad_check_bit", "bad_angle", "bad_answer"};
  std::uint64_t other_kind_ = 0, packets_ = 0;
};

}  // namespace odomcalib::drivers::ydlidar
