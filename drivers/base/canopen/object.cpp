#include "drivers/base/canopen/object.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "drivers/bytes.hpp"

namespace odomcalib::drivers::canopen {

std::string to_text(const ObjectAddress& object) {
  std::array<char, 16> text{};
  const int n = std::snprintf(text.data(), text.size(), "%04X:%02X", object.index, object.sub);
  return {text.data(), static_cast<std::size_t>(std::max(n, 0))};
}

std::vector<std::uint8_t> encode(std::int64_t value, NumberType type) {
  std::vector<std::uint8_t> out(type.bytes);
  for (std::size_t i = 0; i < out.size() && i < 8; ++i)
    out[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
  return out;
}

std::int64_t decode(const std::vector<std::uint8_t>& bytes, NumberType type) {
  ByteReader reader(bytes);
  const std::size_t n = std::min<std::size_t>({bytes.size(), type.bytes, 8});
  const std::uint64_t value = reader.number(n);
  if (n == 0 || !type.is_signed) return static_cast<std::int64_t>(value);
  return sign_extend(value, static_cast<unsigned>(8 * n));
}

bool fits(std::int64_t value, NumberType type) {
  if (type.bytes >= 8) return type.is_signed || value >= 0;
  const std::int64_t range = std::int64_t{1} << (8 * type.bytes);
  return type.is_signed ? value >= -range / 2 && value < range / 2 : value >= 0 && value < range;
}

}  // namespace odomcalib::drivers::canopen
