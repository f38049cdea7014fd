#include "drivers/base/canopen/pdo.hpp"

#include <array>

#include "drivers/bytes.hpp"

namespace odomcalib::drivers::canopen {
namespace {

constexpr NumberType kU8{1, false};
constexpr NumberType kU16{2, false};
constexpr NumberType kU32{4, false};

std::optional<std::size_t> offset_of(const Pdo& pdo, const ObjectAddress& object, std::size_t& bytes) {
  std::size_t offset = 0;
  for (const PdoEntry& entry : pdo.entries) {
    bytes = entry.bits / 8u;
    if (entry.object == object) return offset;
    offset += bytes;
  }
  return std::nullopt;
}

void add_mapping(std::vector<SdoStep>& steps, const Pdo& pdo, std::uint16_t mapping) {
  steps.push_back({SdoStep::Kind::write, {mapping, 0}, kU8, 0, false, kSdoTimeout_s, ""});
  std::uint8_t sub = 0;
  for (const PdoEntry& entry : pdo.entries) {
    const std::int64_t value = std::int64_t{entry.object.index} << 16 | entry.object.sub << 8 | entry.bits;
    add_checked_write(steps, {mapping, ++sub}, kU32, value);
  }
  add_checked_write(steps, {mapping, 0}, kU8, sub);
}

}  // namespace

void add_pdo_configuration(std::vector<SdoStep>& steps, const Pdo& pdo) {
  const auto offset = static_cast<std::uint16_t>(pdo.number - 1);
  const auto communication = static_cast<std::uint16_t>((pdo.transmit ? 0x1800 : 0x1400) + offset);
  const auto mapping = static_cast<std::uint16_t>((pdo.transmit ? 0x1A00 : 0x1600) + offset);
  steps.push_back({SdoStep::Kind::write,
                   {communication, 1},
                   kU32,
                   std::int64_t{pdo.cob_id | kPdoDisabled},
                   false,
                   kSdoTimeout_s,
                   ""});
  add_mapping(steps, pdo, mapping);
  add_checked_write(steps, {communication, 2}, kU8, pdo.type);
  if (pdo.inhibit) add_checked_write(steps, {communication, 3}, kU16, *pdo.inhibit);
  if (pdo.event_timer) add_checked_write(steps, {communication, 5}, kU16, *pdo.event_timer);
  add_checked_write(steps, {communication, 1}, kU32, pdo.cob_id);
}

// CiA 402-3, default mappings: each begins with the status or control word.
std::optional<Pdo> predefined_pdo(std::uint32_t cob_id) {
  const std::uint32_t function = cob_id & 0x780;
  if (function < 0x180 || function > 0x500 || (cob_id & 0x7F) == 0) return std::nullopt;
  Pdo pdo;
  pdo.cob_id = cob_id;
  pdo.transmit = (function & 0x080) != 0;
  pdo.number = static_cast<std::uint16_t>((function - (pdo.transmit ? 0x080u : 0x100u)) / 0x100u);
  pdo.entries.push_back({{static_cast<std::uint16_t>(pdo.transmit ? 0x6041 : 0x6040), 0}, 16});
  const std::array<PdoEntry, 3> second =
      pdo.transmit ? std::array<PdoEntry, 3>{{{{0x6061, 0}, 8}, {{0x6064, 0}, 32}, {{0x606C, 0}, 32}}}
                   : std::array<PdoEntry, 3>{{{{0x6060, 0}, 8}, {{0x607A, 0}, 32}, {{0x60FF, 0}, 32}}};
  if (pdo.number > 1) pdo.entries.push_back(second[pdo.number - 2u]);
  return pdo;
}

std::size_t mapped_bytes(const Pdo& pdo) {
  std::size_t bits = 0;
  for (const PdoEntry& entry : pdo.entries) bits += entry.bits;
  return bits / 8;
}

std::optional<std::uint64_t> unpack(const Pdo& pdo, const CanFrame& frame, const ObjectAddress& object) {
  std::size_t bytes = 0;
  const auto offset = offset_of(pdo, object, bytes);
  if (!offset || frame.length > 8) return std::nullopt;
  ByteReader reader(Bytes(frame.data).first(frame.length));
  reader.take(*offset);
  const std::uint64_t value = reader.number(bytes);
  return reader.ok() ? std::optional(value) : std::nullopt;
}

void pack(const Pdo& pdo, CanFrame& frame, const ObjectAddress& object, std::uint64_t raw) {
  std::size_t bytes = 0;
  const auto offset = offset_of(pdo, object, bytes);
  if (!offset || *offset + bytes > frame.data.size()) return;
  for (std::size_t i = 0; i < bytes; ++i) frame.data[*offset + i] = static_cast<std::uint8_t>(raw >> (8 * i));
}

}  // namespace odomcalib::drivers::canopen
