// Text that a device sent: foreign, in no known encoding. Only what prints is kept.
#pragma once

#include <string>
#include <string_view>

namespace odomcalib::drivers {

/// Up to the first zero; bytes that do not print become "?"; blanks at the end are padding.
inline std::string clean_text(std::string_view foreign) {
  std::string out;
  for (const char byte : foreign.substr(0, foreign.find('\0')))
    out += byte >= 0x20 && byte < 0x7F ? byte : '?';
  out.erase(out.find_last_not_of(' ') + 1);
  return out;
}

}  // namespace odomcalib::drivers
