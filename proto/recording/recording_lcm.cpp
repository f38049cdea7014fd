// LCM event logs: our own messages, or those of the MBot and MaeBot family and bot_core.
#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "proto/recording/lcm_foreign.hpp"
#include "proto/recording/recording_readers.hpp"
#include "proto/wire/event_log.hpp"
#include "proto/wire/messages.hpp"

namespace odomcalib {
namespace {

std::uint64_t fingerprint_of(const LogEvent& event) { return messages::fingerprint(event.data).value_or(0); }

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

constexpr std::size_t kMostListed = 50;

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

std::string hex(std::uint64_t value) {
  std::array<char, 19> text{};
  (void)std::snprintf(text.data(), text.size(), "0x%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

/// Messages that a recording does not use: counted, never a reason to fail.
/// Names those that are known; lists the others by fingerprint, a limited number of them.
class LcmLeftovers {
 public:
  explicit LcmLeftovers(RecordingBuilder& builder) : builder_(builder) {}
  void add(std::uint64_t fingerprint) {
    const auto known = std::find_if(kUnused.begin(), kUnused.end(),
                                    [&](const Known& k) { return k.fingerprint == fingerprint; });
    if (known != kUnused.end()) return builder_.discard("event", std::string("not needed: ") + known->name);
    const bool seen = std::find(seen_.begin(), seen_.end(), fingerprint) != seen_.end();
    if (!seen && seen_.size() >= kMostListed) return builder_.discard("event", "unknown fingerprint, others");
    if (!seen) seen_.push_back(fingerprint);
    builder_.discard("event", "unknown fingerprint " + hex(fingerprint));
  }

 private:
  RecordingBuilder& builder_;
  std::vector<std::uint64_t> seen_;
};

/// Content of a log, from a first pass over its fingerprints.
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
    content.old_encoders = content.old_encoders || ForeignMessages::is_old_encoder(fingerprint);
  }
  return content;
}

template <typename Messages>
void read_events(std::string_view bytes, Messages messages, RecordingBuilder& builder) {
  LcmLeftovers leftovers(builder);
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
