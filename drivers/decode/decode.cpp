#include "drivers/decode/decode.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "drivers/decode/decode_parts.hpp"
#include "drivers/decode/network_capture.hpp"

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

/// The device's bytes of a file in one of these notations, told apart by content:
/// - lines "TIME < HEX" and "TIME > HEX" of a session (TIME in s or "-"): those from the device (<);
/// - nothing but hexadecimal digits, as printed in data sheets;
/// - anything else: raw bytes.
std::vector<std::uint8_t> device_bytes(std::string_view file) {
  if (is_hex(file)) {
    ByteString out;
    append_hex(file, out);
    return out;
  }
  if (auto session = read_session(file)) return std::move(*session);
  return {file.begin(), file.end()};
}

/// "PROTOCOL:PROFILE"; without a profile, the shipped one of that name.
struct Choice {
  std::string protocol, profile;
};

std::optional<Choice> controller_choice(const std::string& driver) {
  constexpr std::array kProtocols = {"canopen", "agilex", "arcos", "odrive", "ros_arduino", "segway", "vesc"};
  const std::size_t colon = driver.find(':');
  Choice choice{driver.substr(0, colon), ""};
  if (std::find(kProtocols.begin(), kProtocols.end(), choice.protocol) == kProtocols.end())
    return std::nullopt;
  if (colon != std::string::npos)
    choice.profile = driver.substr(colon + 1);
  else
    choice.profile = choice.protocol == "canopen" ? "cia402-pair" : choice.protocol;
  return choice.profile.empty() ? std::nullopt : std::optional(choice);
}

std::string profile_path(const std::string& name, const std::string& folder) {
  const bool is_path = name.find('/') != std::string::npos || name.ends_with(".toml");
  return is_path ? name : folder + "/" + name + ".toml";
}

Error no_network(const std::string& driver, const std::string& where) {
  return {ErrorCode::usage, "this is a network capture, and \"" + driver + "\" does not come over TCP", where,
          "give the bytes of its serial line, or a log of `candump -L`"};
}

Result<std::string> decode_lidar_file(const std::string& driver, std::string_view bytes,
                                      const std::string& where) {
  LidarOptions options;
  options.device_time = true;
  const auto type = find_lidar_type(driver);
  const auto lidar = make_lidar(driver, options);
  if (!type || !lidar)
    return Error{
        ErrorCode::usage, "unknown driver \"" + driver + "\"", where,
        "known: " + lidar_type_names() +
            ", and with a profile after a colon: canopen (e.g. canopen:zlac8015d), agilex, arcos, odrive, "
            "ros_arduino, segway, vesc"};
  if (!is_network_capture(bytes)) return decode_lidar(*lidar.value(), device_bytes(bytes));
  if (type.value().port == 0) return no_network(driver, where);
  return decode_lidar_capture(*lidar.value(), type.value().port, bytes, where);
}

}  // namespace

Result<std::string> decode(const std::string& driver, std::string_view bytes,
                           const std::string& profile_folder, const std::string& where) {
  const auto choice = controller_choice(driver);
  if (!choice) return decode_lidar_file(driver, bytes, where);
  if (is_network_capture(bytes)) return no_network(driver, where);
  const auto profile = read_profile(profile_path(choice->profile, profile_folder));
  if (!profile) return profile.error();
  if (profile.value().protocol != choice->protocol)
    return Error{ErrorCode::usage,
                 "profile \"" + choice->profile + "\" is for \"" + profile.value().protocol +
                     "\", not for \"" + choice->protocol + "\"",
                 where, ""};
  if (choice->protocol == "canopen") return decode_canopen(profile.value(), bytes, where);
  // Lines of text may be nothing but digits: they are no hexadecimal notation.
  const bool is_text = choice->protocol == "ros_arduino";
  return decode_speed(profile.value(), bytes,
                      is_text ? std::vector<std::uint8_t>(bytes.begin(), bytes.end()) : device_bytes(bytes),
                      where);
}

}  // namespace odomcalib::drivers
