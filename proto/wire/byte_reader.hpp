// Reading of numbers, in either byte order, that cannot leave its bytes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace odomcalib {

/// Once something was missing, `ok()` is false for good and every value is zero: check once, at the end.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }
  [[nodiscard]] bool at_end() const { return ok_ && rest_.empty(); }
  void fail() { ok_ = false; }

  /// The next `size` bytes, or an empty view when there are fewer.
  std::string_view take(std::size_t size) {
    if (!ok_ || size > rest_.size()) {
      ok_ = false;
      return {};
    }
    const auto out = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return out;
  }

  template <typename Number>
  Number big_endian() {
    return number<Number>(std::endian::big);
  }
  template <typename Number>
  Number little_endian() {
    return number<Number>(std::endian::little);
  }
  template <typename Number>
  Number number(std::endian order) {
    if constexpr (std::is_floating_point_v<Number>) {
      using Bits = std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>;
      return std::bit_cast<Number>(number<Bits>(order));
    } else {
      std::uint64_t value = 0;
      unsigned shift = 0;
      for (const char byte : take(sizeof(Number))) {
        const std::uint64_t digit = static_cast<unsigned char>(byte);
        value = order == std::endian::big ? value << 8U | digit : value | digit << shift;
        shift += 8;
      }
      return static_cast<Number>(static_cast<std::make_unsigned_t<Number>>(value));
    }
  }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace odomcalib
