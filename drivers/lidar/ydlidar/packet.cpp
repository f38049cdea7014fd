#include "drivers/lidar/ydlidar/packet.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/lidar/ydlidar/settings.hpp"

namespace odomcalib::drivers::ydlidar {
namespace {

constexpr std::size_t kHeaderBytes = 10;
constexpr std::size_t kDescriptorBytes = 7;
constexpr std::uint8_t kScanType = 0x81;
constexpr std::size_t kNameBytes = 20;
constexpr double kFullTurn = 360.0 * 64.0;

/// Emitter and receiver stand 21.8 mm apart; near points are seen at another angle. Degrees.
double parallax(double range_mm) {
  if (range_mm <= 0.0) return 0.0;
  return std::atan(21.8 * (155.3 - range_mm) / (155.3 * range_mm)) * 180.0 / std::numbers::pi;
}

double wrapped(double degrees) {
  const double rest = std::fmod(degrees, 360.0);
  return rest < 0.0 ? rest + 360.0 : rest;
}

struct Header {
  unsigned type_and_speed = 0, count = 0, start = 0, end = 0, checksum = 0;
};

Header read_header(Bytes bytes) {
  ByteReader reader(bytes);
  reader.take(2);
  Header header;
  header.type_and_speed = reader.u8();
  header.count = reader.u8();
  header.start = reader.u16();
  header.end = reader.u16();
  header.checksum = reader.u16();
  return header;
}

unsigned checksum_of(const Header& header, ByteReader samples, std::size_t sample_bytes) {
  unsigned sum = 0x55AAU ^ header.start ^ header.end ^ (header.count << 8U | header.type_and_speed);
  while (samples.left() > 0) {
    if (sample_bytes == 3) sum ^= samples.u8();
    sum ^= samples.u16();
  }
  return sum;
}

Sample read_sample(ByteReader& reader, const Model& model) {
  Sample sample;
  if (model.intensity_bits == 0) {
    sample.range_mm = model.mm_per_count * reader.u16();
    return sample;
  }
  // Two bits of the distance word belong to the intensity.
  const unsigned first = reader.u8(), word = reader.u16();
  sample.range_mm = model.mm_per_count * (word >> 2U);
  sample.intensity = model.intensity_bits == 10 ? (word & 3U) << 8U | first : first;
  return sample;
}

bool is_intact(Bytes rest, const Header& header, std::size_t sample_bytes) {
  const ByteReader samples(rest.subspan(kHeaderBytes, header.count * sample_bytes));
  return checksum_of(header, samples, sample_bytes) == header.checksum;
}

/// The descriptor with which a COIN-D4 tells its name: 16 bits of length, type 1.
bool is_name(std::uint32_t word, std::uint8_t type) {
  return type == kNameType && (word & 0xFFFFU) == kNameBytes;
}

}  // namespace

const std::vector<Model>& models() {
  // Baud and samples a second as commonly stated for these models; not checked on devices. Units of the range
  // and the parallax: the vendor's SDK, which halves the counts of the G6 and G7, takes those of
  // time-of-flight models as millimetres and adds no parallax to them, nor to the Tmini. In three bytes all
  // have millimetres.
  static const std::vector<Model> kModels = {
      {"x2", 115'200, 3000, 0, 0.25, true, false},       {"x3", 115'200, 3000, 0, 0.25, true, false},
      {"s2", 115'200, 3000, 0, 0.25, true, false},       {"x4", 128'000, 5000, 0, 0.25, true, true},
      {"x4pro", 128'000, 5000, 0, 0.25, true, false},    {"r2", 230'400, 5000, 0, 0.25, true, true},
      {"f4pro", 230'400, 6000, 0, 0.25, true, true},     {"g1", 230'400, 9000, 0, 0.25, true, true},
      {"g2a", 230'400, 5000, 0, 0.25, true, true},       {"g2", 230'400, 5000, 8, 1.0, true, true},
      {"g4", 230'400, 9000, 0, 0.25, true, true},        {"g4b", 512'000, 9000, 10, 1.0, true, true},
      {"g6", 512'000, 18'000, 0, 0.5, true, true},       {"g7", 512'000, 18'000, 0, 0.5, true, true},
      {"s4", 115'200, 4000, 0, 0.25, true, true},        {"tminipro", 230'400, 4000, 8, 1.0, false, true},
      {"tminiplus", 230'400, 4000, 8, 1.0, false, true}, {"tg15", 512'000, 20'000, 0, 1.0, false, true},
      {"tg30", 512'000, 20'000, 0, 1.0, false, true},    {"tg50", 512'000, 20'000, 0, 1.0, false, true},
      {"tg-old", 512'000, 20'000, 0, 0.5, false, true},  // TG15, TG30, TG50 with firmware up to 1.2
      {"coin-d4", 230'400, 5000, 8, 1.0, false, false},
  };
  return kModels;
}

const Model* find_model(const std::string& name) {
  for (const Model& model : models())
    if (name == model.name) return &model;
  return nullptr;
}

const Model* model_that_says(const std::string& reported) {
  std::string name = reported;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return find_model(name);
}

Verdict PacketFinder::take_answer(Bytes rest, std::vector<Item>& out) const {
  if (rest.size() < kDescriptorBytes) return Verdict::wait();
  ByteReader reader(rest.subspan(2));
  const std::uint32_t word = reader.u32();
  const std::uint8_t type = reader.u8();
  const std::size_t length = word & 0x3FFFFFFFU;
  if (is_name(word, type)) {
    if (rest.size() < kDescriptorBytes + kNameBytes) return Verdict::wait();
    const Bytes name = rest.subspan(kDescriptorBytes, kNameBytes);
    out.push_back({std::nullopt, {type, {name.begin(), name.end()}}});
    return Verdict::good(kDescriptorBytes + kNameBytes);
  }
  const bool endless = word >> 30U != 0;
  if (endless != (type == kScanType) || (!endless && (length == 0 || length > kMostAnswerBytes)))
    return Verdict::reject("bad_answer");
  const std::size_t payload = endless ? 0 : length;
  if (rest.size() < kDescriptorBytes + payload) return Verdict::wait();
  const Bytes bytes = rest.subspan(kDescriptorBytes, payload);
  out.push_back({std::nullopt, {type, {bytes.begin(), bytes.end()}}});
  return Verdict::good(kDescriptorBytes + payload);
}

Verdict PacketFinder::take_packet(Bytes rest, std::vector<Item>& out) {
  if (rest.size() < kHeaderBytes) return Verdict::wait();
  const Header header = read_header(rest);
  if (header.count == 0 || header.count > kMostSamples) return Verdict::reject("bad_count");
  if ((header.start & header.end & 1U) == 0) return Verdict::reject("bad_check_bit");
  if (header.start >> 1U > kFullTurn || header.end >> 1U > kFullTurn) return Verdict::reject("bad_angle");
  const std::size_t sample_bytes = model_.sample_bytes();
  const std::size_t size = kHeaderBytes + header.count * sample_bytes;
  if (rest.size() < size) return Verdict::wait();
  if (!is_intact(rest, header, sample_bytes)) {
    const std::size_t other = 5 - sample_bytes;  // 2 or 3
    if (rest.size() >= kHeaderBytes + header.count * other && is_intact(rest, header, other)) ++other_kind_;
    return Verdict::reject("bad_checksum");
  }
  ByteReader samples(rest.subspan(kHeaderBytes, size - kHeaderBytes));

  Packet packet;
  packet.zero = (header.type_and_speed & 1U) != 0;
  packet.turn_hz = packet.zero ? 0.1 * (header.type_and_speed >> 1U) : 0.0;
  packet.start = (header.start >> 1U) / 64.0;
  packet.end = (header.end >> 1U) / 64.0;
  packet.bytes_after = rest.size() - size;
  packet.size = size;
  const double span = wrapped(packet.end - packet.start);
  const double step = header.count > 1 ? span / (header.count - 1) : 0.0;
  for (unsigned i = 0; i < header.count; ++i) {
    Sample sample = read_sample(samples, model_);
    sample.clockwise = wrapped(packet.start + step * i + (model_.parallax ? parallax(sample.range_mm) : 0.0));
    packet.samples.push_back(sample);
  }
  ++packets_;
  out.push_back({std::move(packet), {}});
  return Verdict::good(size);
}

Verdict PacketFinder::look(Bytes rest, std::vector<Item>& out) {
  const bool two = rest.size() > 1;
  if (rest[0] == 0xA5 && (!two || rest[1] == 0x5A)) return take_answer(rest, out);
  if (rest[0] == 0xAA && (!two || rest[1] == 0x55)) return take_packet(rest, out);
  return Verdict::noise();
}

std::vector<Item> PacketFinder::on_bytes(Bytes bytes) {
  std::vector<Item> out;
  frames_.feed(bytes, [&](Bytes rest) { return look(rest, out); });
  return out;
}

}  // namespace odomcalib::drivers::ydlidar
