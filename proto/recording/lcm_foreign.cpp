#include "proto/recording/lcm_foreign.hpp"

#include <cmath>
#include <numbers>

#include "proto/wire/lcm_fields.hpp"

namespace odomcalib {
namespace {

// Types of others (protocol text, section 3); MaeBot's encoders are {int64 utime; int32 left, right}.
constexpr std::uint64_t kLidar = 0x89dc5b879a5056cf;
constexpr std::uint64_t kPlanarLidar = 0xe3d17423180b5e8d;
constexpr std::uint64_t kMbotEncoders = 0xaefa0bcd9e362081;
constexpr std::uint64_t kOldMbotEncoder = 0xa8b04e85ffa9d1d1;
constexpr std::uint64_t kMaebotEncoders = 0x7d090bfb221d74f9;

constexpr std::int64_t kLatest = 9'000'000'000'000'000;  // us since 1970, year 2255
constexpr float kNoReading = 0.05F;  // m; these robots write it, or less, for a beam without return

/// The nearest uniform grid, for those who need one; `angles` stays what counts.
void set_grid(Scan& scan) {
  if (scan.angles.empty()) return;
  const double sense =
      scan.angles.size() > 1 && std::remainder(static_cast<double>(scan.angles[1] - scan.angles[0]),
                                               2.0 * std::numbers::pi) < 0.0
          ? -1.0
          : 1.0;
  scan.angle_min = static_cast<double>(scan.angles.front());
  scan.angle_increment = sense * 2.0 * std::numbers::pi / static_cast<double>(scan.angles.size());
}

}  // namespace

bool ForeignMessages::is_old_encoder(std::uint64_t fingerprint) {
  return fingerprint == kMaebotEncoders || fingerprint == kOldMbotEncoder;
}

bool ForeignMessages::add(std::uint64_t fingerprint, const LogEvent& event) {
  ByteReader reader(event.data);
  reader.take(sizeof(std::uint64_t));
  switch (fingerprint) {
    case kLidar:
      return finish(reader, "scan", lidar(reader));
    case kPlanarLidar:
      return finish(reader, "scan", planar_lidar(reader));
    case kMbotEncoders:
      return finish(reader, "ticks", mbot_encoders(reader));
    case kOldMbotEncoder:
      return finish(reader, "ticks", old_mbot_encoder(reader));
    case kMaebotEncoders:
      return finish(reader, "ticks", maebot_encoders(reader));
    default:
      return false;
  }
}

/// Seconds since the whole second in which the first message was measured: keeps microseconds exact.
double ForeignMessages::time(std::int64_t utime) {
  if (utime < 0 || utime > kLatest) return std::nan("");
  if (!start_) {
    start_ = utime - utime % 1'000'000;
    builder_.count_from(static_cast<double>(*start_ / 1'000'000));
  }
  return static_cast<double>(utime - *start_) / 1e6;
}

Scan ForeignMessages::lidar(ByteReader& reader) {
  const auto utime = reader.big_endian<std::int64_t>();
  const auto count = reader.big_endian<std::int32_t>();
  Scan scan;
  scan.ranges = lcm_array<float>(reader, count);
  scan.angles = lcm_array<float>(reader, count);
  const auto stamps = lcm_array<std::int64_t>(reader, count);
  scan.intensities = lcm_array<float>(reader, count);
  if (!reader.ok()) return scan;
  set_times(scan, utime, stamps);
  for (float& angle : scan.angles) angle = direction(angle);
  set_grid(scan);
  return scan;
}

void ForeignMessages::set_times(Scan& scan, std::int64_t utime, const std::vector<std::int64_t>& stamps) {
  const bool stamped = !stamps.empty() && stamps.front() != 0 && stamps.front() != stamps.back();
  scan.t = time(stamped ? stamps.front() : utime);
  if (!stamped) return;
  for (const std::int64_t stamp : stamps) {
    std::int64_t since = 0;
    const bool lost = __builtin_sub_overflow(stamp, stamps.front(), &since);
    scan.times.push_back(lost ? std::nanf("") : static_cast<float>(static_cast<double>(since) * 1e-6));
  }
}

/// Counter-clockwise and in [-pi, pi].
float ForeignMessages::direction(float angle) const {
  const double turned = clockwise_ ? -static_cast<double>(angle) : static_cast<double>(angle);
  return static_cast<float>(std::remainder(turned, 2.0 * std::numbers::pi));
}

Scan ForeignMessages::planar_lidar(ByteReader& reader) {
  Scan scan;
  const auto utime = reader.big_endian<std::int64_t>();
  const auto ranges = reader.big_endian<std::int32_t>();
  scan.ranges = lcm_array<float>(reader, ranges);
  const auto intensities = reader.big_endian<std::int32_t>();
  scan.intensities = lcm_array<float>(reader, intensities);
  scan.angle_min = static_cast<double>(reader.big_endian<float>());
  scan.angle_increment = static_cast<double>(reader.big_endian<float>());
  if (scan.intensities.size() != scan.ranges.size()) scan.intensities.clear();
  if (reader.ok()) scan.t = time(utime);
  return scan;
}

TickSample ForeignMessages::sample(const ByteReader& reader, std::int64_t utime, std::int64_t left,
                                   std::int64_t right) {
  return {reader.ok() ? time(utime) : 0.0, left, right, 0};
}

TickSample ForeignMessages::mbot_encoders(ByteReader& reader) {
  const auto utime = reader.big_endian<std::int64_t>();
  const auto left = reader.big_endian<std::int64_t>();
  const auto right = reader.big_endian<std::int64_t>();
  reader.take(sizeof(std::int64_t) + 4 * sizeof(std::int32_t));  // third wheel, differences, interval
  return sample(reader, utime, left, right);
}

TickSample ForeignMessages::old_mbot_encoder(ByteReader& reader) {
  const auto utime = reader.big_endian<std::int64_t>();
  const auto left = reader.big_endian<std::int64_t>();
  const auto right = reader.big_endian<std::int64_t>();
  reader.take(2 * sizeof(std::int16_t));  // differences
  return sample(reader, utime, left, right);
}

TickSample ForeignMessages::maebot_encoders(ByteReader& reader) {
  const auto utime = reader.big_endian<std::int64_t>();
  const std::int64_t left = reader.big_endian<std::int32_t>();
  const std::int64_t right = reader.big_endian<std::int32_t>();
  return sample(reader, utime, left, right);
}

bool ForeignMessages::finish(const ByteReader& reader, const char* what, Scan scan) {
  if (!reader.at_end()) return damaged(what);
  for (float& range : scan.ranges)
    if (range <= kNoReading) range = 0.0F;
  builder_.add_scan(std::move(scan));
  return true;
}

bool ForeignMessages::finish(const ByteReader& reader, const char* what, const TickSample& sample) {
  if (!reader.at_end()) return damaged(what);
  builder_.add_ticks(sample);
  return true;
}

bool ForeignMessages::damaged(const char* what) {
  builder_.discard(what, "damaged message");
  return true;
}

}  // namespace odomcalib
