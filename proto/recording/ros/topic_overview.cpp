#include "proto/recording/ros/topic_overview.hpp"

#include <algorithm>
#include <set>

#include "proto/recording/ros/joints.hpp"
#include "proto/recording/ros/unpack.hpp"

namespace odomcalib::ros {
namespace {

/// Times of the messages of one kind, in order.
template <typename Value>
void add_times(const std::vector<Stamped<Value>>& messages, TopicOverview& found) {
  std::vector<double> times;
  for (const auto& one : messages)
    if (one.stamp_ns != 0) times.push_back(1e-9 * static_cast<double>(one.stamp_ns));
  found.without_stamp += messages.size() - times.size();
  // As for the samples: single ones without a stamp are no time of their own.
  if (times.size() <= messages.size() / 2)
    for (const auto& one : messages)
      if (one.stamp_ns == 0) times.push_back(1e-9 * static_cast<double>(one.received_ns));
  if (times.empty()) return;
  std::sort(times.begin(), times.end());
  found.begin = times.front();
  found.end = times.back();
  for (std::size_t k = 1; k < times.size(); ++k)
    found.longest_gap = std::max(found.longest_gap, times[k] - times[k - 1]);
}

std::string frames_text(const Frames& frames) {
  return frames.child.empty() ? frames.frame : frames.frame + " -> " + frames.child;
}

std::string why_unread(const Topic& topic) {
  if (topic.kind != Kind::none) return {};
  if (topic.header.type.empty()) return "the file does not say what it is";
  return topic.problem.empty() ? "no message that calibration uses" : topic.problem;
}

TopicOverview overview_of(const Topic& topic) {
  TopicOverview found;
  found.name = topic.header.name;
  found.type = topic.header.type;
  found.unread = why_unread(topic);
  found.messages = topic.count;
  found.malformed = topic.malformed;
  add_times(topic.scans, found);
  add_times(topic.joints, found);
  add_times(topic.yaw_rates, found);
  add_times(topic.poses, found);
  for (const Frames& frames : topic.frames) found.frames.push_back(frames_text(frames));
  found.joints = joint_names(topic);
  return found;
}

}  // namespace

std::vector<TopicOverview> overview_of(const std::vector<Topic>& topics) {
  std::vector<TopicOverview> all;
  all.reserve(topics.size());
  for (const Topic& topic : topics) all.push_back(overview_of(topic));
  return all;
}

std::string container_name(std::string_view bytes) {
  if (is_zstd(bytes)) return "a ROS recording, packed with zstd";
  if (bytes.starts_with("#ROSBAG")) return "ROS bag";
  return bytes.starts_with("SQLite") ? "rosbag2 (sqlite3)" : "MCAP";
}

}  // namespace odomcalib::ros
