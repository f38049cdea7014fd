#include "drivers/lidar/rplidar/packet.hpp"

#include <zlib.h>

#include <array>
#include <cmath>
#include <numbers>

namespace odomcalib::drivers::rplidar {
namespace {

constexpr std::array<PacketFormat, 6> kFormats = {{{PacketType::standard, "standard", 5, 1, 500e-6},
                                                   {PacketType::express, "express", 84, 32, 250e-6},
                                                   {PacketType::hq, "hq", 781, 96, 62.5e-6},
                                                   {PacketType::ultra, "ultra", 132, 96, 127e-6},
                                                   {PacketType::dense, "dense", 84, 40, 100e-6},
                                                   {PacketType::ultra_dense, "ultra_dense", 170, 64, 50e-6}}};

constexpr std::uint8_t kHqSync = 0xA5;
constexpr std::size_t kHqCrcBytes = 4;
constexpr double kAngleUnit = 1.0 / 64.0;         // degree
constexpr double kHqAngleUnit = 90.0 / 16'384.0;  // degree

double wrapped(double degrees) {
  const double rest = std::fmod(degrees, 360.0);
  return rest < 0.0 ? rest + 360.0 : rest;
}

std::uint32_t crc32_padded(Bytes bytes) {
  static constexpr std::array<std::uint8_t, 4> kZeros{};
  const std::size_t padding = (4 - bytes.size() % 4) % 4;
  const uLong crc = crc32(0, bytes.data(), static_cast<uInt>(bytes.size()));
  return static_cast<std::uint32_t>(crc32(crc, kZeros.data(), static_cast<uInt>(padding)));
}

bool standard_bits_fit(std::uint8_t b0, std::uint8_t b1) {
  return ((b0 & 1U) ^ ((b0 >> 1U) & 1U)) == 1 && (b1 & 1U) == 1;
}

bool capsule_checksum_fits(Bytes packet) {
  unsigned sum = 0;
  for (const std::uint8_t byte : packet.subspan(2)) sum ^= byte;
  return (packet[0] & 0x0FU) == (sum & 0x0FU) && (packet[1] & 0x0FU) == sum >> 4U;
}

std::uint16_t angle_word(PacketType type, Bytes capsule) {
  ByteReader reader(capsule);
  reader.take(type == PacketType::ultra_dense ? 8 : 2);
  return reader.u16();
}

/// Bytes of the capsule from its first distance on.
ByteReader distances(PacketType type, Bytes capsule) {
  ByteReader reader(capsule);
  reader.take(type == PacketType::ultra_dense ? 10 : 4);
  return reader;
}

/// A distance and what its beam deviates from the even grid.
struct Reading {
  double range_mm = 0.0;
  double correction = 0.0;  // degrees, to be subtracted
  unsigned quality = 0;
};

// Quality of capsules without one: the value that the manufacturer's software gives to every valid point.
constexpr unsigned kFixedQuality = 0x2F << 2;

Reading with_fixed_quality(double range_mm, double correction) {
  return {range_mm, correction, range_mm > 0.0 ? kFixedQuality : 0U};
}

std::vector<Reading> express_readings(ByteReader reader) {
  std::vector<Reading> out;
  for (int cabin = 0; cabin < 16; ++cabin) {
    const unsigned first = reader.u16(), second = reader.u16(), offsets = reader.u8();
    out.push_back(with_fixed_quality(first >> 2U, ((first & 3U) << 4U | (offsets & 15U)) / 8.0));
    out.push_back(with_fixed_quality(second >> 2U, ((second & 3U) << 4U | offsets >> 4U) / 8.0));
  }
  return out;
}

std::vector<Reading> dense_readings(ByteReader reader) {
  constexpr int kReadings = 40;
  std::vector<Reading> out;
  out.reserve(kReadings);
  for (int i = 0; i < kReadings; ++i) out.push_back(with_fixed_quality(reader.u16(), 0.0));
  return out;
}

/// Twenty bits: two of scale, then the distance, then the quality in what is left.
Reading ultra_dense_reading(unsigned value) {
  struct Scale {
    unsigned bits, factor, offset_mm;
  };
  static constexpr std::array<Scale, 4> kScales = {
      {{10, 2, 0}, {11, 3, 2046}, {12, 4, 8187}, {13, 5, 24567}}};
  const unsigned scale = value & 3U;
  const Scale& chosen = kScales[scale];
  const unsigned raw = (value >> 2U) & ((1U << chosen.bits) - 1U);
  const unsigned quality = (value >> (2U + chosen.bits)) << scale;
  return {static_cast<double>(raw * chosen.factor + chosen.offset_mm), 0.0, quality & 0xFFU};
}

std::vector<Reading> ultra_dense_readings(ByteReader reader) {
  std::vector<Reading> out;
  for (int cabin = 0; cabin < 32; ++cabin) {
    const unsigned a = reader.u16(), b = reader.u16(), high = reader.u8();
    out.push_back(ultra_dense_reading(a | (high & 15U) << 16U));
    out.push_back(ultra_dense_reading(b | (high >> 4U) << 16U));
  }
  return out;
}

/// A distance of 12 bits whose resolution falls with range.
struct Major {
  int range_mm = 0;
  int shift = 0;
};

Major expanded(unsigned value) {
  const int v = static_cast<int>(value);
  if (v >= 3328) return {16'384 + (v - 3328) * 16, 4};
  if (v >= 1792) return {4096 + (v - 1792) * 8, 3};
  if (v >= 1280) return {2048 + (v - 1280) * 4, 2};
  if (v >= 512) return {512 + (v - 512) * 2, 1};
  return {v, 0};
}

/// The emitter sits beside the receiver: near points lie at other angles. Degrees.
double ultra_correction(int range_mm) {
  constexpr double kUnit = 180.0 / std::numbers::pi / 65'536.0;  // degrees of 1/65536 rad
  if (range_mm < 50) return 7.5;
  const int k = 98'361 / (range_mm * 4);
  const int eight_degrees = static_cast<int>(8.0 * std::numbers::pi / 180.0 * 65'536.0);
  const int units = eight_degrees - 64 * k - k * k * k / 98'304;  // as the device's own arithmetic: whole
  return kUnit * units;
}

Reading ultra_reading(int range_mm) {
  const int range = range_mm > 0 ? range_mm : 0;
  return with_fixed_quality(range, ultra_correction(range));
}

/// A point given as difference to a base; the two extreme differences mean no reading.
Reading predicted(std::int64_t difference, const Major& base) {
  if (difference == -512 || difference == 511) return ultra_reading(0);
  return ultra_reading(static_cast<int>(difference) * (1 << base.shift) + base.range_mm);
}

std::vector<Reading> ultra_readings(ByteReader reader, ByteReader next) {
  constexpr std::size_t kCabins = 32;
  std::array<std::uint32_t, kCabins + 1> cabins{};
  for (std::size_t i = 0; i < kCabins; ++i) cabins[i] = reader.u32();
  cabins[kCabins] = next.u32();
  std::vector<Reading> out;
  for (std::size_t i = 0; i < kCabins; ++i) {
    const Major here = expanded(cabins[i] & 0xFFFU), after = expanded(cabins[i + 1] & 0xFFFU);
    const Major& base = here.range_mm == 0 && after.range_mm > 0 ? after : here;
    out.push_back(ultra_reading(here.range_mm));
    out.push_back(predicted(sign_extend(cabins[i] >> 12U, 10), base));
    out.push_back(predicted(sign_extend(cabins[i] >> 22U, 10), after));
  }
  return out;
}

std::vector<Reading> readings(PacketType type, Bytes capsule, Bytes next) {
  const ByteReader reader = distances(type, capsule);
  if (type == PacketType::express) return express_readings(reader);
  if (type == PacketType::dense) return dense_readings(reader);
  if (type == PacketType::ultra_dense) return ultra_dense_readings(reader);
  return ultra_readings(reader, distances(type, next));
}

std::vector<Point> hq_points(Bytes packet) {
  ByteReader reader(packet.subspan(9));
  std::vector<Point> out;
  for (int i = 0; i < 96; ++i) {
    const double angle = kHqAngleUnit * reader.u16();
    const double range_mm = reader.u32() / 4.0;
    const unsigned quality = reader.u8();
    out.push_back({wrapped(angle), range_mm, quality, (reader.u8() & 1U) != 0});
  }
  return out;
}

}  // namespace

const PacketFormat* find_format(unsigned type) {
  for (const PacketFormat& format : kFormats)
    if (static_cast<unsigned>(format.type) == type) return &format;
  return nullptr;
}

bool is_capsule(PacketType type) { return type != PacketType::standard && type != PacketType::hq; }

bool may_begin(PacketType type, Bytes rest) {
  if (rest.empty()) return true;
  if (type == PacketType::hq) return rest[0] == kHqSync;
  if (type == PacketType::standard) return standard_bits_fit(rest[0], rest.size() > 1 ? rest[1] : 1);
  return rest[0] >> 4U == 0xA && (rest.size() < 2 || rest[1] >> 4U == 0x5);
}

bool is_intact(PacketType type, Bytes packet) {
  if (!may_begin(type, packet)) return false;
  if (type == PacketType::standard) return (packet[1] >> 1U | packet[2] << 7U) < 360 * 64;
  if (type != PacketType::hq) return capsule_checksum_fits(packet);
  ByteReader reader(packet.last(kHqCrcBytes));
  return crc32_padded(packet.first(packet.size() - kHqCrcBytes)) == reader.u32();
}

double start_angle(PacketType type, Bytes capsule) {
  return wrapped((angle_word(type, capsule) & 0x7FFFU) * kAngleUnit);
}

bool begins_run(PacketType type, Bytes capsule) { return (angle_word(type, capsule) & 0x8000U) != 0; }

std::vector<Point> capsule_points(PacketType type, Bytes capsule, Bytes next, double span) {
  const std::vector<Reading> all = readings(type, capsule, next);
  const double step = span / static_cast<double>(all.size());
  std::vector<Point> out;
  double angle = start_angle(type, capsule);
  for (const Reading& reading : all) {
    const bool start = wrapped(angle + step) < step;
    out.push_back({wrapped(angle - reading.correction), reading.range_mm, reading.quality, start});
    angle = wrapped(angle + step);
  }
  return out;
}

std::vector<Point> own_points(PacketType type, Bytes packet) {
  if (type == PacketType::hq) return hq_points(packet);
  ByteReader reader(packet);
  const unsigned flags = reader.u8();
  const double angle = (reader.u16() >> 1U) * kAngleUnit;
  return {{angle, reader.u16() / 4.0, flags >> 2U, (flags & 1U) != 0}};
}

}  // namespace odomcalib::drivers::rplidar
