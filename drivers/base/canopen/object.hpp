// Addresses and raw values of CANopen objects.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace odomcalib::drivers::canopen {

struct ObjectAddress {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  friend bool operator==(const ObjectAddress&, const ObjectAddress&) = default;
};

/// "6064:01"
std::string to_text(const ObjectAddress& object);

/// Number type of an object: how many bytes it has and whether it is signed.
struct NumberType {
  std::uint8_t bytes = 4;  ///< 1, 2, 4 or 8
  bool is_signed = false;
  friend bool operator==(const NumberType&, const NumberType&) = default;
};

std::vector<std::uint8_t> encode(std::int64_t value, NumberType type);
/// @param bytes little-endian, at most 8 are used
std::int64_t decode(const std::vector<std::uint8_t>& bytes, NumberType type);
/// Whether value can be represented without loss.
bool fits(std::int64_t value, NumberType type);

}  // namespace odomcalib::drivers::canopen
