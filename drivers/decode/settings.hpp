// Numbers that decide about files that are decoded.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>
#include <cstdint>

namespace odomcalib::drivers::decoding {

/// Bytes fed to a lidar at once. Chosen: below a packet or two, so that messages and scans come in the order
/// of the file.
inline constexpr std::size_t kPiece = 256;
/// Bytes of a TCP stream that wait for what is missing before them. Derived: the largest receive window
/// without scaling is 64 KiB; with scaling, devices stay below 1 MiB.
inline constexpr std::size_t kMostWaiting = std::size_t{1} << 20U;
/// Bytes between what was expected and what came that are another connection. Derived: a quarter of the
/// sequence numbers, beyond which before and after cannot be separated.
inline constexpr std::int64_t kFarthest = std::int64_t{1} << 30U;

}  // namespace odomcalib::drivers::decoding
