// How much a packed file may unpack to: a few kilobytes can become any number of gigabytes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "proto/result.hpp"

namespace odomcalib {

struct UnpackLimit {
  /// Bytes. Chosen: an hour of a usual robot; more is read on request.
  static constexpr std::size_t kMost = std::size_t{256} << 20;
  /// Bytes of a file whose text is read in pieces and takes no memory. Chosen: two hours of 1440 beams, ten
  /// scans/s, are 800 MiB.
  static constexpr std::size_t kMostInPieces = std::size_t{1} << 30;
  /// Times the packed size. Chosen: nine times the most among 226 packed recordings and maps (22).
  static constexpr std::size_t kMostRatio = 200;
  /// Bytes that any file may unpack to. Chosen: too little to be a burden.
  static constexpr std::size_t kLeast = std::size_t{16} << 20;

  std::size_t most = kMost;
  bool by_size = true;  ///< a small file may unpack to less

  /// Limit that somebody who trusts a file allows.
  static UnpackLimit allowed(std::size_t bytes) { return {bytes, false}; }

  /// The same for a file that is read in pieces.
  [[nodiscard]] UnpackLimit in_pieces() const {
    return {by_size ? std::max(most, kMostInPieces) : most, by_size};
  }

  /// Bytes that so many packed ones may become.
  [[nodiscard]] std::size_t of(std::size_t packed) const {
    return by_size ? std::min(most, std::max(kLeast, packed < most ? kMostRatio * packed : most)) : most;
  }

  /// The file is refused; names the option of odomcalibctl that reads it all the same.
  [[nodiscard]] Error refusal(std::size_t packed, const std::string& where) const {
    const std::size_t limit = of(packed);
    return {ErrorCode::format,
            "unpacks to more than " + std::to_string(limit >> 20U) + " MiB" +
                (limit > kLeast && limit < most ? ", " + std::to_string(kMostRatio) + " times its size" : ""),
            where,
            "where it can be trusted: --unpack-limit " +
                std::to_string(2 * std::max(most >> 20U, std::size_t{1}))};
  }
};

}  // namespace odomcalib
