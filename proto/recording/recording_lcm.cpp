// LCM event logs: our own messages, or those of the MBot and MaeBot family and bot_core.
#include <optional>

#include "proto/recording/lcm_foreign.hpp"
#include "proto/recording/lcm_leftovers.hpp"
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
