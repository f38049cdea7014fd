// Bounds-checked reading: the only way bytes from a wire become numbers in this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace odomcalib::drivers {

using Bytes = std::span<const std::uint8_t>;

/// A shortage is remembered (ok() turns false) and yields zeros or an empty view; nothing is read past the
/// end.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : rest_(bytes) {}

  Bytes take(std::size_t n) {
    if (n > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const Bytes taken = rest_.first(n);
    rest_ = rest_.subspan(n);
    return taken;
  }

  /// Unsigned little-endian number of n <= 8 bytes.
  std::uint64_t number(std::size_t n) {
    std::uint64_t value = 0;
    std::size_t shift = 0;
    for (const std::uint8_t byte : take(n)) {
      value |= static_cast<std::uint64_t>(byte) << shift;
      shift += 8;
    }
    return value;
  }

  /// Unsigned big-endian number of n <= 8 bytes.
  std::uint64_t big_endian(std::size_t n) {
    std::uint64_t value = 0;
    for (const std::uint8_t byte : take(n)) value = value << 8U | byte;
    return value;
  }

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  Bytes rest_;
  bool ok_ = true;
};

/// Reads the low `bits` (1..64) of value as a two's complement number.
inline std::int64_t sign_extend(std::uint64_t value, unsigned bits) {
  if (bits >= 64) return static_cast<std::int64_t>(value);
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  const std::uint64_t low = value & ((sign << 1) - 1);
  return static_cast<std::int64_t>((low ^ sign) - sign);
}

}  // namespace odomcalib::drivers
