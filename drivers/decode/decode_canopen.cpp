#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <utility>

#include "drivers/base/canopen/words.hpp"
#include "drivers/base/cia402/drive_state.hpp"
#include "drivers/base/cia402/pdo_dates.hpp"
#include "drivers/bytes.hpp"
#include "drivers/can/candump.hpp"
#include "drivers/decode/decode_parts.hpp"

namespace odomcalib::drivers {
namespace {

using canopen::ObjectAddress;
using nlohmann::ordered_json;

std::string hex_text(std::uint64_t value, int digits) {
  std::array<char, 24> text{};
  const int n =
      std::snprintf(text.data(), text.size(), "%0*llX", digits, static_cast<unsigned long long>(value));
  return {text.data(), static_cast<std::size_t>(std::max(n, 0))};
}

std::string data_text(const CanFrame& frame) {
  std::string out;
  for (std::size_t i = 0; i < frame.length; ++i) out += hex_text(frame.data[i], 2);
  return out;
}

/// Modes, positions, speeds and torques of CiA 402; packed halves (:03 of some drives) are left as they are.
bool is_signed_object(const ObjectAddress& object) {
  constexpr std::array<std::uint16_t, 8> kSigned = {0x6060, 0x6061, 0x6063, 0x6064,
                                                    0x606C, 0x6077, 0x607A, 0x60FF};
  return object.sub <= 2 && std::find(kSigned.begin(), kSigned.end(), object.index) != kSigned.end();
}

class CanopenLog {
 public:
  explicit CanopenLog(const Profile& profile) : profile_(profile), counts_(profile) {
    assume(profile, false);
    for (const Profile& side : profile.sides) {
      assume(side, true);
      dates_.emplace_back(side);
    }
    if (profile.sides.empty()) dates_.emplace_back(profile);
  }

  /// Lines about a frame, each one with its end. A frame that completes a tick reading is that reading.
  std::string on_frame(const CanFrame& frame) {
    const ordered_json line = line_of(frame);
    const std::vector<TickSample> samples = counts_.take();
    std::string out = line.is_null() || !samples.empty() ? "" : line.dump() + "\n";
    for (const ordered_json& note : std::exchange(notes_, {})) out += note.dump() + "\n";
    for (const TickSample& sample : samples) out += tick_line(sample).dump() + "\n";
    return out;
  }

  [[nodiscard]] Counters counters() const {
    Counters out{{"short_pdo", short_pdos_}, {"short_frame", short_frames_}};
    counts_.count_into(out);
    return out;
  }

 private:
  /// The profile's mapping, but for the timer of each PDO: a log need not be of a drive that was set up so.
  void assume(const Profile& profile, bool guessed) {
    for (canopen::Pdo pdo : profile.pdos) {
      pdo.event_timer.reset();
      pdos_.push_back({profile.node, std::move(pdo), guessed});
    }
  }

  struct NodePdo {
    std::uint32_t node = 0;
    canopen::Pdo pdo;
    bool guessed = false;  ///< from the profile or by CiA 402, not seen in the log
  };

  /// null when nothing but counts is in it.
  ordered_json line_of(const CanFrame& frame) {
    ordered_json line = {{"type", "message"}, {"t", frame.t}};
    if (frame.error || frame.extended || frame.remote)
      return other(line, frame, frame.error ? "error_frame" : "other");
    if (frame.id == 0x000) return nmt(line, frame);
    if (frame.id == 0x080) {
      for (PdoDates& dates : dates_) dates.on_sync(frame.t);
      return other(line, frame, "sync");
    }
    if (frame.id > 0x080 && frame.id < 0x100) return emergency(line, frame);
    if (frame.id > 0x700 && frame.id < 0x780) return heartbeat(line, frame);
    if (frame.id > 0x580 && frame.id < 0x600) return sdo(line, frame, true);
    if (frame.id > 0x600 && frame.id < 0x680) return sdo(line, frame, false);
    if (const NodePdo* mapped = mapping_of(frame)) return process_data(line, frame, *mapped);
    return other(line, frame, "other");
  }

  static ordered_json other(ordered_json line, const CanFrame& frame, const char* name) {
    line["name"] = name;
    line["id"] = hex_text(frame.id, frame.extended ? 8 : 3);
    line["data"] = data_text(frame);
    return line;
  }

  ordered_json too_short(const ordered_json& line, const CanFrame& frame) {
    ++short_frames_;
    return other(line, frame, "other");
  }

  ordered_json nmt(ordered_json line, const CanFrame& frame) {
    if (frame.length < 2) return too_short(line, frame);
    line["name"] = "nmt";
    line["node"] = frame.data[1];
    line["command"] = frame.data[0];
    return line;
  }

  ordered_json emergency(ordered_json line, const CanFrame& frame) {
    if (frame.length < 8) return too_short(line, frame);
    ByteReader reader(Bytes(frame.data).first(frame.length));
    const std::uint16_t code = reader.u16();
    line["name"] = "emcy";
    line["node"] = frame.id - 0x080;
    line["code"] = hex_text(code, 4);
    line["error_register"] = reader.u8();
    line["text"] = canopen::emergency_text(code);
    return line;
  }

  ordered_json heartbeat(ordered_json line, const CanFrame& frame) {
    if (frame.length < 1) return too_short(line, frame);
    line["name"] = "heartbeat";
    line["node"] = frame.id - 0x700;
    line["state"] = canopen::nmt_state_text(frame.data[0] & 0x7F);
    return line;
  }

  ordered_json sdo(ordered_json line, const CanFrame& frame, bool answer) {
    if (frame.length < 8) return too_short(line, frame);
    const std::uint8_t command = frame.data[0];
    ByteReader reader(Bytes(frame.data).subspan(1));
    const std::uint16_t index = reader.u16();
    const ObjectAddress object{index, reader.u8()};
    const std::uint32_t value = reader.u32();
    const bool is_abort = command == 0x80;
    const bool has_object =
        is_abort || (command & 0xE0) == (answer ? 0x60 : 0x20) || (command & 0xE0) == 0x40;
    const bool holds_value = !is_abort && (command & 0xE3) == (answer ? 0x43 : 0x23);
    line["name"] = is_abort ? "sdo_abort" : answer ? "sdo_answer" : "sdo_request";
    line["node"] = frame.id & 0x7F;
    line["command"] = hex_text(command, 2);
    if (!has_object || ((command & 0xE0) == 0x60 && !answer)) return with_data(line, frame);
    line["object"] = canopen::to_text(object);
    if (is_abort) {
      line["code"] = hex_text(value, 8);
      line["text"] = canopen::abort_text(value);
    }
    if (holds_value) {
      line["bytes"] = 4 - ((command >> 2) & 3);
      line["value"] = value;
      learn(frame.id & 0x7F, object, value);
    }
    return line;
  }

  static ordered_json with_data(ordered_json line, const CanFrame& frame) {
    line["data"] = data_text(frame);
    return line;
  }

  /// Mapping last stated for the identifier. Where the log does not state it, a pair's drive is mapped as
  /// the profile would set it, if the frame is as long; otherwise as CiA 402 predefines it.
  const NodePdo* mapping_of(const CanFrame& frame) {
    for (const NodePdo& known : pdos_)
      if (known.pdo.cob_id == frame.id &&
          (!known.guessed || canopen::mapped_bytes(known.pdo) == frame.length))
        return &known;
    if (profile_.sides.empty()) return nullptr;
    const auto predefined = canopen::predefined_pdo(frame.id);
    if (!predefined) return nullptr;
    predefined_ = {frame.id & 0x7F, *predefined, true};
    return &predefined_;
  }

  /// The mapping in force is what the log says, not what the profile would set: both writes and reads tell.
  void learn(std::uint32_t node, const ObjectAddress& object, std::uint32_t value) {
    const bool transmit = object.index >= 0x1800;
    const std::uint16_t kind = object.index & 0xFE00;  // 14xx, 16xx, 18xx, 1Axx
    if (kind != 0x1400 && kind != 0x1600 && kind != 0x1800 && kind != 0x1A00) return;
    const auto number = static_cast<std::uint16_t>((object.index & 0x1FF) + 1);
    canopen::Pdo& pdo = find_or_add(node, transmit, number);
    const bool communication = kind == 0x1400 || kind == 0x1800;
    if (communication && object.sub == 1) pdo.cob_id = value & 0x7FF;
    if (communication) return;
    if (object.sub == 0 && value <= 8) pdo.entries.resize(value);
    if (object.sub == 0 || object.sub > 8) return;
    if (pdo.entries.size() < object.sub) pdo.entries.resize(object.sub);
    pdo.entries[object.sub - 1u] = {
        {static_cast<std::uint16_t>(value >> 16), static_cast<std::uint8_t>(value >> 8)},
        static_cast<std::uint8_t>(value)};
  }

  canopen::Pdo& find_or_add(std::uint32_t node, bool transmit, std::uint16_t number) {
    for (NodePdo& known : pdos_)
      if (known.node == node && known.pdo.transmit == transmit && known.pdo.number == number) {
        known.guessed = false;
        return known.pdo;
      }
    NodePdo added{node, {}, false};
    added.pdo.transmit = transmit;
    added.pdo.number = number;
    if (number <= 4) added.pdo.cob_id = (transmit ? 0x080u : 0x100u) + 0x100u * number + node;
    pdos_.push_back(added);
    return pdos_.back().pdo;
  }

  ordered_json process_data(ordered_json line, const CanFrame& frame, const NodePdo& mapped) {
    const canopen::Pdo& pdo = mapped.pdo;
    line["name"] = (pdo.transmit ? "tpdo" : "rpdo") + std::to_string(pdo.number);
    line["node"] = mapped.node;
    if (frame.length < canopen::mapped_bytes(pdo) || frame.length == 0) {
      if (!mapped.guessed) ++short_pdos_;
      return with_data(line, frame);
    }
    if (pdo.transmit && profile_.sides.empty() && dual_counts(frame, pdo)) return nullptr;
    if (pdo.transmit) pair_counts(frame, mapped);
    for (const canopen::PdoEntry& entry : pdo.entries)
      if (const auto value = canopen::unpack(pdo, frame, entry.object); value && entry.bits > 0) {
        line["values"][canopen::to_text(entry.object)] = is_signed_object(entry.object)
                                                             ? sign_extend(*value, entry.bits)
                                                             : static_cast<std::int64_t>(*value);
        if (entry.object.index == 0x6041) line["states"] = states_of(*value, entry.bits);
      }
    return line;
  }

  /// Status words: one, or a half of 32 bits for each axis.
  static ordered_json states_of(std::uint64_t value, unsigned bits) {
    ordered_json states = ordered_json::array();
    for (unsigned shift = 0; shift < bits && shift < 32; shift += 16)
      states.push_back(canopen::to_text(canopen::decode_status(static_cast<std::uint16_t>(value >> shift))));
    return states;
  }

  void on_count(Side side, std::uint64_t raw, double t) {
    const std::int64_t count = sign_extend(raw, 32);
    const ordered_json note = count_note(side, count, t, counts_.on_count(side, count, t));
    if (!note.is_null()) notes_.push_back(note);
  }

  bool dual_counts(const CanFrame& frame, const canopen::Pdo& pdo) {
    const auto left = canopen::unpack(pdo, frame, profile_.position_left);
    const auto right = canopen::unpack(pdo, frame, profile_.position_right);
    if (!left || !right) return false;
    const double t = dates_[0].date(pdo, frame);
    on_count(Side::left, *left, t);
    on_count(Side::right, *right, t);
    return true;
  }

  /// Two drives: a tick reading comes with the second of the two positions.
  void pair_counts(const CanFrame& frame, const NodePdo& mapped) {
    for (std::size_t i = 0; i < profile_.sides.size(); ++i) {
      const Profile& side = profile_.sides[i];
      const auto raw = canopen::unpack(mapped.pdo, frame, side.position_left);
      if (side.node != mapped.node || !raw) continue;
      on_count(i == 0 ? Side::left : Side::right, *raw, dates_[i].date(mapped.pdo, frame));
    }
  }

  const Profile& profile_;
  std::vector<NodePdo> pdos_;
  NodePdo predefined_;
  std::vector<PdoDates> dates_;  // of the drive, or of the left and the right one
  WheelCounts counts_;
  std::vector<ordered_json> notes_;
  std::uint64_t short_pdos_ = 0, short_frames_ = 0;
};

}  // namespace

Result<std::string> decode_canopen(const Profile& profile, std::string_view text, const std::string& where) {
  CanopenLog log(profile);
  CandumpReader reader(text);
  std::string out;
  while (const auto frame = reader.next()) out += log.on_frame(*frame);
  if (const auto problem = reader.problem(where)) return *problem;
  Counters counters = reader.counters();
  counters.merge(log.counters());
  return out + summary_line(counters, {"bad_line", "fd_frame", "short_pdo", "short_frame", "tick_jumps",
                                       "unpaired_counts"});
}

}  // namespace odomcalib::drivers
