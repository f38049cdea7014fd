#include "drivers/lidar/xv11/packet.hpp"

#include "drivers/lidar/xv11/settings.hpp"

namespace odomcalib::drivers::xv11 {
namespace {

constexpr std::uint8_t kHeader = 0xFA, kFirstIndex = 0xA0;
constexpr std::size_t kSummed = 20;  // bytes under the checksum

bool may_begin(Bytes rest) {
  return rest[0] == kHeader &&
         (rest.size() < 2 || (rest[1] >= kFirstIndex && rest[1] < kFirstIndex + kPackets));
}

Reading read_reading(ByteReader& reader) {
  const unsigned word = reader.u16();
  const bool invalid = (word & 0x8000U) != 0;
  Reading reading;
  reading.weak = (word & 0x4000U) != 0;
  reading.range_mm = invalid ? 0 : word & 0x3FFFU;
  reading.error = invalid ? word & 0xFFU : 0;
  reading.strength = reader.u16();
  return reading;
}

Verdict look(Bytes rest, std::vector<Packet>& out) {
  if (!may_begin(rest)) return Verdict::noise();
  if (rest.size() < kPacketBytes) return Verdict::wait();
  ByteReader tail(rest.subspan(kSummed, 2));
  if (checksum(rest.first(kSummed)) != tail.u16()) return Verdict::reject("bad_checksum");
  ByteReader reader(rest.subspan(1));
  Packet packet;
  packet.index = reader.u8() - unsigned{kFirstIndex};
  packet.rpm = reader.u16() / 64.0;
  for (Reading& reading : packet.readings) reading = read_reading(reader);
  packet.bytes_after = rest.size() - kPacketBytes;
  if (packet.rpm <= 0.0) return Verdict::reject("motor_stopped", kPacketBytes);
  if (packet.rpm > kFastest_rpm) return Verdict::reject("bad_speed", kPacketBytes);
  out.push_back(packet);
  return Verdict::good(kPacketBytes);
}

}  // namespace

std::uint16_t checksum(Bytes bytes) {
  ByteReader reader(bytes);
  std::uint32_t sum = 0;
  while (reader.left() >= 2) sum = (sum << 1U) + reader.u16();
  return static_cast<std::uint16_t>(((sum & 0x7FFFU) + (sum >> 15U)) & 0x7FFFU);
}

std::vector<Packet> PacketFinder::on_bytes(Bytes bytes) {
  std::vector<Packet> out;
  frames_.feed(bytes, [&](Bytes rest) { return look(rest, out); });
  return out;
}

}  // namespace odomcalib::drivers::xv11
