// Controllers that are not CANopen: what the protocol understood, line by line.
#include <cmath>

#include "drivers/base/motion/tick_unwrap.hpp"
#include "drivers/base/speed/speed_protocol.hpp"
#include "drivers/can/candump.hpp"
#include "drivers/decode/decode_parts.hpp"

namespace odomcalib::drivers {
namespace {

using nlohmann::ordered_json;

class SpeedLog {
 public:
  explicit SpeedLog(const Profile& profile)
      : profile_(profile),
        left_(profile.max_rpm / 60.0 * profile.ticks_per_rev, profile.count_bits),
        right_(profile.max_rpm / 60.0 * profile.ticks_per_rev, profile.count_bits) {}

  /// What the protocol understood since the last call.
  std::string lines_of(SpeedProtocol& protocol) {
    std::string out;
    for (const DeviceMessage& message : protocol.take_messages()) out += line_of(message).dump() + "\n";
    for (const SideCount& count : protocol.take_counts()) {
      TickUnwrap& unwrap = count.side == Side::left ? left_ : right_;
      const auto pair = pairing_.add(count.side, count.t, unwrap.on_count(count.raw, count.t).total);
      if (pair) out += line_of(*pair).dump() + "\n";
    }
    return out;
  }

 private:
  static ordered_json line_of(const DeviceMessage& message) {
    ordered_json line = {{"type", "message"}, {"t", message.t}, {"name", message.name}};
    for (const MessageField& field : message.fields) {
      const bool whole = std::abs(field.number) < 1e15 && field.number == std::trunc(field.number);
      if (!field.text.empty())
        line[field.name] = field.text;
      else if (whole)
        line[field.name] = static_cast<std::int64_t>(field.number);
      else
        line[field.name] = field.number;
    }
    return line;
  }

  ordered_json line_of(const TickPairing::Pair& pair) const {
    return {{"type", "ticks"},
            {"t", pair.t},
            {"left", profile_.left_sign * pair.left},
            {"right", profile_.right_sign * pair.right}};
  }

  const Profile& profile_;
  TickUnwrap left_, right_;
  TickPairing pairing_;
};

std::string decode_frames(SpeedLog& log, SpeedProtocol& protocol, std::string_view text) {
  CandumpReader reader(text);
  std::string out;
  while (const auto frame = reader.next()) {
    protocol.on_frame(*frame);
    out += log.lines_of(protocol);
  }
  Counters counters = reader.counters();
  counters.merge(protocol.counters());
  return out + summary_line(counters, {"bad_line", "fd_frame", "bad_frames", "other_frames"});
}

/// Bytes carry no time: they are dated as if they had come one after the other at the profile's rate.
std::string decode_stream(const Profile& profile, SpeedLog& log, SpeedProtocol& protocol,
                          std::span<const std::uint8_t> bytes) {
  protocol.on_connected(profile.bitrate);
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    protocol.on_bytes(bytes.subspan(i, 1), 10.0 * static_cast<double>(i + 1) / profile.bitrate);
    out += log.lines_of(protocol);
  }
  return out +
         summary_line(protocol.counters(), {"bad_checksum", "bad_length", "short_packets", "other_packets",
                                            "bad_line", "line_too_long", "invalid_command"});
}

}  // namespace

Result<std::string> decode_speed(const Profile& profile, std::string_view text,
                                 std::span<const std::uint8_t> bytes) {
  const auto protocol = make_speed_protocol(profile);
  if (!protocol) return protocol.error();
  SpeedLog log(profile);
  SpeedProtocol& device = *protocol.value();
  if (device.wire() == Wire::can) return decode_frames(log, device, text);
  return decode_stream(profile, log, device, bytes);
}

}  // namespace odomcalib::drivers
