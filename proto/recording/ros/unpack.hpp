// Decompression of what ROS recordings are packed with, bounded whatever the bytes state. Internal to proto/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "proto/file_bytes.hpp"
#include "proto/unpack_limit.hpp"

namespace odomcalib::ros {

enum class Packing : std::uint8_t { none, bz2, lz4, zstd };

/// Size of one chunk or message. rosbag closes a chunk at 768 KiB and MCAP's writers at 1 to 4 MiB, in both
/// cases after the message that goes beyond: this leaves room for the largest images and point clouds.
inline constexpr std::size_t kLargestChunk = std::size_t{256} << 20;

/// Unpacks one stream (bz2; LZ4 frames; zstd frames), at most `limit` bytes. Memory grows with what really
/// comes out, not with what a header states.
Unpacked unpack(Packing packing, std::string_view packed, std::size_t limit);

/// True when the bytes begin with the magic of a zstd frame (RFC 8878).
bool is_zstd(std::string_view bytes);

/// Bytes of the longest header of a zstd frame (RFC 8878, 3.1.1.1: magic 4, descriptor 1, window 1,
/// dictionary 4, content size 8).
inline constexpr std::size_t kLongestFrameHeader = 18;

/// Bytes that the first zstd frame states to unpack to; nullopt: it is none, or does not state it.
std::optional<std::uint64_t> stated_by_frame(std::string_view begin);

/// Unpacks pieces of one recording until together they reach its limit.
class Unpacker {
 public:
  explicit Unpacker(const UnpackLimit& limit = {}) : limit_(limit) {}
  /// A file of the recording, of so many bytes: what it may unpack to grows with it.
  void begin_file(std::size_t bytes) { packed_ += bytes; }
  /// A whole file.
  Unpacked file(Packing packing, std::string_view packed);
  /// Why the recording is refused, once a piece went beyond the limit.
  [[nodiscard]] std::optional<Error> refusal(const std::string& where) const {
    return over_limit_ ? std::optional(limit_.refusal(packed_, where)) : std::nullopt;
  }
  /// @param stated bytes that the piece is said to unpack to, where that is said; more or fewer is damage
  Unpacked operator()(Packing packing, std::string_view packed, std::optional<std::uint64_t> stated);

 private:
  [[nodiscard]] std::size_t left() const { return limit_.of(packed_) - unpacked_; }
  Unpacked taken(Unpacked piece, bool bounded);

  UnpackLimit limit_;
  std::size_t packed_ = 0, unpacked_ = 0;  // bytes so far
  bool over_limit_ = false;
};

}  // namespace odomcalib::ros
