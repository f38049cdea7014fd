// Decompression of what ROS recordings are packed with, bounded whatever the bytes state. Internal to proto/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "proto/file_bytes.hpp"

namespace odomcalib::ros {

enum class Packing : std::uint8_t { none, bz2, lz4, zstd };

/// Of one chunk or message. rosbag closes a chunk at 768 KiB and MCAP's writers at 1 to 4 MiB, in both cases
/// after the message that goes beyond: this leaves room for the largest images and point clouds.
inline constexpr std::size_t kLargestChunk = std::size_t{256} << 20;
/// Of all that one recording unpacks to; the same as the limit of gzip files (gunzip).
inline constexpr std::size_t kLargestRecording = std::size_t{4} << 30;

/// Unpacks one stream (bz2; LZ4 frames; zstd frames), at most `limit` bytes. Memory grows with what really
/// comes out, not with what a header states.
Unpacked unpack(Packing packing, std::string_view packed, std::size_t limit);

/// True when the bytes begin with the magic of a zstd frame (RFC 8878).
bool is_zstd(std::string_view bytes);

/// Unpacks pieces of one recording until together they reach a limit.
class Unpacker {
 public:
  explicit Unpacker(std::size_t most = kLargestRecording) : left_(most) {}
  /// @param stated bytes that the piece is said to unpack to, where that is said; more or fewer is damage
  Unpacked operator()(Packing packing, std::string_view packed, std::optional<std::uint64_t> stated);

 private:
  std::size_t left_;
};

}  // namespace odomcalib::ros
