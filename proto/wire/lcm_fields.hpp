// Fields of LCM messages (big-endian, lengths checked against the bytes that are left). Internal to proto/.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "proto/wire/byte_reader.hpp"

namespace odomcalib {

/// A string: int32 length including the terminating NUL, bytes, NUL.
inline std::string lcm_text(ByteReader& reader) {
  const auto length = reader.big_endian<std::int32_t>();
  if (length < 1) {
    reader.fail();
    return {};
  }
  const auto bytes = reader.take(static_cast<std::size_t>(length));
  if (bytes.empty() || bytes.back() != '\0') {
    reader.fail();
    return {};
  }
  return std::string(bytes.substr(0, bytes.size() - 1));
}

/// `count` numbers; nothing is allocated before the count is known to fit.
template <typename Number>
std::vector<Number> lcm_array(ByteReader& reader, std::int32_t count) {
  if (count < 0 || static_cast<std::size_t>(count) > reader.left() / sizeof(Number)) {
    reader.fail();
    return {};
  }
  std::vector<Number> out(static_cast<std::size_t>(count));
  for (auto& value : out) value = reader.big_endian<Number>();
  return out;
}

}  // namespace odomcalib
