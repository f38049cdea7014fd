#include "tests/sim/wires/slcan_adapter.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace odomcalib::sim {

namespace {

constexpr char kDone = '\r', kRefused = '\a';
constexpr std::size_t kLongestLine = 64;
constexpr std::array<unsigned, 9> kBitrates{10'000,  20'000,  50'000,  100'000,  125'000,
                                            250'000, 500'000, 800'000, 1'000'000};

std::optional<std::uint32_t> hex(std::string_view digits) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty()) return std::nullopt;
  return value;
}

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 32> text{};
  const int length = std::snprintf(text.data(), text.size(), pattern, values...);
  return {text.data(), static_cast<std::size_t>(length)};
}

}  // namespace

std::string slcan_line(const Frame& frame) {
  std::string line = frame.extended ? format("T%08X", frame.id) : format("t%03X", frame.id);
  if (frame.remote) line[0] = frame.extended ? 'R' : 'r';
  line += format("%u", static_cast<unsigned>(frame.length));
  for (unsigned i = 0; i < frame.length && !frame.remote; ++i)
    line += format("%02X", static_cast<unsigned>(frame.data[i]));
  return line;
}

std::optional<Frame> frame_from_slcan(std::string_view line) {
  Frame frame;
  if (line.empty()) return std::nullopt;
  frame.extended = line[0] == 'T' || line[0] == 'R';
  frame.remote = line[0] == 'r' || line[0] == 'R';
  const std::size_t id_digits = frame.extended ? 8 : 3;
  if (line.size() < 2 + id_digits) return std::nullopt;
  const auto id = hex(line.substr(1, id_digits));
  const auto length = hex(line.substr(1 + id_digits, 1));
  if (!id || !length || *length > 8 || *id > (frame.extended ? 0x1FFFFFFFU : 0x7FFU)) return std::nullopt;
  frame.id = *id;
  frame.length = static_cast<std::uint8_t>(*length);
  const std::string_view data = line.substr(2 + id_digits);
  const std::size_t digits = frame.remote ? 0 : 2 * std::size_t{frame.length};
  if (data.size() != digits) return std::nullopt;
  for (std::size_t i = 0; i < digits / 2; ++i) {
    const auto byte = hex(data.substr(2 * i, 2));
    if (!byte) return std::nullopt;
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return frame;
}

void SlcanAdapter::reset() {
  open_ = listen_only_ = stamps_ = false;
  bitrate_ = 0;
  line_.clear();
  output_.clear();
  frames_.clear();
}

void SlcanAdapter::from_host(std::string_view bytes) {
  for (const char byte : bytes) {
    if (byte == '\r') {
      on_line(line_);
      line_.clear();
    } else if (byte != '\n' && line_.size() < kLongestLine) {
      line_ += byte;
    }
  }
}

void SlcanAdapter::on_line(const std::string& line) {
  if (line.empty()) {
    output_ += kDone;
    return;
  }
  const bool sends = std::string_view("tTrR").find(line[0]) != std::string_view::npos;
  const bool accepted = sends ? transmit(line) : command(line);
  output_ += accepted ? kDone : kRefused;
}

bool SlcanAdapter::transmit(const std::string& line) {
  const auto frame = frame_from_slcan(line);
  if (!frame || !open_ || listen_only_) return false;
  if (hears_bus()) frames_.push_back(*frame);
  return true;
}

bool SlcanAdapter::command(const std::string& line) {
  const char digit = line.size() == 2 ? line[1] : '\0';
  switch (line[0]) {
    case 'S':
      if (open_ || digit < '0' || digit > '8') return false;
      bitrate_ = kBitrates[static_cast<std::size_t>(digit - '0')];
      return true;
    case 'O':
    case 'L':
      if (open_ || bitrate_ == 0) return false;
      open_ = true;
      listen_only_ = line[0] == 'L';
      return true;
    case 'C':
      if (!open_) return false;
      open_ = false;
      return true;
    case 'V':
      output_ += "V0101";
      return true;
    case 'v':
      output_ += "v0101";
      return true;
    case 'N':
      output_ += "N0815";
      return true;
    case 'F':
      if (!open_) return false;
      output_ += "F00";
      return true;
    case 'Z':
      if (open_ || (digit != '0' && digit != '1')) return false;
      stamps_ = digit == '1';
      return true;
    default:
      return false;
  }
}

void SlcanAdapter::from_bus(const Frame& frame, double now) {
  if (!hears_bus()) return;
  output_ += slcan_line(frame);
  if (stamps_) {
    const auto milliseconds = static_cast<unsigned>(std::fmod(std::floor(now * 1000.0), 60'000.0));
    output_ += format("%04X", milliseconds);
  }
  output_ += kDone;
}

std::string SlcanAdapter::take_output() {
  std::string out;
  out.swap(output_);
  return out;
}

std::vector<Frame> SlcanAdapter::take_frames() {
  std::vector<Frame> out;
  out.swap(frames_);
  return out;
}

}  // namespace odomcalib::sim
