#include "drivers/decode.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

#include "drivers/decode_parts.hpp"

namespace odomcalib::drivers {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

/// Raw bytes; a file of nothing but hexadecimal digits is their notation as printed in data sheets.
std::vector<std::uint8_t> raw_bytes(std::string_view text) {
  const bool notation = !text.empty() && std::all_of(text.begin(), text.end(),
                                                     [](char c) { return is_blank(c) || hex_digit(c) >= 0; });
  if (!notation) return {text.begin(), text.end()};
  std::vector<std::uint8_t> out;
  int high = -1;
  for (const char c : text) {
    if (is_blank(c)) continue;
    const int digit = hex_digit(c);
    if (high >= 0) out.push_back(static_cast<std::uint8_t>(high << 4 | digit));
    high = high >= 0 ? -1 : digit;
  }
  return out;
}

std::string profile_path(const std::string& name, const std::string& folder) {
  const bool is_path = name.find('/') != std::string::npos || name.ends_with(".toml");
  return is_path ? name : folder + "/" + name + ".toml";
}

}  // namespace

Result<std::string> decode(const std::string& driver, std::string_view bytes,
                           const std::string& profile_folder, const std::string& where) {
  if (driver == "ld06" || driver == "ld19") return decode_ld06(raw_bytes(bytes));
  const std::string prefix = "canopen:";
  if (!driver.starts_with(prefix) || driver.size() == prefix.size())
    return Error{ErrorCode::usage, "unknown driver \"" + driver + "\"", where,
                 "known: ld06, ld19, canopen:PROFILE (e.g. canopen:zlac8015d)"};
  const auto profile = read_profile(profile_path(driver.substr(prefix.size()), profile_folder));
  if (!profile) return profile.error();
  return decode_candump(profile.value(), bytes);
}

}  // namespace odomcalib::drivers
