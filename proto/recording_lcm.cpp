// LCM event logs: our own messages, or those of the MBot and MaeBot family and bot_core.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "proto/event_log.hpp"
#include "proto/lcm_fields.hpp"
#include "proto/messages.hpp"
#include "proto/recording_readers.hpp"

namespace odomcalib {
namespace {

// Types of others (protocol text, section 3); MaeBot's encoders are {int64 utime; int32 left, right}.
constexpr std::uint64_t kLidar = 0x89dc5b879a5056cf;
constexpr std::uint64_t kPlanarLidar = 0xe3d17423180b5e8d;
constexpr std::uint64_t kMbotEncoders = 0xaefa0bcd9e362081;
constexpr std::uint64_t kOldMbotEncoder = 0xa8b04e85ffa9d1d1;
constexpr std::uint64_t kMaebotEncoders = 0x7d090bfb221d74f9;

struct Known {
  std::uint64_t fingerprint;
  const char* name;
};
/// Messages that are known and carry nothing that calibration uses.
constexpr std::array<Known, 14> kUnused{{{messages::kPathFingerprint, "path_t"},
                                         {messages::kEventFingerprint, "event_t"},
                                         {messages::kJsonFingerprint, "json_t"},
                                         {0x2e16efb052b0105e, "bot_core.pose_t"},
                                         {0xea9ffbf2acc5c5ae, "bot_core.rigid_transform_t"},
                                         {0x30571b45b804c18e, "bot_core.raw_t"},
                                         {0x22bd8eb19e834aad, "bot_core.sensor_status_t"},
                                         {0x1f317af1246276ac, "mbot_lcm_msgs.pose2D_t"},
                                         {0x85d72aee83523195, "mbot_lcm_msgs.twist2D_t"},
                                         {0x8119c7c9136961b1, "mbot_lcm_msgs.mbot_motor_vel_t"},
                                         {0x9ef39a5ffc75e462, "mbot_lcm_msgs.mbot_imu_t"},
                                         {0xefadf583af374079, "mbot_lcm_msgs.path2D_t"},
                                         {0x4d0d41c1f105b12f, "mbot_lcm_msgs.timestamp_t"},
                                         {0xed966784146237ec, "maebot_imu_t"}}};

std::uint64_t fingerprint_of(const LogEvent& event) { return messages::fingerprint(event.data).value_or(0); }

std::string hex(std::uint64_t value) {
  std::array<char, 19> text{};
  (void)std::snprintf(text.data(), text.size(), "0x%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

/// Counts what is not ours to read; a flood of different fingerprints cannot grow the list without limit.
class Leftovers {
 public:
  explicit Leftovers(RecordingBuilder& builder) : builder_(builder) {}

  void add(std::uint64_t fingerprint) {
    const auto known = std::find_if(kUnused.begin(), kUnused.end(),
                                    [&](const Known& k) { return k.fingerprint == fingerprint; });
    if (known != kUnused.end()) {
      builder_.discard("event", std::string("not needed: ") + known->name);
    } else if (std::find(seen_.begin(), seen_.end(), fingerprint) != seen_.end() || seen_.size() < kMost) {
      if (std::find(seen_.begin(), seen_.end(), fingerprint) == seen_.end()) seen_.push_back(fingerprint);
      builder_.discard("event", "unknown fingerprint " + hex(fingerprint));
    } else {
      builder_.discard("event", "unknown fingerprint, others");
    }
  }

 private:
  static constexpr std::size_t kMost = 50;
  RecordingBuilder& builder_;
  std::vector<std::uint64_t> seen_;
};

/// Our own messages. Dead reckoning that the daemon published (ODOM) has the type of the external reference
/// (POSE_REF): only the channel tells them apart.
class OwnMessages {
 public:
  explicit OwnMessages(RecordingBuilder& builder) : builder_(builder) {}

  static bool is_data(std::uint64_t fingerprint) {
    return fingerprint == messages::kTicksFingerprint || fingerprint == messages::kScanFingerprint ||
           fingerprint == messages::kRobotFingerprint;
  }

  bool add(std::uint64_t fingerprint, const LogEvent& event) {
    switch (fingerprint) {
      case messages::kRobotFingerprint:
        return use(messages::decode_robot(event.data), "robot",
                   [&](auto& m) { builder_.add_robot(std::move(m)); });
      case messages::kTicksFingerprint:
        return use(messages::decode_ticks(event.data), "ticks",
                   [&](auto& m) { builder_.add_ticks(m.ticks); });
      case messages::kScanFingerprint:
        return use(messages::decode_scan(event.data), "scan", [&](auto& m) { add_scan(m); });
      case messages::kGyroFingerprint:
        return use(messages::decode_gyro(event.data), "gyro", [&](auto& m) { builder_.add_gyro(m.gyro); });
      case messages::kPoseFingerprint:
        if (!event.channel.ends_with("POSE_REF")) return true;  // odometry, computed from the ticks
        return use(messages::decode_pose(event.data), "pose", [&](auto& m) { builder_.add_pose(m.pose); });
      default:
        return false;
    }
  }

 private:
  template <typename Message, typename Use>
  bool use(std::optional<Message> message, const char* what, Use add) {
    if (message)
      add(*message);
    else
      builder_.discard(what, "damaged message");
    return true;
  }
  void add_scan(messages::ScanMessage& message) {
    if (message.complete)
      builder_.add_scan(std::move(message.scan));
    else
      builder_.discard("scan", "incomplete");
  }

  RecordingBuilder& builder_;
};

/// Logs of the MBot and MaeBot family and of bot_core robots.
class ForeignMessages {
 public:
  /// @param clockwise sense of lidar_t's angles: older robots of the family give them clockwise
  ForeignMessages(RecordingBuilder& builder, bool clockwise) : builder_(builder), clockwise_(clockwise) {}

  bool add(std::uint64_t fingerprint, const LogEvent& event) {
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

 private:
  static constexpr float kNoReading = 0.05F;  // m; these robots write it, or less, for a beam without return

  /// Seconds since the whole second in which the first message was measured: keeps microseconds exact.
  double time(std::int64_t utime) {
    if (!start_) start_ = utime - ((utime % 1'000'000) + 1'000'000) % 1'000'000;
    std::int64_t since = 0;
    if (__builtin_sub_overflow(utime, *start_, &since)) return std::nan("");
    return static_cast<double>(since) * 1e-6;
  }

  Scan lidar(ByteReader& reader) {
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

  void set_times(Scan& scan, std::int64_t utime, const std::vector<std::int64_t>& stamps) {
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
  [[nodiscard]] float direction(float angle) const {
    const double turned = clockwise_ ? -static_cast<double>(angle) : static_cast<double>(angle);
    return static_cast<float>(std::remainder(turned, 2.0 * std::numbers::pi));
  }

  /// The nearest uniform grid, for those who need one; `angles` stays what counts.
  static void set_grid(Scan& scan) {
    if (scan.angles.empty()) return;
    const double sense =
        scan.angles.size() > 1 && std::remainder(static_cast<double>(scan.angles[1] - scan.angles[0]),
                                                 2.0 * std::numbers::pi) < 0.0
            ? -1.0
            : 1.0;
    scan.angle_min = static_cast<double>(scan.angles.front());
    scan.angle_increment = sense * 2.0 * std::numbers::pi / static_cast<double>(scan.angles.size());
  }

  Scan planar_lidar(ByteReader& reader) {
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

  TickSample sample(ByteReader& reader, std::int64_t utime, std::int64_t left, std::int64_t right) {
    return {reader.ok() ? time(utime) : 0.0, left, right, 0};
  }

  TickSample mbot_encoders(ByteReader& reader) {
    const auto utime = reader.big_endian<std::int64_t>();
    const auto left = reader.big_endian<std::int64_t>();
    const auto right = reader.big_endian<std::int64_t>();
    reader.take(sizeof(std::int64_t) + 4 * sizeof(std::int32_t));  // third wheel, differences, interval
    return sample(reader, utime, left, right);
  }

  TickSample old_mbot_encoder(ByteReader& reader) {
    const auto utime = reader.big_endian<std::int64_t>();
    const auto left = reader.big_endian<std::int64_t>();
    const auto right = reader.big_endian<std::int64_t>();
    reader.take(2 * sizeof(std::int16_t));  // differences
    return sample(reader, utime, left, right);
  }

  TickSample maebot_encoders(ByteReader& reader) {
    const auto utime = reader.big_endian<std::int64_t>();
    const std::int64_t left = reader.big_endian<std::int32_t>();
    const std::int64_t right = reader.big_endian<std::int32_t>();
    return sample(reader, utime, left, right);
  }

  bool finish(const ByteReader& reader, const char* what, Scan scan) {
    if (!reader.at_end()) return damaged(what);
    for (float& range : scan.ranges)
      if (range <= kNoReading) range = 0.0F;
    builder_.add_scan(std::move(scan));
    return true;
  }
  bool finish(const ByteReader& reader, const char* what, const TickSample& sample) {
    if (!reader.at_end()) return damaged(what);
    builder_.add_ticks(sample);
    return true;
  }
  bool damaged(const char* what) {
    builder_.discard(what, "damaged message");
    return true;
  }

  RecordingBuilder& builder_;
  bool clockwise_;
  std::optional<std::int64_t> start_;
};

/// What a log holds, from a first pass over its fingerprints.
struct Content {
  bool own = false;
  bool old_encoders = false;
};

Content survey(std::string_view bytes) {
  Content content;
  EventLogReader log(bytes);
  while (const auto event = log.next()) {
    const auto fingerprint = fingerprint_of(*event);
    content.own = content.own || OwnMessages::is_data(fingerprint);
    content.old_encoders =
        content.old_encoders || fingerprint == kMaebotEncoders || fingerprint == kOldMbotEncoder;
  }
  return content;
}

template <typename Messages>
void read_events(std::string_view bytes, Messages messages, RecordingBuilder& builder) {
  Leftovers leftovers(builder);
  EventLogReader log(bytes);
  while (const auto event = log.next()) {
    const auto fingerprint = fingerprint_of(*event);
    if (!messages.add(fingerprint, *event)) leftovers.add(fingerprint);
  }
  builder.discard("event", "cut off", log.counters().cut_off > 0 ? 1 : 0);
  builder.discard("event", "damaged", log.counters().damaged);
  builder.discard("byte", "between events", log.counters().skipped);
}

}  // namespace

void read_event_log(std::string_view bytes, RecordingBuilder& builder) {
  const auto content = survey(bytes);
  if (content.own)
    read_events(bytes, OwnMessages(builder), builder);
  else
    read_events(bytes, ForeignMessages(builder, content.old_encoders), builder);
}

}  // namespace odomcalib
