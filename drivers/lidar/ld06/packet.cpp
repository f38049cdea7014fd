#include "drivers/lidar/ld06/packet.hpp"

#include "drivers/bytes.hpp"

namespace odomcalib::drivers::ld06 {
namespace {

constexpr std::uint8_t kHeader = 0x54;
constexpr std::uint8_t kTypeAndCount = 0x2C;  // type 1, 12 points
constexpr unsigned kFullTurn_cdeg = 36'000;

constexpr std::array<std::uint8_t, 256> make_table() {
  std::array<std::uint8_t, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value & 0x80) != 0 ? (value << 1) ^ 0x4D : value << 1;
    table[i] = static_cast<std::uint8_t>(value);
  }
  return table;
}
constexpr auto kCrcTable = make_table();

/// Whether these bytes can be the beginning of a packet.
bool may_begin(std::span<const std::uint8_t> rest) {
  return rest[0] == kHeader && (rest.size() < 2 || rest[1] == kTypeAndCount);
}

}  // namespace

std::uint8_t crc8(std::span<const std::uint8_t> bytes) {
  std::uint8_t crc = 0;
  for (const std::uint8_t byte : bytes) crc = kCrcTable[crc ^ byte];
  return crc;
}

void PacketFinder::reset() {
  skipped_ += buffer_.size();
  buffer_.clear();
}

bool PacketFinder::span_fits(const Packet& packet) const {
  // Expected: 11 steps of one sample each at this speed; factor 2 leaves room for a motor that is being
  // regulated.
  const double expected_cdeg = 100.0 * packet.speed_deg_s * static_cast<double>(kPoints - 1) / points_per_s_;
  return packet.span_cdeg >= expected_cdeg / 2.0 && packet.span_cdeg <= expected_cdeg * 2.0;
}

std::optional<Packet> PacketFinder::accept(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes.subspan(2));
  Packet packet;
  packet.speed_deg_s = reader.u16();
  packet.start_cdeg = reader.u16();
  for (Point& point : packet.points) point = {reader.u16(), reader.u8()};
  const unsigned end_cdeg = reader.u16();
  packet.stamp_ms = reader.u16();
  if (!reader.ok() || packet.start_cdeg >= kFullTurn_cdeg || end_cdeg >= kFullTurn_cdeg ||
      packet.stamp_ms >= kClockModulus_ms)
    return ++bad_field_, std::nullopt;
  if (packet.speed_deg_s == 0) return ++motor_stopped_, std::nullopt;
  packet.span_cdeg = (end_cdeg + kFullTurn_cdeg - packet.start_cdeg) % kFullTurn_cdeg;
  if (!span_fits(packet)) return ++bad_span_, std::nullopt;
  return packet;
}

/// Consumes one packet or skips one byte; false when more bytes are needed.
bool PacketFinder::step(std::span<const std::uint8_t> rest, std::size_t& used, std::vector<Packet>& out) {
  if (rest.empty()) return false;
  if (!may_begin(rest)) return ++skipped_, ++used, true;
  if (rest.size() < kPacketBytes) return false;
  const auto bytes = rest.first(kPacketBytes);
  if (crc8(bytes.first(kPacketBytes - 1)) != bytes.back()) {
    // The next header may be inside: go on at the next byte only.
    return ++bad_checksum_, ++skipped_, ++used, true;
  }
  used += kPacketBytes;
  auto packet = accept(bytes);
  if (!packet) return skipped_ += kPacketBytes, true;
  good_ += kPacketBytes;
  ++packets_;
  packet->bytes_after = rest.size() - kPacketBytes;
  out.push_back(*packet);
  return true;
}

std::vector<Packet> PacketFinder::on_bytes(std::span<const std::uint8_t> bytes) {
  bytes_in_ += bytes.size();
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  const std::span<const std::uint8_t> all(buffer_);
  std::vector<Packet> out;
  std::size_t used = 0;
  while (step(all.subspan(used), used, out)) {
  }
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(used));
  return out;
}

Counters PacketFinder::counters() const {
  return {{"bytes_in", bytes_in_},      {"good", good_},         {"skipped", skipped_},
          {"buffered", buffer_.size()}, {"packets", packets_},   {"bad_checksum", bad_checksum_},
          {"bad_field", bad_field_},    {"bad_span", bad_span_}, {"motor_stopped", motor_stopped_}};
}

}  // namespace odomcalib::drivers::ld06
