#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "drivers/base/canopen/words.hpp"
#include "drivers/base/tick_unwrap.hpp"
#include "drivers/bytes.hpp"
#include "drivers/can/candump.hpp"
#include "drivers/decode_parts.hpp"

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

class CanopenLog {
 public:
  explicit CanopenLog(const Profile& profile) : profile_(profile), pdos_(profile.pdos) {
    const double most = profile.max_rpm / 60.0 * profile.ticks_per_rev;
    left_ = TickUnwrap(most);
    right_ = TickUnwrap(most);
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
    for (const canopen::Pdo& pdo : pdos_)
      if (pdo.cob_id == frame.id) return process_data(line, frame, pdo);
    return other(line, frame, "other");
  }

  [[nodiscard]] std::uint64_t short_pdos() const { return short_pdos_; }
  [[nodiscard]] std::uint64_t short_frames() const { return short_frames_; }

 private:
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
      learn(object, value);
    }
    return line;
  }

  static ordered_json with_data(ordered_json line, const CanFrame& frame) {
    line["data"] = data_text(frame);
    return line;
  }

  /// The mapping in force is what the log says, not what the profile would set: both writes and reads tell.
  void learn(const ObjectAddress& object, std::uint32_t value) {
    const bool transmit = object.index >= 0x1800;
    const std::uint16_t kind = object.index & 0xFE00;  // 14xx, 16xx, 18xx, 1Axx
    if (kind != 0x1400 && kind != 0x1600 && kind != 0x1800 && kind != 0x1A00) return;
    const auto number = static_cast<std::uint16_t>((object.index & 0x1FF) + 1);
    canopen::Pdo& pdo = find_or_add(transmit, number);
    if ((kind == 0x1400 || kind == 0x1800) && object.sub == 1) pdo.cob_id = value & 0x7FF;
    if (kind == 0x1400 || kind == 0x1800) return;
    if (object.sub == 0 && value <= 8) pdo.entries.resize(value);
    if (object.sub == 0 || object.sub > 8) return;
    if (pdo.entries.size() < object.sub) pdo.entries.resize(object.sub);
    pdo.entries[object.sub - 1u] = {
        {static_cast<std::uint16_t>(value >> 16), static_cast<std::uint8_t>(value >> 8)},
        static_cast<std::uint8_t>(value)};
  }

  canopen::Pdo& find_or_add(bool transmit, std::uint16_t number) {
    for (canopen::Pdo& pdo : pdos_)
      if (pdo.transmit == transmit && pdo.number == number) return pdo;
    canopen::Pdo pdo;
    pdo.transmit = transmit;
    pdo.number = number;
    pdo.entries.clear();
    pdos_.push_back(pdo);
    return pdos_.back();
  }

  ordered_json process_data(ordered_json line, const CanFrame& frame, const canopen::Pdo& pdo) {
    line["name"] = (pdo.transmit ? "tpdo" : "rpdo") + std::to_string(pdo.number);
    if (frame.length < canopen::mapped_bytes(pdo) || frame.length == 0) {
      ++short_pdos_;
      return with_data(line, frame);
    }
    const auto left = canopen::unpack(pdo, frame, profile_.position_left);
    const auto right = canopen::unpack(pdo, frame, profile_.position_right);
    if (pdo.transmit && left && right) return ticks(frame.t, *left, *right);
    for (const canopen::PdoEntry& entry : pdo.entries)
      if (const auto value = canopen::unpack(pdo, frame, entry.object); value && entry.bits > 0)
        line["values"][canopen::to_text(entry.object)] = *value;
    return line;
  }

  ordered_json ticks(double t, std::uint64_t left, std::uint64_t right) {
    const auto l = left_.on_count(static_cast<std::int32_t>(sign_extend(left, 32)), t);
    const auto r = right_.on_count(static_cast<std::int32_t>(sign_extend(right, 32)), t);
    return {{"type", "ticks"},
            {"t", t},
            {"left", profile_.left_sign * l.total},
            {"right", profile_.right_sign * r.total}};
  }

  const Profile& profile_;
  std::vector<canopen::Pdo> pdos_;
  TickUnwrap left_{0.0}, right_{0.0};
  std::uint64_t short_pdos_ = 0, short_frames_ = 0;
};

}  // namespace

std::string decode_candump(const Profile& profile, std::string_view text) {
  CanopenLog log(profile);
  Counters counters;
  counters["bytes_in"] = text.size();
  std::string out;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const bool whole = end != std::string_view::npos;
    const std::string_view line = text.substr(0, end);
    const std::size_t size = line.size() + (whole ? 1 : 0);
    const auto frame = parse_candump_line(line);
    text.remove_prefix(size);
    if (frame) {
      counters["good"] += size;
      out += log.on_frame(*frame).dump() + "\n";
    } else if (!whole) {
      counters["buffered"] = size;  // cut off in the middle of a line
    } else {
      counters["skipped"] += size;
      if (!line.empty()) ++counters["bad_line"];
    }
  }
  counters["short_pdo"] = log.short_pdos();
  counters["short_frame"] = log.short_frames();
  return out + summary_line(counters, {"bad_line", "short_pdo", "short_frame"});
}

}  // namespace odomcalib::drivers
