#include "drivers/can/candump.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "drivers/can/settings.hpp"
#include "proto/number_text.hpp"

namespace odomcalib::drivers {
namespace {

using namespace can;

constexpr std::uint32_t kErrorFlag = 0x20000000;
constexpr std::uint32_t kMaxLoggedId = 0x1FFFFFFF;

/// The text up to the separator, which is consumed too; nullopt when there is none.
std::optional<std::string_view> cut(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view head = text.substr(0, end);
  text.remove_prefix(end + 1);
  return head;
}

bool read_id(std::string_view text, CanFrame& frame) {
  const auto id = number_from<std::uint32_t>(text, 16);
  if (!id || (text.size() != 3 && text.size() != 8)) return false;
  frame.error = text.size() == 8 && (*id & kErrorFlag) != 0;
  frame.extended = text.size() == 8 && !frame.error;
  frame.id = *id & ~(frame.error ? kErrorFlag : 0U);
  return frame.id <= (text.size() == 8 ? kMaxLoggedId : 0x7FFU);
}

bool read_remote(std::string_view text, CanFrame& frame) {
  frame.remote = true;
  text.remove_prefix(1);
  if (text.empty()) return true;
  const auto length = number_from<std::uint8_t>(text, 10);
  if (!length || *length > 8) return false;
  frame.length = *length;
  return true;
}

bool read_logged_data(std::string_view text, CanFrame& frame) {
  if (const std::size_t raw_dlc = text.find('_'); raw_dlc != std::string_view::npos)
    text = text.substr(0, raw_dlc);
  while (!text.empty()) {
    if (text[0] == '.') text.remove_prefix(1);
    const auto byte = text.size() < 2 ? std::nullopt : number_from<std::uint8_t>(text.substr(0, 2), 16);
    if (!byte || frame.length >= 8) return false;
    frame.data[frame.length++] = *byte;
    text.remove_prefix(2);
  }
  return true;
}

std::string_view trim_end(std::string_view line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  const bool direction =
      line.size() > 2 && line[line.size() - 2] == ' ' && (line.back() == 'R' || line.back() == 'T');
  return direction ? line.substr(0, line.size() - 2) : line;
}

/// In microseconds, as candump writes it, of any time that a double can hold.
std::string time_text(double t) {
  std::array<char, std::numeric_limits<double>::max_exponent10 + 16> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), t, std::chars_format::fixed, 6).ptr;
  return {text.data(), end};
}

/// "can0  123   [2]  11 22", with or without a time in front: what candump prints without -l and -L.
bool is_screen_line(std::string_view line) {
  std::string_view before, word;
  while (!line.empty()) {
    const std::size_t begin = std::min(line.find_first_not_of(" \t\r"), line.size());
    line.remove_prefix(begin);
    before = word;
    word = line.substr(0, line.find_first_of(" \t\r"));
    line.remove_prefix(word.size());
    const bool length = word.size() > 2 && word.front() == '[' && word.back() == ']' &&
                        number_from<unsigned>(word.substr(1, word.size() - 2), 10);
    if (length) return (before.size() == 3 || before.size() == 8) && number_from<std::uint32_t>(before, 16);
  }
  return false;
}

/// Other programs' logs, told by how they begin; empty when it is none of them.
std::string_view foreign_log(std::string_view text) {
  using Sign = std::pair<std::string_view, std::string_view>;
  constexpr std::array<Sign, 7> kSigns = {{{"LOGG", "a Vector BLF log"},
                                           {"date ", "a Vector ASC log"},
                                           {"base hex", "a Vector ASC log"},
                                           {";$FILEVERSION", "a PCAN trace"},
                                           {"MDF ", "an MDF log"},
                                           {"\x1F\x8B", "compressed by gzip"},
                                           {"\xED\xA1\xDA\x01", "an LCM log"}}};
  for (const auto& [begin, name] : kSigns)
    if (text.starts_with(begin)) return name;
  return {};
}

/// "(time) interface id##flags data"
bool is_fd_line(std::string_view line) {
  const std::size_t id = line.find('#');
  return id != std::string_view::npos && id + 1 < line.size() && line[id + 1] == '#';
}

}  // namespace

std::optional<CanFrame> parse_candump_line(std::string_view line) {
  line = trim_end(line);
  if (line.empty() || line[0] != '(') return std::nullopt;
  line.remove_prefix(1);
  const auto time_word = cut(line, ')');
  const auto time = time_word ? number_from<double>(*time_word, std::chars_format::fixed) : std::nullopt;
  if (!time || !(std::abs(*time) < kLatest_s) || line.empty() || line[0] != ' ') return std::nullopt;
  line.remove_prefix(1);
  const auto interface = cut(line, ' ');
  const auto id = cut(line, '#');
  CanFrame frame;
  frame.t = *time;
  if (!interface || interface->empty() || !id || !read_id(*id, frame)) return std::nullopt;
  if (!line.empty() && line[0] == '#') return std::nullopt;  // CAN FD
  const bool remote = !line.empty() && line[0] == 'R';
  if (!(remote ? read_remote(line, frame) : read_logged_data(line, frame))) return std::nullopt;
  return frame;
}

std::string candump_line(const CanFrame& frame, std::string_view interface) {
  std::array<char, 16> text{};
  const bool wide = frame.extended || frame.error;
  const std::uint32_t id = frame.id | (frame.error ? kErrorFlag : 0U);
  std::string line = "(" + time_text(frame.t) + ") ";
  line += interface;
  int n = std::snprintf(text.data(), text.size(), wide ? " %08X#" : " %03X#", id);
  line.append(text.data(), static_cast<std::size_t>(n));
  if (frame.remote) return line + 'R' + (frame.length > 0 ? std::to_string(frame.length) : "");
  for (std::size_t i = 0; i < frame.length && i < frame.data.size(); ++i) {
    n = std::snprintf(text.data(), text.size(), "%02X", frame.data[i]);
    line.append(text.data(), static_cast<std::size_t>(n));
  }
  return line;
}

std::optional<CanFrame> CandumpReader::next() {
  while (!rest_.empty()) {
    const std::size_t end = rest_.find('\n');
    const bool whole = end != std::string_view::npos;
    const std::string_view line = rest_.substr(0, end);
    const std::size_t size = line.size() + (whole ? 1 : 0);
    rest_.remove_prefix(size);
    const auto frame = parse_candump_line(line);
    if (frame) {
      good_ += size;
      if (frame->t < last_t_) ++time_backwards_;
      last_t_ = frame->t;
      return frame;
    }
    if (whole) {
      skipped_ += size;
      if (is_fd_line(line)) ++fd_frame_;
      if (is_screen_line(line)) ++screen_line_;
      if (!line.empty() && line != "\r" && !is_fd_line(line)) ++bad_line_;
    } else {
      buffered_ = size;  // cut off in the middle of a line
      if (is_screen_line(line)) ++screen_line_;
    }
  }
  return std::nullopt;
}

std::optional<Error> CandumpReader::problem(const std::string& where) const {
  if (good_ > 0) return std::nullopt;
  const std::string remedy = "record with `candump -L can0 > FILE`, or `candump -l can0`";
  if (screen_line_ > 0)
    return Error{ErrorCode::format, "this is what candump prints on the screen, not its log", where, remedy};
  const std::string_view foreign = foreign_log(all_);
  if (foreign.empty()) return std::nullopt;
  return Error{ErrorCode::format, "this is " + std::string(foreign) + ", not a log of candump", where,
               remedy};
}

Counters CandumpReader::counters() const {
  return {{"bytes_in", bytes_in_},
          {"good", good_},
          {"skipped", skipped_},
          {"buffered", buffered_},
          {"bad_line", bad_line_},
          {"fd_frame", fd_frame_},
          {"time_backwards", time_backwards_}};
}

}  // namespace odomcalib::drivers
