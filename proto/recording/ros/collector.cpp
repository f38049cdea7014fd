#include "proto/recording/ros/collector.hpp"

#include <algorithm>

#include "proto/recording/ros/urdf.hpp"

namespace odomcalib::ros {
namespace {

// MCAP's own limit: its channels have 16-bit numbers.
constexpr std::size_t kMostTopics = 65'536;
// Lists of joint names on one topic: one a publisher, each with its own joints.
constexpr std::size_t kMostNameLists = 256;
// Frames on one topic: one a device that publishes there. Chosen: as lists of names.
constexpr std::size_t kMostFrames = 256;

// Characters of a name; ROS allows 255 in all.
constexpr std::size_t kLongestName = 255;

/// Names are printed: what no ROS name has (control characters, bytes beyond ASCII) goes.
std::string printable(std::string_view name) {
  std::string out(name.substr(0, kLongestName));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

std::string problem_of(const TopicHeader& header, Kind kind) {
  if (header.encoding != "ros1" && header.encoding != "cdr")
    return "in the encoding \"" + header.encoding + "\"";
  if (header.md5.empty() || header.md5 == "*" || header.md5 == md5_of(kind)) return {};
  return "of another definition (MD5 " + header.md5 + ")";
}

/// tf2 has no leading slash, older programs write one.
std::string frame_name(std::string_view name) {
  return printable(name.substr(name.starts_with('/') ? 1 : 0));
}

/// Index of the frames of a message; what has too many of them keeps the last ones.
std::size_t index_of_frames(Topic& topic, const std::string& frame, const std::string& child = {}) {
  const Frames frames{frame_name(frame), frame_name(child)};
  const auto known = std::find_if(topic.frames.begin(), topic.frames.end(), [&](const Frames& one) {
    return one.frame == frames.frame && one.child == frames.child;
  });
  if (known != topic.frames.end()) return static_cast<std::size_t>(known - topic.frames.begin());
  if (topic.frames.size() < kMostFrames) topic.frames.push_back(frames);
  return topic.frames.size() - 1;
}

/// SIZE_MAX when the topic has too many lists already.
std::size_t index_of_names(Topic& topic, std::vector<std::string> names) {
  const auto known = std::find(topic.joint_names.begin(), topic.joint_names.end(), names);
  if (known != topic.joint_names.end()) return static_cast<std::size_t>(known - topic.joint_names.begin());
  if (topic.joint_names.size() >= kMostNameLists) return SIZE_MAX;
  topic.joint_names.push_back(std::move(names));
  return topic.joint_names.size() - 1;
}

// Each adds one message to its topic; false when the bytes do not hold it.

bool add_scan(Topic& topic, std::int64_t received, std::string_view bytes) {
  auto scan = decode_scan(bytes, topic.encoding);
  if (!scan) return false;
  topic.scans.push_back(
      {scan->header.stamp_ns, received, std::move(scan->scan), index_of_frames(topic, scan->header.frame)});
  return true;
}

bool add_joints(Topic& topic, std::int64_t received, std::string_view bytes) {
  auto joints = decode_joints(bytes, topic.encoding);
  if (!joints) return false;
  for (auto& name : joints->names) name = printable(name);
  const std::size_t names = index_of_names(topic, std::move(joints->names));
  if (names == SIZE_MAX) return false;
  topic.joints.push_back({joints->header.stamp_ns,
                          received,
                          {names, std::move(joints->positions), std::move(joints->velocities)}});
  return true;
}

bool add_imu(Topic& topic, std::int64_t received, std::string_view bytes) {
  const auto imu = decode_imu(bytes, topic.encoding);
  if (!imu || !imu->yaw_rate) return false;
  topic.yaw_rates.push_back(
      {imu->header.stamp_ns, received, *imu->yaw_rate, index_of_frames(topic, imu->header.frame)});
  return true;
}

bool add_pose(Topic& topic, std::int64_t received, std::string_view bytes) {
  const auto pose = topic.kind == Kind::odometry ? decode_odometry(bytes, topic.encoding)
                                                 : decode_pose(bytes, topic.encoding);
  if (!pose) return false;
  topic.moves = topic.moves || pose->moves;
  topic.poses.push_back({pose->header.stamp_ns,
                         received,
                         {0.0, pose->x, pose->y, pose->yaw},
                         index_of_frames(topic, pose->header.frame, pose->child_frame)});
  return true;
}

/// The last place of a frame counts where it is placed again.
bool add_transforms(Topic& topic, std::string_view bytes) {
  auto transforms = decode_transforms(bytes, topic.encoding);
  if (!transforms) return false;
  topic.unusable += transforms->unusable;
  for (Transform& one : transforms->usable) {
    one.frame = frame_name(one.frame);
    one.child = frame_name(one.child);
    std::erase_if(topic.transforms, [&](const Transform& known) { return known.child == one.child; });
    if (topic.transforms.size() < kMostFrames) topic.transforms.push_back(std::move(one));
  }
  return true;
}

/// The last description that can be read counts.
bool add_description(Topic& topic, std::string_view bytes) {
  const auto text = decode_text(bytes, topic.encoding);
  if (!text) return false;
  auto joints = fixed_joints(*text);
  if (!joints) return false;
  topic.unusable = joints->unusable;
  topic.transforms = std::move(joints->usable);
  for (Transform& one : topic.transforms) {
    one.frame = frame_name(one.frame);
    one.child = frame_name(one.child);
  }
  return true;
}

bool add(Topic& topic, std::int64_t received, std::string_view bytes) {
  switch (topic.kind) {
    case Kind::scan:
      return add_scan(topic, received, bytes);
    case Kind::joints:
      return add_joints(topic, received, bytes);
    case Kind::imu:
      return add_imu(topic, received, bytes);
    case Kind::odometry:
    case Kind::pose:
      return add_pose(topic, received, bytes);
    case Kind::transforms:
      return add_transforms(topic, bytes);
    case Kind::description:
      return add_description(topic, bytes);
    case Kind::none:
      break;
  }
  return true;
}

/// Where frames are at rest to each other; /tf has those that move. Any other text is no description.
bool is_of_mounting(Kind kind, const TopicHeader& header) {
  return header.name.ends_with(kind == Kind::transforms ? "tf_static" : "robot_description");
}

}  // namespace

std::size_t Collector::topic(const TopicHeader& described) {
  const TopicHeader header{printable(described.name), printable(described.type),
                           printable(described.encoding), printable(described.md5)};
  const auto key = std::pair(header.name, header.type + '\n' + header.encoding + '\n' + header.md5);
  const auto known = by_name_.find(key);
  if (known != by_name_.end()) return known->second;
  if (topics_.size() >= kMostTopics) return kTooMany;
  Topic topic;
  topic.header = header;
  topic.encoding = header.encoding == "ros1" ? Encoding::ros1 : Encoding::cdr;
  topic.kind = kind_of(header.type);
  if (const auto said = kinds_.find(header.name); header.type.empty() && said != kinds_.end()) {
    topic.kind = said->second;
    topic.header.type = std::string(type_of(topic.kind)) + " as chosen";
  }
  if (tells_mounting(topic.kind) && !is_of_mounting(topic.kind, header)) topic.kind = Kind::none;
  if (topic.kind != Kind::none) topic.problem = problem_of(header, topic.kind);
  if (!topic.problem.empty()) topic.kind = Kind::none;
  topics_.push_back(std::move(topic));
  by_name_[key] = topics_.size() - 1;
  return topics_.size() - 1;
}

void Collector::message(std::size_t index, std::int64_t received_ns, std::string_view bytes) {
  if (index >= topics_.size()) return discard("message", "of a topic that the file does not describe");
  Topic& topic = topics_[index];
  ++topic.count;
  if (topic.kind == Kind::none) return;
  // rosbag2 may pack each message alone; only its metadata.yaml says so, but CDR never begins like zstd.
  if (topic.encoding == Encoding::cdr && is_zstd(bytes)) {
    const Unpacked whole = unpacker_(Packing::zstd, bytes, std::nullopt);
    if (!whole.whole || !add(topic, received_ns, whole.bytes)) ++topic.malformed;
  } else if (!add(topic, received_ns, bytes)) {
    ++topic.malformed;
  }
}

void Collector::discard(const std::string& what, const std::string& reason, std::size_t count) {
  discarded_[{what, reason}] += count;
}

}  // namespace odomcalib::ros
