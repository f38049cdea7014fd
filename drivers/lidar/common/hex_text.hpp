// Bytes as hexadecimal digits, for people.
#pragma once

#include <string>
#include <string_view>

#include "drivers/bytes.hpp"

namespace odomcalib::drivers {

/// "1A2B": two capital digits a byte.
inline std::string hex_text(Bytes bytes) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string out;
  for (const std::uint8_t byte : bytes) {
    out += kDigits[byte >> 4U];
    out += kDigits[byte & 15U];
  }
  return out;
}

}  // namespace odomcalib::drivers
