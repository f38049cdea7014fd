#include "drivers/base/arcos/packet.hpp"

#include <algorithm>
#include <cstdlib>

#include "drivers/wire_table.hpp"

namespace odomcalib::drivers::arcos {
namespace {

constexpr std::uint8_t kFirst = 0xFA, kSecond = 0xFB;
constexpr std::size_t kHead = 3, kChecksum = 2;
constexpr std::size_t kPart = kHead + 255;  // of a read at a time, so that the buffer stays small
constexpr std::uint8_t kPositive = 0x3B, kNegative = 0x1B;

}  // namespace

std::uint16_t checksum(Bytes data) {
  std::uint64_t sum = 0;
  ByteReader reader(data);
  while (reader.left() > 1) sum = (sum + reader.big_endian(2)) & 0xFFFF;
  if (reader.left() == 1) sum ^= reader.u8();
  return static_cast<std::uint16_t>(sum);
}

std::vector<std::uint8_t> framed(Bytes data) {
  std::vector<std::uint8_t> out(kHead + data.size() + kChecksum);
  out[0] = kFirst;
  out[1] = kSecond;
  out[2] = static_cast<std::uint8_t>(data.size() + kChecksum);
  for (std::size_t i = 0; i < data.size(); ++i) out[kHead + i] = data[i];
  put_number(out, kHead + data.size(), kChecksum, checksum(data), Endian::big);
  return out;
}

std::vector<std::uint8_t> command(std::uint8_t number) { return framed(std::array<std::uint8_t, 1>{number}); }

std::vector<std::uint8_t> command(std::uint8_t number, int argument) {
  const auto magnitude = static_cast<unsigned>(std::min(std::abs(argument), 0xFFFF));
  return framed(std::array<std::uint8_t, 4>{number, argument < 0 ? kNegative : kPositive,
                                            static_cast<std::uint8_t>(magnitude),
                                            static_cast<std::uint8_t>(magnitude >> 8)});
}

void PacketFinder::reset() {
  skipped_ += buffer_.size();
  buffer_.clear();
}

/// One byte is no beginning of a packet; always true, so that the search goes on.
bool PacketFinder::skip(std::uint64_t* counter) {
  if (counter != nullptr) ++*counter;
  buffer_.erase(buffer_.begin());
  ++skipped_;
  return true;
}

/// False when more bytes are needed.
bool PacketFinder::step(std::vector<Packet>& out) {
  if (buffer_.empty()) return false;
  if (buffer_[0] != kFirst) return skip(nullptr);
  if (buffer_.size() > 1 && buffer_[1] != kSecond) return skip(nullptr);
  if (buffer_.size() < kHead) return false;
  const std::size_t length = buffer_[2];
  if (length <= kChecksum) return skip(&bad_length_);
  const std::size_t whole = kHead + length;
  if (buffer_.size() < whole) return false;
  const Bytes data = Bytes(buffer_).subspan(kHead, length - kChecksum);
  ByteReader end(Bytes(buffer_).subspan(whole - kChecksum, kChecksum));
  if (end.big_endian(kChecksum) != checksum(data)) return skip(&bad_checksum_);
  ++packets_;
  good_ += whole;
  out.push_back({{data.begin(), data.end()}, buffer_.size() - whole});
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(whole));
  return true;
}

std::vector<Packet> PacketFinder::on_bytes(std::span<const std::uint8_t> bytes) {
  std::vector<Packet> out;
  bytes_in_ += bytes.size();
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(bytes.size(), kPart));
    bytes = bytes.subspan(part.size());
    buffer_.insert(buffer_.end(), part.begin(), part.end());
    const std::size_t before = out.size();
    while (step(out)) {
    }
    for (std::size_t i = before; i < out.size(); ++i) out[i].bytes_after += bytes.size();
  }
  return out;
}

Counters PacketFinder::counters() const {
  return {{"bytes_in", bytes_in_},      {"good", good_},       {"skipped", skipped_},
          {"buffered", buffer_.size()}, {"packets", packets_}, {"bad_checksum", bad_checksum_},
          {"bad_length", bad_length_}};
}

}  // namespace odomcalib::drivers::arcos
