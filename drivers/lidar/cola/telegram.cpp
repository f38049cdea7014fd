#include "drivers/lidar/cola/telegram.hpp"

#include <algorithm>

#include "drivers/lidar/cola/settings.hpp"

namespace odomcalib::drivers::cola {
namespace {

constexpr std::uint8_t kStx = 0x02, kEtx = 0x03;
constexpr std::size_t kMarkBytes = 4;  // STX four times begins a binary telegram
constexpr std::size_t kHeaderBytes = 8;

std::uint8_t xor_of(Bytes bytes) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : bytes) sum ^= byte;
  return sum;
}

bool is_letter(std::uint8_t c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

/// "sRA name arguments": false when it does not begin like this. "sFA" carries no name.
bool read_command(Dialect dialect, Bytes payload, Telegram& out) {
  const bool fits = payload.size() > 4 && payload[0] == 's' && is_letter(payload[1]) &&
                    is_letter(payload[2]) && payload[3] == ' ';
  if (!fits) return false;
  out.dialect = dialect;
  out.kind.assign(payload.begin(), payload.begin() + 3);
  Bytes rest = payload.subspan(4);
  if (out.kind != "sFA") {
    const auto blank = std::find(rest.begin(), rest.end(), std::uint8_t{' '});
    const auto length = static_cast<std::size_t>(blank - rest.begin());
    out.name.assign(rest.begin(), blank);
    rest = rest.subspan(std::min(length + 1, rest.size()));
  }
  out.arguments.assign(rest.begin(), rest.end());
  return true;
}

/// Nothing but a whole telegram is good; one that says nonsense is skipped as a whole.
Verdict take(Dialect dialect, Bytes payload, std::size_t size, std::vector<Telegram>& out) {
  Telegram telegram;
  if (!read_command(dialect, payload, telegram)) return Verdict::reject("bad_telegram", size);
  const bool scan = telegram.name == "LMDscandata" && (telegram.kind == "sSN" || telegram.kind == "sRA");
  if (scan) telegram.scan = read_scan_data(dialect, telegram.arguments);
  if (scan && !telegram.scan) return Verdict::reject("bad_scan", size);
  out.push_back(std::move(telegram));
  return Verdict::good(size);
}

Verdict look_binary(Bytes rest, std::vector<Telegram>& out) {
  if (rest.size() < kHeaderBytes) return Verdict::wait();
  ByteReader reader(rest.subspan(kMarkBytes));
  const std::uint64_t length = reader.big_endian(4);
  if (length == 0 || length > kMostBytes) return Verdict::reject("bad_length");
  // Told apart from a wrong length before so many bytes are waited for.
  if (rest.size() > kHeaderBytes && rest[kHeaderBytes] != 's') return Verdict::reject("bad_length");
  const std::size_t size = kHeaderBytes + length + 1;
  if (rest.size() < size) return Verdict::wait();
  const Bytes payload = rest.subspan(kHeaderBytes, length);
  if (xor_of(payload) != rest[size - 1]) return Verdict::reject("bad_checksum");
  return take(Dialect::binary, payload, size, out);
}

Verdict look_ascii(Bytes rest, std::vector<Telegram>& out) {
  const Bytes seen = rest.first(std::min(rest.size(), kMostBytes));
  const auto end = std::find_if(seen.begin() + 1, seen.end(),
                                [](std::uint8_t byte) { return byte == kStx || byte == kEtx; });
  const auto length = static_cast<std::size_t>(end - seen.begin());
  if (end == seen.end()) return length < kMostBytes ? Verdict::wait() : Verdict::reject("bad_length", length);
  if (*end == kStx) return Verdict::reject("cut_telegram", length);
  return take(Dialect::ascii, rest.subspan(1, length - 1), length + 1, out);
}

Verdict look(Bytes rest, std::vector<Telegram>& out) {
  if (rest[0] != kStx) return Verdict::noise();
  const Bytes mark = rest.first(std::min(rest.size(), kMarkBytes));
  const bool binary = std::all_of(mark.begin(), mark.end(), [](std::uint8_t b) { return b == kStx; });
  if (binary) return mark.size() < kMarkBytes ? Verdict::wait() : look_binary(rest, out);
  return rest[1] == kStx ? Verdict::noise() : look_ascii(rest, out);
}

}  // namespace

std::vector<Telegram> TelegramFinder::on_bytes(Bytes bytes) {
  std::vector<Telegram> out;
  frames_.feed(bytes, [&](Bytes rest) { return look(rest, out); });
  return out;
}

std::vector<std::uint8_t> encode(Dialect dialect, const std::string& command,
                                 std::optional<std::uint8_t> argument) {
  const bool ascii = dialect == Dialect::ascii;
  std::string payload = command;
  if (argument) payload += {' ', static_cast<char>(ascii ? '0' + *argument : *argument)};
  std::string out;
  if (ascii) {
    out = static_cast<char>(kStx) + payload + static_cast<char>(kEtx);
  } else {
    out.assign(kMarkBytes, static_cast<char>(kStx));
    for (const unsigned shift : {24U, 16U, 8U, 0U}) out += static_cast<char>(payload.size() >> shift);
    char sum = 0;
    for (const char byte : payload) sum = static_cast<char>(sum ^ byte);
    out += payload + sum;
  }
  return {out.begin(), out.end()};
}

}  // namespace odomcalib::drivers::cola
