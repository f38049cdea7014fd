#include "drivers/decode/capture_file.hpp"

#include <algorithm>
#include <optional>

namespace odomcalib::drivers {
namespace {

using ByteString = std::vector<std::uint8_t>;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

bool is_hex(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return is_blank(c) || hex_digit(c) >= 0; });
}

void append_hex(std::string_view text, ByteString& out) {
  int high = -1;
  for (const char c : text) {
    if (is_blank(c)) continue;
    const int digit = hex_digit(c);
    if (high >= 0) out.push_back(static_cast<std::uint8_t>(high << 4 | digit));
    high = high >= 0 ? -1 : digit;
  }
}

std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// Whether the line is "TIME < HEX" or "TIME > HEX"; the bytes of the former are appended.
bool read_session_line(std::string_view line, ByteString& out) {
  const std::size_t blank = line.find(' ');
  if (blank == std::string_view::npos || line.size() < blank + 4 || line[blank + 2] != ' ') return false;
  const bool timed = std::all_of(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(blank),
                                 [](char c) { return c == '-' || c == '.' || (c >= '0' && c <= '9'); });
  const char direction = line[blank + 1];
  const std::string_view hex = line.substr(blank + 3);
  if (blank == 0 || !timed || (direction != '<' && direction != '>') || !is_hex(hex)) return false;
  if (direction == '<') append_hex(hex, out);
  return true;
}

/// A last line that was cut off is left out.
std::optional<ByteString> read_session(std::string_view text) {
  ByteString out;
  bool any = false;
  while (!text.empty()) {
    const std::string_view line = next_line(text);
    if (line.empty() || line.front() == '#') continue;
    const bool fits = read_session_line(line, out);
    if (!fits && (!any || !text.empty())) return std::nullopt;
    any = true;
  }
  return any ? std::optional(out) : std::nullopt;
}

}  // namespace

std::vector<std::uint8_t> device_bytes(std::string_view file) {
  if (is_hex(file)) {
    ByteString out;
    append_hex(file, out);
    return out;
  }
  if (auto session = read_session(file)) return std::move(*session);
  return {file.begin(), file.end()};
}

}  // namespace odomcalib::drivers
