#include "proto/recording/ros/publishers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace odomcalib::ros {
namespace {

// Share of the values of one list of names that lie beyond what the other list says at that time, of lists
// that tell different motions. Chosen: messages that overtake each other make single ones.
constexpr double kDifferent = 0.05;

using Messages = std::vector<const Stamped<JointValues>*>;

/// Messages with one list of names that holds both wheels.
struct List {
  std::size_t index = 0;
  Places at;
  Messages messages;
  bool changes = false;
};

class JointLists {
 public:
  JointLists(const Topic& topic, const Joints& joints, bool speeds) : topic_(topic), speeds_(speeds) {
    const auto all = places(topic, joints);
    for (std::size_t k = 0; k < all.size(); ++k)
      if (all[k][0] && all[k][1]) lists_.push_back({k, all[k], {}, false});
    for (List& list : lists_) {
      for (const auto& one : topic.joints)
        if (one.value.names == list.index && !values(one).empty()) list.messages.push_back(&one);
      std::stable_sort(list.messages.begin(), list.messages.end(),
                       [](const auto* a, const auto* b) { return a->received_ns < b->received_ns; });
      list.changes = std::any_of(list.messages.begin(), list.messages.end(), [&](const auto* one) {
        return value(list, *one, 0) != value(list, *list.messages.front(), 0) ||
               value(list, *one, 1) != value(list, *list.messages.front(), 1);
      });
    }
    std::erase_if(lists_, [](const List& list) { return list.messages.empty(); });
  }

  /// Those that never change beside one that does.
  [[nodiscard]] std::vector<List> still() const {
    std::vector<List> out;
    if (std::any_of(lists_.begin(), lists_.end(), [](const List& list) { return list.changes; }))
      std::copy_if(lists_.begin(), lists_.end(), std::back_inserter(out),
                   [](const List& list) { return !list.changes; });
    return out;
  }
  [[nodiscard]] std::vector<List> changing() const {
    std::vector<List> out;
    std::copy_if(lists_.begin(), lists_.end(), std::back_inserter(out),
                 [](const List& list) { return list.changes; });
    return out;
  }

  /// Whether the second tells what the first one does in between.
  [[nodiscard]] bool agree(const List& one, const List& other) const {
    std::size_t compared = 0, beyond = 0;
    for (const auto* message : other.messages)
      if (const auto fits = is_between(one, other, *message)) {
        ++compared;
        beyond += *fits ? 0 : 1;
      }
    return static_cast<double>(beyond) <= kDifferent * static_cast<double>(compared);
  }

  [[nodiscard]] std::string names(const List& list) const {
    return "(" + names_of_joints(topic_.joint_names[list.index]) + "), " +
           std::to_string(list.messages.size()) + " messages";
  }

 private:
  [[nodiscard]] const std::vector<double>& values(const Stamped<JointValues>& one) const {
    return speeds_ ? one.value.velocities : one.value.positions;
  }
  [[nodiscard]] double value(const List& list, const Stamped<JointValues>& one, std::size_t side) const {
    return values(one)[*list.at.at(side)];
  }

  /// Nothing where the list has no messages on both sides of that time. What two messages before and two
  /// after span, and as much again, is near.
  [[nodiscard]] std::optional<bool> is_between(const List& list, const List& other,
                                               const Stamped<JointValues>& message) const {
    constexpr std::ptrdiff_t kAround = 2;
    const auto after =
        std::lower_bound(list.messages.begin(), list.messages.end(), message.received_ns,
                         [](const auto* one, std::int64_t time) { return one->received_ns < time; });
    if (after - list.messages.begin() < kAround || list.messages.end() - after < kAround) return std::nullopt;
    for (std::size_t side = 0; side < 2; ++side) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (auto near = after - kAround; near != after + kAround; ++near) {
        low = std::min(low, value(list, **near, side));
        high = std::max(high, value(list, **near, side));
      }
      const double found = value(other, message, side), span = high - low;
      if (found < low - span || found > high + span) return false;
    }
    return true;
  }

  const Topic& topic_;
  bool speeds_;
  std::vector<List> lists_;
};

std::optional<Error> settle_joints(RecordingBuilder& builder, Topic& topic, const Joints& joints, bool speeds,
                                   const std::string& odometry, const std::string& where) {
  const JointLists lists(topic, joints, speeds);
  const auto changing = lists.changing();
  for (std::size_t k = 1; k < changing.size(); ++k)
    if (!lists.agree(changing.front(), changing[k]))
      return Error{ErrorCode::usage,
                   "two publishers send different motions of the wheels on " + topic.header.name + ": " +
                       lists.names(changing.front()) + ", and " + lists.names(changing[k]),
                   where,
                   "record with one of them stopped" +
                       (odometry.empty() ? "" : ", or take odometry: --topic odometry=" + odometry)};
  for (const List& list : lists.still()) {
    builder.choose("of the joints on " + topic.header.name + " those of " + lists.names(changing.front()) +
                   ", are taken; those of " + lists.names(list) + ", never change: of a second publisher");
    builder.discard("message", topic.header.name + ": of a second publisher, whose joints never change",
                    list.messages.size());
    std::erase_if(topic.joints, [&](const auto& one) { return one.value.names == list.index; });
  }
  return std::nullopt;
}

template <typename Value>
std::vector<std::size_t> counts_of(const Topic& topic, const std::vector<Stamped<Value>>& messages) {
  std::vector<std::size_t> counts(topic.frames.size());
  for (const auto& one : messages) ++counts[one.frames];
  return counts;
}

/// Two poses of two frames are not two poses of one.
template <typename Value>
void settle_frames(RecordingBuilder& builder, const Topic& topic, std::vector<Stamped<Value>>& messages) {
  const auto counts = counts_of(topic, messages);
  if (std::count_if(counts.begin(), counts.end(), [](std::size_t count) { return count > 0; }) < 2) return;
  const auto most = std::max_element(counts.begin(), counts.end());
  const auto taken = static_cast<std::size_t>(most - counts.begin());
  std::string others;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (k == taken || counts[k] == 0) continue;
    others += (others.empty() ? "" : "; ") + text_of(topic.frames[k]) + ", " + std::to_string(counts[k]) +
              " messages";
    builder.discard("message",
                    topic.header.name + ": of " + text_of(topic.frames[k]) + ", where " +
                        text_of(topic.frames[taken]) + " has more messages",
                    counts[k]);
  }
  builder.choose(topic.header.name + " holds several frames: " + text_of(topic.frames[taken]) + ", " +
                 std::to_string(*most) + " messages, is taken; not taken: " + others);
  std::erase_if(messages, [&](const auto& one) { return one.frames != taken; });
}

}  // namespace

std::string text_of(const Frames& frames) {
  const std::string frame = frames.frame.empty() ? "no frame" : frames.frame;
  return frames.child.empty() ? frame : frames.child + " in " + frame;
}

std::string frames_of_scans(const Topic& topic) {
  const auto counts = counts_of(topic, topic.scans);
  std::string out;
  std::size_t frames = 0;
  for (std::size_t k = 0; k < counts.size(); ++k)
    if (counts[k] > 0) {
      ++frames;
      out +=
          (out.empty() ? "" : ", ") + text_of(topic.frames[k]) + " (" + std::to_string(counts[k]) + " scans)";
    }
  return frames > 1 ? out : "";
}

std::optional<Error> settle_publishers(RecordingBuilder& builder, const Chosen& chosen, bool speeds,
                                       const std::string& where) {
  const std::vector<Topic*> taken = taken_topics(chosen);
  for (Topic* topic : taken) {
    settle_frames(builder, *topic, topic->poses);
    settle_frames(builder, *topic, topic->yaw_rates);
  }
  if (chosen.right_wheel != nullptr) return std::nullopt;
  for (Topic* topic : taken)
    if (topic->kind == Kind::joints)
      if (auto error = settle_joints(builder, *topic, chosen.joints, speeds, chosen.odometry_there, where))
        return error;
  return std::nullopt;
}

}  // namespace odomcalib::ros
