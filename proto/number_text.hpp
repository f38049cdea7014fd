// Numbers as text: one that somebody wrote, and one to be read.
#pragma once

#include <array>
#include <charconv>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace odomcalib {

/// The number that is all of a text; nullopt: it is none, or something stands beside it.
/// @param options as std::from_chars takes them, such as a base
template <typename Number, typename... Options>
std::optional<Number> number_from(std::string_view text, Options... options) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value, options...);
  return parsed.ec == std::errc{} && parsed.ptr == end ? std::optional(value) : std::nullopt;
}

/// @param format of std::printf, with one conversion, such as "%.2f"
inline std::string printed(const char* format, double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

}  // namespace odomcalib
