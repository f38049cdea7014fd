#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "drivers/base/canopen/words.hpp"
#include "drivers/base/cia402/drive_state.hpp"
#include "drivers/base/motion/tick_pairing.hpp"
#include "drivers/base/motion/tick_unwrap.hpp"
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
bool is_signed(const ObjectAddress& object) {
  constexpr std::array<std::uint16_t, 8> kSigned = {0x6060, 0x6061, 0x6063, 0x6064,
                                                    0x606C, 0x6077, 0x607A, 0x60FF};
  return object.sub <= 2 && std::find(kSigned.begin(), kSigned.end(), object.index) != kSigned.end();
}

class CanopenLog {
 public:
  explicit CanopenLog(const Profile& profile) : profile_(profile) {
    const double most = profile.max_rpm / 60.0 * profile.ticks_per_rev;
    left_ = TickUnwrap(most);
    right_ = TickUnwrap(most);
    for (const canopen::Pdo& pdo : profile.pdos) pdos_.push_back({profile.node, pdo, false});
  }

  ordered_json on_frame(const CanFrame& frame) {
    ordered_json line = {{"type", "message"}, {"t", frame.t}};
    if (frame.error || frame.extended || frame.remote)
      return other(line, frame, frame.error ? "error_frame" : "other");
    if (frame.id == 0x000) return nmt(line, frame);
    if (frame.id == 0x080) return other(line, frame, "sync");
    if (frame.id > 0x080 && frame.id < 0x100) return emergency(line, frame);
    if (frame.id > 0x700 && frame.id < 0x780) return heartbeat(line, frame);
    if (frame.id > 0x580 && frame.id < 0x600) return sdo(line, frame, true);
    if (frame.id > 0x600 && frame.id < 0x680) return sdo(line, frame, false);
    if (const NodePdo* mapped = mapping_of(frame.id)) return process_data(line, frame, *mapped);
    return other(line, frame, "other");
  }

  [[nodiscard]] std::uint64_t short_pdos() const { return short_pdos_; }
  [[nodiscard]] std::uint64_t short_frames() const { return short_frames_; }

 private:
  struct NodePdo {
    std::uint32_t node = 0;
    canopen::Pdo pdo;
    bool guessed = false;  ///< predefined by CiA 402, not seen in the log
  };

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

  /// What the identifier was last said to carry. A pair's log begins with the mapping that CiA 402
  /// predefines.
  const NodePdo* mapping_of(std::uint32_t id) {
    for (const NodePdo& known : pdos_)
      if (known.pdo.cob_id == id) return &known;
    if (profile_.sides.empty()) return nullptr;
    const auto predefined = canopen::predefined_pdo(id);
    if (!predefined) return nullptr;
    pdos_.push_back({id & 0x7F, *predefined, true});
    return &pdos_.back();
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
      if (known.node == node && known.pdo.transmit == transmit && known.pdo.number == number)
        return known.pdo;
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
    if (pdo.transmit) {
      const auto ticks = profile_.sides.empty() ? dual_ticks(frame, pdo) : pair_ticks(frame, mapped);
      if (ticks) return *ticks;
    }
    for (const canopen::PdoEntry& entry : pdo.entries)
      if (const auto value = canopen::unpack(pdo, frame, entry.object); value && entry.bits > 0) {
        line["values"][canopen::to_text(entry.object)] =
            is_signed(entry.object) ? sign_extend(*value, entry.bits) : static_cast<std::int64_t>(*value);
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

  std::optional<ordered_json> dual_ticks(const CanFrame& frame, const canopen::Pdo& pdo) {
    const auto left = canopen::unpack(pdo, frame, profile_.position_left);
    const auto right = canopen::unpack(pdo, frame, profile_.position_right);
    if (!left || !right) return std::nullopt;
    const auto l = left_.on_count(sign_extend(*left, 32), frame.t);
    const auto r = right_.on_count(sign_extend(*right, 32), frame.t);
    return tick_line({frame.t, l.total, r.total});
  }

  /// Two drives: a tick reading comes with the second of the two positions.
  std::optional<ordered_json> pair_ticks(const CanFrame& frame, const NodePdo& mapped) {
    for (std::size_t i = 0; i < profile_.sides.size(); ++i) {
      const Profile& side = profile_.sides[i];
      const auto raw = canopen::unpack(mapped.pdo, frame, side.position_left);
      if (side.node != mapped.node || !raw) continue;
      TickUnwrap& unwrap = i == 0 ? left_ : right_;
      const auto total = unwrap.on_count(sign_extend(*raw, 32), frame.t).total;
      const auto pair = pairing_.add(i == 0 ? Side::left : Side::right, frame.t, total);
      if (pair) return tick_line(*pair);
    }
    return std::nullopt;
  }

  ordered_json tick_line(const TickPairing::Pair& pair) const {
    return {{"type", "ticks"},
            {"t", pair.t},
            {"left", profile_.left_sign * pair.left},
            {"right", profile_.right_sign * pair.right}};
  }

  const Profile& profile_;
  std::vector<NodePdo> pdos_;
  TickPairing pairing_;
  TickUnwrap left_{0.0}, right_{0.0};
  std::uint64_t short_pdos_ = 0, short_frames_ = 0;
};

}  // namespace

std::string decode_canopen(const Profile& profile, std::string_view text) {
  CanopenLog log(profile);
  CandumpReader reader(text);
  std::string out;
  while (const auto frame = reader.next()) out += log.on_frame(*frame).dump() + "\n";
  Counters counters = reader.counters();
  counters["short_pdo"] = log.short_pdos();
  counters["short_frame"] = log.short_frames();
  return out + summary_line(counters, {"bad_line", "fd_frame", "short_pdo", "short_frame"});
}

}  // namespace odomcalib::drivers
