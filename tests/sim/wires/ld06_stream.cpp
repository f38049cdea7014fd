#include "tests/sim/wires/ld06_stream.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odomcalib::sim {

namespace {

constexpr std::size_t kPoints = 12;
constexpr double kBytesPerSecond = 230'400.0 / 10.0;
constexpr double kProcessing = 0.0003;  // s between the last echo and the first byte
constexpr double kSpinUp = 0.2;         // s after power-on without valid angles

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

void put_u16(std::vector<std::uint8_t>& out, double value) {
  const auto word = static_cast<std::uint16_t>(std::llround(value));
  out.push_back(static_cast<std::uint8_t>(word & 0xFFU));
  out.push_back(static_cast<std::uint8_t>(word >> 8U));
}

}  // namespace

std::uint8_t ld06_checksum(std::span<const std::uint8_t> bytes) {
  unsigned remainder = 0;
  for (const std::uint8_t byte : bytes) {
    remainder ^= byte;
    for (int bit = 0; bit < 8; ++bit)
      remainder = (remainder << 1U) ^ ((remainder & 0x80U) != 0 ? 0x14DU : 0U);
  }
  return static_cast<std::uint8_t>(remainder);
}

std::vector<std::uint8_t> encode_ld06(const Ld06Packet& packet) {
  const auto hundredths = [](double angle) { return std::fmod(std::round(100.0 * angle), 36'000.0); };
  std::vector<std::uint8_t> out{0x54, 0x2C};
  put_u16(out, packet.speed);
  put_u16(out, hundredths(packet.start_angle));
  for (const Beam& point : packet.points) {
    put_u16(out, std::clamp(1000.0 * point.range, 0.0, 65'535.0));
    out.push_back(static_cast<std::uint8_t>(std::clamp(point.intensity, 0.0, 255.0)));
  }
  put_u16(out, hundredths(packet.end_angle));
  put_u16(out, std::fmod(std::floor(1000.0 * packet.time), 30'000.0));
  out.push_back(ld06_checksum(out));
  return out;
}

Ld06Stream::Ld06Stream(const LidarOptions& options, double clock_offset, double clock_rate_error)
    : options_(options), clock_offset_(clock_offset), clock_rate_(1.0 + clock_rate_error) {}

double Ld06Stream::device_time(double now) const { return clock_offset_ + now * clock_rate_; }

void Ld06Stream::restart(double now) {
  started_ = now;
  clock_offset_ = -now * clock_rate_;
  gathered_.clear();
  waiting_.clear();
}

Beam Ld06Stream::altered(Beam beam) {
  if (faults.blind) beam.range = beam.intensity = 0.0;
  const auto index = static_cast<std::size_t>(beam.index);
  frozen_ranges_.resize(static_cast<std::size_t>(options_.beams_per_turn), 0.0);
  if (faults.frozen) {
    beam.range = frozen_ranges_[index];
    return beam;
  }
  frozen_ranges_[index] = beam.range;
  if (faults.mirrored) beam.range = frozen_ranges_[(frozen_ranges_.size() - index) % frozen_ranges_.size()];
  return beam;
}

void Ld06Stream::add(const Beam& beam) {
  gathered_.push_back(altered(beam));
  if (gathered_.size() == kPoints) finish();
}

void Ld06Stream::finish() {
  Ld06Packet packet;
  packet.points.swap(gathered_);
  const double end = packet.points.back().t;
  const bool spinning_up = end - started_ < kSpinUp;
  packet.speed = spinning_up ? 0.0 : 360.0 * options_.turns_per_second;
  packet.start_angle = spinning_up ? 0.0 : degrees(packet.points.front().clockwise);
  packet.end_angle = spinning_up ? 0.0 : degrees(packet.points.back().clockwise);
  packet.time = device_time(end);
  Chunk chunk;
  chunk.bytes = encode_ld06(packet);
  const double transmission = static_cast<double>(chunk.bytes.size()) / kBytesPerSecond;
  chunk.due = std::max(end + kProcessing + transmission + lateness_ + faults.extra_delay, last_due_);
  last_due_ = chunk.due;
  const double before = std::floor(static_cast<double>(packets_) * faults.share_lost);
  const bool lost = std::floor(static_cast<double>(++packets_) * faults.share_lost) > before;
  if (faults.half_packets) chunk.bytes.resize(chunk.bytes.size() / 2);
  if (!lost && !faults.cut) waiting_.push_back(std::move(chunk));
}

std::vector<std::uint8_t> Ld06Stream::take(double now) {
  std::vector<std::uint8_t> out;
  while (!waiting_.empty() && waiting_.front().due <= now) {
    out.insert(out.end(), waiting_.front().bytes.begin(), waiting_.front().bytes.end());
    waiting_.pop_front();
  }
  if (faults.cut) out.clear();
  return out;
}

}  // namespace odomcalib::sim
