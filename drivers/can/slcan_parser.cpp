#include "drivers/can/slcan_parser.hpp"

#include <algorithm>
#include <string_view>

#include "proto/number_text.hpp"

namespace odomcalib::drivers {
namespace {

constexpr std::uint8_t kCr = 0x0D;
constexpr std::uint8_t kLf = 0x0A;
constexpr std::uint8_t kBel = 0x07;
constexpr std::uint32_t kMaxStandard = 0x7FF;
constexpr std::uint32_t kMaxExtended = 0x1FFFFFFF;

/// Exactly all characters as hex digits; nullopt otherwise (an empty text too).
std::optional<std::uint32_t> hex(std::string_view text) { return number_from<std::uint32_t>(text, 16); }

bool read_data(std::string_view text, CanFrame& frame) {
  for (std::size_t i = 0; i < frame.length; ++i) {
    const auto byte = hex(text.substr(2 * i, 2));
    if (!byte) return false;
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return true;
}

/// A t, T, r or R line; nullopt when any part of it is not as the protocol says.
std::optional<SlcanItem> parse_frame(std::string_view line) {
  SlcanItem item;
  item.kind = SlcanItem::Kind::frame;
  CanFrame& frame = item.frame;
  frame.extended = line[0] == 'T' || line[0] == 'R';
  frame.remote = line[0] == 'r' || line[0] == 'R';
  const std::size_t id_digits = frame.extended ? 8 : 3;
  if (line.size() < 2 + id_digits) return std::nullopt;
  const auto id = hex(line.substr(1, id_digits));
  const char length = line[1 + id_digits];
  if (!id || *id > (frame.extended ? kMaxExtended : kMaxStandard) || length < '0' || length > '8')
    return std::nullopt;
  frame.id = *id;
  frame.length = static_cast<std::uint8_t>(length - '0');
  const std::string_view rest = line.substr(2 + id_digits);
  const std::size_t digits = frame.remote ? 0 : 2u * frame.length;
  if (rest.size() != digits && rest.size() != digits + 4) return std::nullopt;
  if (!frame.remote && !read_data(rest.substr(0, digits), frame)) return std::nullopt;
  if (rest.size() == digits) return item;
  const auto stamp = hex(rest.substr(digits));
  if (!stamp || *stamp >= 60000) return std::nullopt;
  item.stamp_ms = static_cast<std::uint16_t>(*stamp);
  return item;
}

bool all_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= 0x20 && c < 0x7F; });
}

std::optional<SlcanItem> parse_text(std::string_view line, SlcanItem::Kind kind) {
  if (!all_printable(line)) return std::nullopt;
  SlcanItem item;
  item.kind = kind;
  item.text = std::string(line);
  return item;
}

std::optional<SlcanItem> parse_line(std::string_view line) {
  if (line.empty() || line == "z" || line == "Z") return SlcanItem{};
  switch (line[0]) {
    case 't':
    case 'T':
    case 'r':
    case 'R':
      return parse_frame(line);
    case 's':
    case 'e':
      return parse_text(line, SlcanItem::Kind::bus_state);
    case 'V':
    case 'v':
    case 'N':
    case 'F':
      return parse_text(line, SlcanItem::Kind::text);
    default:
      return std::nullopt;
  }
}

bool is_fd(char first) { return first == 'd' || first == 'D' || first == 'b' || first == 'B'; }

}  // namespace

void SlcanParser::reset() {
  skipped_ += used_;
  used_ = 0;
  overlong_ = false;
}

void SlcanParser::reject(std::uint64_t& counter) {
  ++counter;
  skipped_ += used_ + 1;
  used_ = 0;
}

void SlcanParser::overflow() {
  ++long_line_;
  skipped_ += used_ + 1;
  used_ = 0;
  overlong_ = true;
}

void SlcanParser::finish_line(std::vector<SlcanItem>& out, std::size_t bytes_after) {
  if (overlong_) {
    overlong_ = false;
    ++skipped_;
    return;
  }
  const std::string_view line(line_.data(), used_);
  if (!line.empty() && is_fd(line[0])) return reject(fd_frame_);
  auto item = parse_line(line);
  if (!item) return reject(bad_line_);
  item->bytes = used_ + 1;
  good_ += item->bytes;
  used_ = 0;
  if (item->kind == SlcanItem::Kind::frame) ++frames_;
  item->bytes_after = bytes_after;
  out.push_back(std::move(*item));
}

std::vector<SlcanItem> SlcanParser::on_bytes(std::span<const std::uint8_t> bytes) {
  std::vector<SlcanItem> out;
  bytes_in_ += bytes.size();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::uint8_t byte = bytes[i];
    const std::size_t after = bytes.size() - 1 - i;
    if (byte == kCr) {
      finish_line(out, after);
    } else if (byte == kLf && used_ == 0 && !overlong_) {
      ++good_;  // of an adapter that ends its lines with CR LF
    } else if (byte == kBel) {
      // Answers come between lines: what stood before BEL was cut off.
      if (used_ > 0) {
        ++bad_line_;
        skipped_ += used_;
        used_ = 0;
      }
      overlong_ = false;
      ++good_;
      ++refused_;
      out.push_back({SlcanItem::Kind::refused, {}, {}, {}, 1, after});
    } else if (overlong_) {
      ++skipped_;
    } else if (used_ == kLongestLine) {
      overflow();
    } else {
      line_[used_++] = static_cast<char>(byte);
    }
  }
  return out;
}

Counters SlcanParser::counters() const {
  return {{"bytes_in", bytes_in_}, {"good", good_},
          {"skipped", skipped_},   {"buffered", used_},
          {"frames", frames_},     {"refused_by_adapter", refused_},
          {"bad_line", bad_line_}, {"line_too_long", long_line_},
          {"fd_frame", fd_frame_}};
}

std::string slcan_line(const CanFrame& frame) {
  static constexpr std::string_view kDigits = "0123456789ABCDEF";
  if (frame.error || frame.length > 8) return {};
  std::string line(1, frame.extended ? (frame.remote ? 'R' : 'T') : (frame.remote ? 'r' : 't'));
  const int id_digits = frame.extended ? 8 : 3;
  for (int i = id_digits - 1; i >= 0; --i) line += kDigits[(frame.id >> (4 * i)) & 0xF];
  line += kDigits[frame.length];
  for (std::size_t i = 0; i < frame.length && !frame.remote; ++i) {
    line += kDigits[frame.data[i] >> 4];
    line += kDigits[frame.data[i] & 0xF];
  }
  return line + '\r';
}

}  // namespace odomcalib::drivers
