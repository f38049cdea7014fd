// Text that a device sent: foreign, in no known encoding. Only what prints is kept.
#pragma once

#include <string>
#include <string_view>

#include "drivers/bytes.hpp"

namespace odomcalib::drivers {

/// Up to the first zero; bytes that do not print become "?"; blanks at the end are padding.
inline std::string clean_text(std::string_view foreign) {
  std::string out;
  for (const char byte : foreign.substr(0, foreign.find('\0')))
    out += byte >= 0x20 && byte < 0x7F ? byte : '?';
  out.erase(out.find_last_not_of(' ') + 1);
  return out;
}

/// Bytes as hexadecimal digits, "1A2B": two capital ones a byte.
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
