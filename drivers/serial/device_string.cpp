#include <algorithm>
#include <array>
#include <initializer_list>

#include "drivers/serial/port.hpp"
#include "proto/number_text.hpp"

namespace odomcalib::drivers {
namespace {

struct Scheme {
  const char* name;
  std::initializer_list<const char*> options;
  const char* remedy;  ///< for an option that it does not have
};

constexpr std::initializer_list<const char*> kOfSlcan = {"bitrate", "baud", "timestamps"};
constexpr std::initializer_list<const char*> kOfSerial = {"baud", "dtr"};
constexpr std::array<Scheme, 4> kSchemes = {{
    {"socketcan", {}, "the interface has its bit rate already: ip link set can0 up type can bitrate 500000"},
    {"slcan", kOfSlcan, "slcan takes bitrate, baud and timestamps"},
    {"serial", kOfSerial, "serial takes baud and, for lidars, dtr"},
    {"tcp", {}, "tcp takes none: tcp:HOST:PORT"},
}};

Error bad_device(const std::string& text, const std::string& what) {
  return {ErrorCode::usage, what, "device \"" + text + "\"",
          "write it like serial:/dev/ttyUSB0?baud=230400, tcp:192.168.0.10:2112, "
          "slcan:/dev/ttyACM0?bitrate=500000 or "
          "socketcan:can0"};
}

/// Splits "a=1&b=2"; false when a part is not key=value or a key comes twice.
bool parse_options(std::string text, DeviceString& out) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('&'), text.size());
    const std::string part = text.substr(0, end);
    text.erase(0, end + 1);
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == part.size()) return false;
    const std::string key = part.substr(0, equals);
    if (!out.option(key, "").empty()) return false;
    out.options.emplace_back(key, part.substr(equals + 1));
  }
  return true;
}

}  // namespace

std::string DeviceString::option(const std::string& key, const std::string& otherwise) const {
  for (const auto& [name, value] : options)
    if (name == key) return value;
  return otherwise;
}

Result<DeviceString> parse_device(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return bad_device(text, "no scheme (the part before a colon)");
  DeviceString out;
  out.scheme = text.substr(0, colon);
  const auto scheme = std::find_if(kSchemes.begin(), kSchemes.end(),
                                   [&](const Scheme& one) { return out.scheme == one.name; });
  if (scheme == kSchemes.end()) return bad_device(text, "unknown scheme \"" + out.scheme + "\"");
  const std::size_t question = std::min(text.find('?', colon), text.size());
  out.path = text.substr(colon + 1, question - colon - 1);
  if (out.path.empty()) return bad_device(text, "no path after \"" + out.scheme + ":\"");
  const bool has_options = question < text.size();
  if (has_options && (question + 1 == text.size() || !parse_options(text.substr(question + 1), out)))
    return bad_device(text, "options after \"?\" must be key=value, each key once, joined by &");
  for (const auto& [key, value] : out.options)
    if (std::find(scheme->options.begin(), scheme->options.end(), key) == scheme->options.end())
      return Error{ErrorCode::usage, "unknown option \"" + key + "\"", "device \"" + text + "\"",
                   scheme->remedy};
  return out;
}

Result<unsigned> baud_of(const DeviceString& device) {
  const std::string text = device.option("baud", "");
  if (const auto baud = number_from<unsigned>(text); baud && *baud > 0) return *baud;
  return Error{ErrorCode::usage,
               text.empty() ? "the baud rate is missing" : "\"" + text + "\" is no baud rate",
               device.scheme + ":" + device.path, "add it to the device, e.g. ?baud=57600"};
}

}  // namespace odomcalib::drivers
