// Messages with fixed layouts, described once: one table serves the parser, the printer and the tests.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/bytes.hpp"

namespace odomcalib::drivers {

enum class Endian { little, big };
enum class WireType { u8, i8, u16, i16, u32, i32, f32 };

struct WireField {
  std::string_view name;
  std::size_t offset = 0;  ///< bytes from the beginning of the data
  WireType type = WireType::u8;
  double per_unit = 1.0;  ///< value in the unit that the name says = raw / per_unit
};

struct WireMessage {
  std::uint32_t id = 0;  ///< what tells it from the others: a CAN identifier, a command number
  std::string_view name;
  std::vector<WireField> fields;
  /// Bytes that the fields need; longer data are taken, shorter are not.
  [[nodiscard]] std::size_t length() const;
};

std::size_t size_of(WireType type);
const WireMessage* find_message(const std::vector<WireMessage>& table, std::uint32_t id);

/// A number or a text that a device told, for people and for `odomcalibctl decode`.
struct MessageField {
  std::string name;
  double number = 0.0;
  std::string text;  ///< instead of the number when not empty
};

struct DeviceMessage {
  double t = 0.0;
  std::string name;
  std::vector<MessageField> fields;
  /// Zero for fields that it does not have.
  [[nodiscard]] double number(std::string_view field) const;
};

/// nullopt when the data are shorter than the message, or a float in them is not finite.
std::optional<DeviceMessage> read_message(const WireMessage& layout, Bytes data, Endian endian, double t);

/// Puts a raw number of `bytes` bytes into data at offset; what does not fit is left out.
void put_number(std::span<std::uint8_t> data, std::size_t offset, std::size_t bytes, std::uint64_t raw,
                Endian endian);

}  // namespace odomcalib::drivers
