#include "drivers/wire_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace odomcalib::drivers {
namespace {

bool is_signed(WireType type) {
  return type == WireType::i8 || type == WireType::i16 || type == WireType::i32;
}

std::optional<double> read_field(const WireField& field, Bytes data, Endian endian) {
  ByteReader reader(data);
  reader.take(field.offset);
  const std::size_t bytes = size_of(field.type);
  const std::uint64_t raw = endian == Endian::big ? reader.big_endian(bytes) : reader.number(bytes);
  if (!reader.ok()) return std::nullopt;
  if (field.type == WireType::f32) {
    const double value = std::bit_cast<float>(static_cast<std::uint32_t>(raw));
    return std::isfinite(value) ? std::optional(value / field.per_unit) : std::nullopt;
  }
  const double number = is_signed(field.type)
                            ? static_cast<double>(sign_extend(raw, static_cast<unsigned>(8 * bytes)))
                            : static_cast<double>(raw);
  return number / field.per_unit;
}

}  // namespace

std::size_t size_of(WireType type) {
  switch (type) {
    case WireType::u8:
    case WireType::i8:
      return 1;
    case WireType::u16:
    case WireType::i16:
      return 2;
    case WireType::u32:
    case WireType::i32:
    case WireType::f32:
      return 4;
  }
  return 4;
}

std::size_t WireMessage::length() const {
  std::size_t end = 0;
  for (const WireField& field : fields) end = std::max(end, field.offset + size_of(field.type));
  return end;
}

const WireMessage* find_message(const std::vector<WireMessage>& table, std::uint32_t id) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const auto& m) { return m.id == id; });
  return found == table.end() ? nullptr : &*found;
}

double DeviceMessage::number(std::string_view field) const {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.name == field; });
  return found == fields.end() ? 0.0 : found->number;
}

std::optional<DeviceMessage> read_message(const WireMessage& layout, Bytes data, Endian endian, double t) {
  DeviceMessage message{t, std::string(layout.name), {}};
  for (const WireField& field : layout.fields) {
    const auto value = read_field(field, data, endian);
    if (!value) return std::nullopt;
    message.fields.push_back({std::string(field.name), *value, {}});
  }
  return message;
}

void put_number(std::span<std::uint8_t> data, std::size_t offset, std::size_t bytes, std::uint64_t raw,
                Endian endian) {
  if (offset + bytes > data.size()) return;
  for (std::size_t i = 0; i < bytes; ++i) {
    const std::size_t place = endian == Endian::big ? bytes - 1 - i : i;
    data[offset + place] = static_cast<std::uint8_t>(raw >> (8 * i));
  }
}

}  // namespace odomcalib::drivers
