#include "drivers/lidar/ld06/packet.hpp"

#include "drivers/bytes.hpp"

namespace odomcalib::drivers::ld06 {
namespace {

constexpr std::uint8_t kHeader = 0x54;
constexpr std::uint8_t kTypeAndCount = 0x2C;  // type 1, 12 points
constexpr unsigned kFullTurn_cdeg = 36'000;

consteval std::array<std::uint8_t, 256> make_table() {
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
bool may_begin(Bytes rest) { return rest[0] == kHeader && (rest.size() < 2 || rest[1] == kTypeAndCount); }

}  // namespace

std::uint8_t crc8(Bytes bytes) {
  std::uint8_t crc = 0;
  for (const std::uint8_t byte : bytes) crc = kCrcTable[crc ^ byte];
  return crc;
}

bool PacketFinder::span_fits(const Packet& packet) const {
  // Expected: 11 steps of one sample each at this speed; factor 2 leaves room for a motor that is being
  // regulated.
  const double expected_cdeg = 100.0 * packet.speed_deg_s * static_cast<double>(kPoints - 1) / points_per_s_;
  return packet.span_cdeg >= expected_cdeg / 2.0 && packet.span_cdeg <= expected_cdeg * 2.0;
}

/// Why a packet with the right checksum is not believed; nullptr when it is.
const char* PacketFinder::fault_of(const Packet& packet, unsigned end_cdeg) const {
  if (packet.start_cdeg >= kFullTurn_cdeg || end_cdeg >= kFullTurn_cdeg ||
      packet.stamp_ms >= kClockModulus_ms)
    return "bad_field";
  if (packet.speed_deg_s == 0) return "motor_stopped";
  return span_fits(packet) ? nullptr : "bad_span";
}

Verdict PacketFinder::look(Bytes rest, std::vector<Packet>& out) const {
  if (!may_begin(rest)) return Verdict::noise();
  if (rest.size() < kPacketBytes) return Verdict::wait();
  const Bytes bytes = rest.first(kPacketBytes);
  // After a wrong checksum go on at the next byte only: the next header may be inside.
  if (crc8(bytes.first(kPacketBytes - 1)) != bytes.back()) return Verdict::reject("bad_checksum");
  ByteReader reader(bytes.subspan(2));
  Packet packet;
  packet.speed_deg_s = reader.u16();
  packet.start_cdeg = reader.u16();
  for (Point& point : packet.points) point = {reader.u16(), reader.u8()};
  const unsigned end_cdeg = reader.u16();
  packet.stamp_ms = reader.u16();
  packet.span_cdeg = (end_cdeg + kFullTurn_cdeg - packet.start_cdeg) % kFullTurn_cdeg;
  packet.bytes_after = rest.size() - kPacketBytes;
  if (const char* fault = fault_of(packet, end_cdeg)) return Verdict::reject(fault, kPacketBytes);
  out.push_back(packet);
  return Verdict::good(kPacketBytes);
}

std::vector<Packet> PacketFinder::on_bytes(Bytes bytes) {
  std::vector<Packet> out;
  frames_.feed(bytes, [&](Bytes rest) { return look(rest, out); });
  return out;
}

}  // namespace odomcalib::drivers::ld06
