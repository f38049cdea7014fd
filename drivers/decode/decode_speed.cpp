// Controllers that are not CANopen: what the protocol understood, line by line.
#include <cmath>

#include "drivers/base/speed/speed_protocol.hpp"
#include "drivers/can/candump.hpp"
#include "drivers/decode/decode_parts.hpp"

namespace odomcalib::drivers {
namespace {

using nlohmann::ordered_json;

class SpeedLog {
 public:
  explicit SpeedLog(const Profile& profile) : counts_(profile) {}

  /// Lines of everything that the protocol understood since the last call.
  std::string lines_of(SpeedProtocol& protocol) {
    std::string out;
    for (const DeviceMessage& message : protocol.take_messages()) out += line_of(message).dump() + "\n";
    for (const SideCount& count : protocol.take_counts()) {
      const WheelCounts::Reading reading = counts_.on_count(count.side, count.raw, count.t);
      const ordered_json note = count_note(count.side, count.raw, count.t, reading);
      if (!note.is_null()) out += note.dump() + "\n";
      for (const TickSample& sample : counts_.take()) out += tick_line(sample).dump() + "\n";
    }
    return out;
  }
  void count_into(Counters& counters) const { counts_.count_into(counters); }

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

  WheelCounts counts_;
};

Result<std::string> decode_frames(SpeedLog& log, SpeedProtocol& protocol, std::string_view text,
                                  const std::string& where) {
  CandumpReader reader(text);
  std::string out;
  while (const auto frame = reader.next()) {
    protocol.on_frame(*frame);
    out += log.lines_of(protocol);
  }
  if (const auto problem = reader.problem(where)) return *problem;
  Counters counters = reader.counters();
  counters.merge(protocol.counters());
  log.count_into(counters);
  return out + summary_line(counters, {"bad_line", "fd_frame", "bad_frames", "other_frames", "tick_jumps",
                                       "unpaired_counts"});
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
  Counters counters = protocol.counters();
  log.count_into(counters);
  return out +
         summary_line(counters, {"bad_checksum", "bad_length", "short_packets", "other_packets", "bad_line",
                                 "line_too_long", "invalid_command", "tick_jumps", "unpaired_counts"});
}

}  // namespace

Result<std::string> decode_speed(const Profile& profile, std::string_view text,
                                 std::span<const std::uint8_t> bytes, const std::string& where) {
  const auto protocol = make_speed_protocol(profile);
  if (!protocol) return protocol.error();
  SpeedLog log(profile);
  SpeedProtocol& device = *protocol.value();
  if (device.wire() == Wire::can) return decode_frames(log, device, text, where);
  return decode_stream(profile, log, device, bytes);
}

}  // namespace odomcalib::drivers
