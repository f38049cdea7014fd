// Content of containers, by topic: every message that can be decoded, and a count of every other. Internal to
// proto/.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/measurements.hpp"
#include "proto/recording/ros/messages.hpp"
#include "proto/recording/ros/unpack.hpp"

namespace odomcalib::ros {

/// A message with the two times that it has.
template <typename Value>
struct Stamped {
  std::int64_t stamp_ns = 0;     ///< of its header; 0: not set
  std::int64_t received_ns = 0;  ///< when the recorder had it
  Value value{};
  std::size_t frames = 0;  ///< which of the topic's frames; not of joints
};

/// Frames of a message: frame_id of its header, and child_frame_id of odometry.
struct Frames {
  std::string frame, child;
};

/// The joints of one message: values in the order of one of the topic's lists of names.
struct JointValues {
  std::size_t names = 0;
  std::vector<double> positions, velocities;
};

/// How a container describes a topic.
struct TopicHeader {
  std::string name, type;
  std::string encoding;  ///< ros1 or cdr; any other is told and not read
  std::string md5;       ///< of the ROS 1 definition; empty or * where it is not known
};

struct Topic {
  TopicHeader header;
  Kind kind = Kind::none;  ///< none: cannot be read
  Encoding encoding = Encoding::cdr;
  std::string problem;         ///< why a type that is known by name cannot be read
  std::size_t count = 0;       ///< messages in the container
  std::size_t malformed = 0;   ///< that did not hold what the type says
  std::vector<Frames> frames;  ///< all that messages had, the first one first

  // Decoded content, by the topic's kind.
  std::vector<Stamped<Scan>> scans;
  std::vector<std::vector<std::string>> joint_names;  ///< every list that a message had
  std::vector<Stamped<JointValues>> joints;
  std::vector<Stamped<double>> yaw_rates;
  std::vector<Stamped<PoseSample>> poses;  ///< t is not set, yaw NaN: no rotation; odometry and pose
  bool moves = false;                      ///< by the twist of a message
  std::size_t unusable = 0;                ///< transforms without a place or a rotation, of all messages
  std::vector<Transform> transforms;  ///< of /tf_static, that of a child as it came last; of a description
};

class Collector {
 public:
  /// @param kinds of topics by name, for those whose type the file does not say
  explicit Collector(std::map<std::string, Kind> kinds = {}, const UnpackLimit& limit = {})
      : kinds_(std::move(kinds)), unpacker_(limit) {}

  /// A topic as one connection of one file describes it; the same name and type are the same topic. The
  /// number goes with the messages. kTooMany when a file has more of them than any robot.
  std::size_t topic(const TopicHeader& header);
  static constexpr std::size_t kTooMany = SIZE_MAX;

  /// Unpacker of the recording's pieces: they have one limit together.
  Unpacker& unpacker() { return unpacker_; }

  void message(std::size_t topic, std::int64_t received_ns, std::string_view bytes);
  /// Something that was not used, and why.
  void discard(const std::string& what, const std::string& reason, std::size_t count = 1);

  [[nodiscard]] const std::vector<Topic>& topics() const { return topics_; }
  [[nodiscard]] std::vector<Topic>& topics() { return topics_; }
  [[nodiscard]] const std::map<std::pair<std::string, std::string>, std::size_t>& discarded() const {
    return discarded_;
  }

 private:
  std::map<std::string, Kind> kinds_;
  std::vector<Topic> topics_;
  Unpacker unpacker_;
  std::map<std::pair<std::string, std::string>, std::size_t> by_name_;
  std::map<std::pair<std::string, std::string>, std::size_t> discarded_;
};

}  // namespace odomcalib::ros
