// Process data: mapping, configuration by SDO, packing and unpacking.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/base/canopen/sdo_sequence.hpp"

namespace odomcalib::drivers::canopen {

struct PdoEntry {
  ObjectAddress object;
  std::uint8_t bits = 32;  ///< 8, 16, 24, 32 or 64
};

/// Bits of a COB-ID of process data (1400h ff., sub 1). Published: CiA 301.
inline constexpr std::uint32_t kPdoDisabled = 0x80000000, kPdoIdentifier = 0x7FF;

struct Pdo {
  bool transmit = true;      ///< by the drive
  std::uint16_t number = 1;  ///< 1..512: 1 is 1800h/1A00h or 1400h/1600h
  std::uint32_t cob_id = 0;
  std::uint8_t type = 255;
  std::optional<std::uint16_t> inhibit;      ///< raw, 100 us by the book
  std::optional<std::uint16_t> event_timer;  ///< raw, in the drive's unit
  std::vector<PdoEntry> entries;
};

/// Configuration order of CiA 301: disable, clear the mapping, map, set type and timers, enable, read all
/// back.
void add_pdo_configuration(std::vector<SdoStep>& steps, const Pdo& pdo);

/// CiA 402's predefined mapping of the first four PDOs of a single-axis drive; nullopt for other identifiers.
std::optional<Pdo> predefined_pdo(std::uint32_t cob_id);

/// Sum of the mapped bits in whole bytes.
std::size_t mapped_bytes(const Pdo& pdo);

/// The mapped object's raw number (unsigned); nullopt when it is not mapped or the frame ends before it does.
std::optional<std::uint64_t> unpack(const Pdo& pdo, const CanFrame& frame, const ObjectAddress& object);

/// Puts a number into the payload of a receive PDO; nothing happens when the object is not mapped in it.
void pack(const Pdo& pdo, CanFrame& frame, const ObjectAddress& object, std::uint64_t raw);

}  // namespace odomcalib::drivers::canopen
