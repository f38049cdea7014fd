#include "proto/recording/ros/topics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "proto/recording/ros/choice.hpp"
#include "proto/recording/ros/clock.hpp"
#include "proto/recording/ros/mounting.hpp"
#include "proto/recording/ros/publishers.hpp"

namespace odomcalib::ros {
namespace {

// ns, by which a recorder of several threads writes messages in another order than it had them. Chosen.
constexpr std::int64_t kReceivedApart_ns = 100'000'000;

constexpr const char* kNotItsType = ": does not hold what its type says";

/// Whether there are numbers of each wheel that any message names.
bool has_values(const Topic& topic, const std::vector<Places>& at, bool speeds) {
  std::array<bool, 2> named{}, valued{};
  for (const auto& one : topic.joints)
    for (std::size_t side = 0; side < named.size(); ++side)
      if (const auto& place = at[one.value.names].at(side)) {
        const auto& values = speeds ? one.value.velocities : one.value.positions;
        named.at(side) = true;
        valued.at(side) = valued.at(side) || (!values.empty() && std::isfinite(values[*place]));
      }
  return named != std::array{false, false} && valued == named;
}

/// Whether the angles of the wheels are one and the same in all messages that have them, while there are
/// speeds.
bool angles_stand_still(const Topic& topic, const std::vector<Places>& at) {
  std::array<std::optional<double>, 2> first;
  bool moves = false;
  for (const auto& one : topic.joints) {
    for (std::size_t side = 0; side < first.size(); ++side) {
      const auto& place = at[one.value.names].at(side);
      if (!place || one.value.positions.empty()) continue;
      const double angle = one.value.positions[*place];
      if (!first.at(side) && std::isfinite(angle)) first.at(side) = angle;
      if (std::isfinite(angle) && angle != *first.at(side)) return false;
      moves = moves || (!one.value.velocities.empty() && std::abs(one.value.velocities[*place]) > 0.0);
    }
  }
  return moves;
}

/// Some drivers publish speeds only, or fill in the angles with a number, or with none.
bool speeds_only(const Chosen& chosen) {
  const auto lacks_angles = [](const Topic* topic, const Joints& joints) {
    if (topic == nullptr) return false;
    const auto at = places(*topic, joints);
    return has_values(*topic, at, true) && (!has_values(*topic, at, false) || angles_stand_still(*topic, at));
  };
  const Joints& joints = chosen.joints;
  if (chosen.right_wheel == nullptr) return lacks_angles(chosen[Part::wheels], joints);
  return lacks_angles(chosen[Part::wheels], {joints.left, ""}) ||
         lacks_angles(chosen.right_wheel, {"", joints.right});
}

void add_half(RecordingBuilder& builder, Side side, SideSample sample, bool speeds) {
  speeds ? builder.add_wheel_speed(side, sample) : builder.add_wheel(side, sample);
}

/// Samples of both wheels. One wheel without the other counts only where no message has both.
void add_joint_samples(RecordingBuilder& builder, const Topic& topic, const Joints& joints,
                       const Clock& clock, bool speeds) {
  const auto at = places(topic, joints);
  const bool halves = std::none_of(topic.joints.begin(), topic.joints.end(), [&](const auto& one) {
    return at[one.value.names][0] && at[one.value.names][1];
  });
  const char* part = name_of(speeds ? MotionSource::wheel_speeds : MotionSource::wheels);
  std::size_t without = 0, empty = 0;
  for (const auto& one : topic.joints) {
    const Places& place = at[one.value.names];
    const auto& values = speeds ? one.value.velocities : one.value.positions;
    const bool has_wheels = halves ? place[0] || place[1] : place[0] && place[1];
    if (has_wheels && one.value.positions.empty() && one.value.velocities.empty()) {
      ++empty;
    } else if (!has_wheels || values.empty()) {
      ++without;
    } else if (place[0] && place[1]) {
      const WheelSample sample{clock(one), values[*place[0]], values[*place[1]]};
      speeds ? builder.add_wheel_speeds(sample) : builder.add_wheels(sample);
    } else {
      const Side side = place[0] ? Side::left : Side::right;
      add_half(builder, side, {clock(one), values[place[0] ? *place[0] : *place[1]]}, speeds);
    }
  }
  builder.discard("message", topic.header.name + ": without the joints of the wheels", without);
  builder.discard(part, topic.header.name + ": no values for the joints of the wheels", empty);
  builder.discard("message", topic.header.name + kNotItsType, topic.malformed);  // may be other joints
}

void add_wheels(RecordingBuilder& builder, const Chosen& chosen, const Clock& clock, bool no_angles) {
  const Topic* speeds = chosen[Part::wheel_speeds];
  const Topic* topic = speeds != nullptr ? speeds : chosen[Part::wheels];
  if (topic == nullptr) return;
  const std::string part = speeds != nullptr ? "wheel_speeds"
                           : no_angles       ? "wheel_speeds, there are no angles or they never change"
                                             : "wheels";
  const Joints& joints = chosen.joints;
  if (const Topic* right = chosen.right_wheel) {
    builder.choose(part + ": joint " + joints.left + " (left) of " + described(*topic) + " and joint " +
                   joints.right + " (right) of " + described(*right));
    add_joint_samples(builder, *topic, {joints.left, ""}, clock, no_angles);
    add_joint_samples(builder, *right, {"", joints.right}, clock, no_angles);
    return;
  }
  builder.choose(part + ": joints " + joints.left + " (left) and " + joints.right + " (right) of " +
                 described(*topic));
  add_joint_samples(builder, *topic, joints, clock, no_angles);
}

std::string no_rotation(const Topic& topic) {
  return "the orientation in " + topic.header.name +
         " is no rotation: its quaternion is not of length 1 (all zero, or yaw written into z)";
}

void add_poses(RecordingBuilder& builder, const Topic& topic, const Clock& clock, Part part) {
  const Frames frames = topic.poses.empty() ? Frames{} : topic.frames[topic.poses.front().frames];
  const std::string child = frames.child.empty() ? "" : " of the frame " + frames.child;
  builder.choose(name_of(part) + child + ": " + described(topic));
  builder.discard(name_of(part), topic.header.name + kNotItsType, topic.malformed);
  for (const auto& one : topic.poses) {
    PoseSample sample = one.value;
    sample.t = clock(one);
    if (std::isnan(sample.yaw))
      builder.discard(name_of(part), no_rotation(topic));
    else if (part == Part::odometry)
      builder.add_odometry(sample);
    else
      builder.add_pose(sample);
  }
}

void add_scans(RecordingBuilder& builder, Topic& topic, const Clock& clock) {
  builder.choose("scan: " + described(topic));
  const std::string several = frames_of_scans(topic);
  if (!several.empty()) builder.choose(topic.header.name + " has scans of several frames: " + several);
  builder.discard("scan", topic.header.name + kNotItsType, topic.malformed);
  for (auto& one : topic.scans) {
    Scan scan = std::move(one.value);
    scan.t = clock(one);
    if (!several.empty()) scan.sensor = topic.frames[one.frames].frame;
    builder.add_scan(std::move(scan));
  }
  topic.scans.clear();
}

void add_gyro(RecordingBuilder& builder, const Topic& topic, const Clock& clock) {
  builder.choose("gyro: " + described(topic));
  builder.discard("gyro", topic.header.name + kNotItsType, topic.malformed);
  for (const auto& one : topic.yaw_rates) builder.add_gyro({clock(one), one.value});
}

/// The one frame of a topic; nothing where it has several, or names none.
std::string only_frame(const Topic& topic) {
  return topic.frames.size() == 1 ? topic.frames.front().frame : std::string();
}

/// Where odometry says that the base is, and what REP 105 and REP 120 call it.
std::vector<std::string> frames_of_base(const std::vector<Topic>& topics) {
  std::vector<std::string> bases;
  for (const Topic& topic : topics)
    for (const Frames& frames : topic.frames)
      if (topic.kind == Kind::odometry && !frames.child.empty()) bases.push_back(frames.child);
  bases.insert(bases.end(), {"base_footprint", "base_link"});
  return bases;
}

std::vector<Transform> transforms_of(const std::vector<Topic>& topics, Kind kind) {
  std::vector<Transform> all;
  for (const Topic& topic : topics)
    if (topic.kind == kind) all.insert(all.end(), topic.transforms.begin(), topic.transforms.end());
  return all;
}

/// The nominal pose of the lidar, where the recording has it and its user states none: by what was published,
/// or by the robot's description with that.
void add_mounting(RecordingBuilder& builder, const std::vector<Topic>& topics, const std::string& lidar) {
  const auto published = transforms_of(topics, Kind::transforms);
  auto all = transforms_of(topics, Kind::description);
  const bool is_described = !all.empty();
  if ((published.empty() && !is_described) || lidar.empty()) return;
  std::string by = "/tf_static";
  auto found = mounting_of(published, frames_of_base(topics), lidar);
  if (!found && is_described) {
    by = published.empty() ? "/robot_description" : "/robot_description and /tf_static";
    // Where both place a frame, the published place counts, which is the later one.
    all.insert(all.end(), published.begin(), published.end());
    found = mounting_of(all, frames_of_base(topics), lidar);
  }
  const char* lead = by.ends_with("description") || !is_described ? " does" : " do";
  if (!found) return builder.choose(by + lead + " not lead from the base to the lidar's frame " + lidar);
  if (!found->upright)
    return builder.choose("by " + by + " the lidar's frame " + lidar +
                          " is not level or upside down: its pose there is not taken; state lidar_pose");
  builder.mount_lidar(found->pose);
  std::array<char, 96> pose{};
  (void)std::snprintf(pose.data(), pose.size(), "[%.3f, %.3f, %.4f] in ", found->pose[0], found->pose[1],
                      found->pose[2]);
  builder.choose("lidar_pose = " + std::string(pose.data()) + found->base + " by " + by +
                 ", unless --robot states one");
}

/// Description of a topic that cannot be read.
std::string unread(const Topic& topic) {
  if (topic.header.type.empty()) return topic.header.name + ": the file does not say what it is (no schema)";
  return topic.header.type + " is not read" + (topic.problem.empty() ? "" : ": " + topic.problem);
}

/// Reports everything that was there and is not used.
void tell_rest(RecordingBuilder& builder, const Collector& collector, const Chosen& chosen) {
  const auto taken = taken_topics(chosen);
  for (const Topic& topic : collector.topics()) {
    const bool is_taken = std::find(taken.begin(), taken.end(), &topic) != taken.end();
    const std::string& name = topic.header.name;
    builder.discard("transform", name + ": position or rotation missing or impossible", topic.unusable);
    if (topic.kind == Kind::none)
      builder.discard("message", unread(topic), topic.count);
    else if (tells_mounting(topic.kind))  // no samples, and always read
      builder.discard("message", name + kNotItsType, topic.malformed);
    else if (!is_taken)
      builder.discard("message", name + " was not taken", topic.count);
  }
  for (const auto& [what, count] : collector.discarded()) builder.discard(what.first, what.second, count);
}

/// Where a bridge mixed both, ROS 2 is what goes on running.
Middleware middleware_of(const Chosen& chosen) {
  const auto taken = taken_topics(chosen);
  const bool is_cdr = std::any_of(taken.begin(), taken.end(),
                                  [](const Topic* topic) { return topic->encoding == Encoding::cdr; });
  return is_cdr ? Middleware::ros2 : Middleware::ros1;
}

template <typename Value>
bool is_in_order(const std::vector<Stamped<Value>>& messages) {
  for (std::size_t k = 1; k < messages.size(); ++k)
    if (messages[k].received_ns < messages[k - 1].received_ns - kReceivedApart_ns) return false;
  return true;
}

/// Files that were put together from others hold messages in any order.
bool is_in_order_of_reception(const Chosen& chosen) {
  const auto topics = taken_topics(chosen);
  return std::all_of(topics.begin(), topics.end(), [](const Topic* topic) {
    return is_in_order(topic->scans) && is_in_order(topic->joints) && is_in_order(topic->poses);
  });
}

/// Odometry that does not say how the robot moved.
std::optional<Error> odometry_fault(const Topic& topic, const std::string& where) {
  const auto& poses = topic.poses;
  const auto lost = static_cast<std::size_t>(
      std::count_if(poses.begin(), poses.end(), [](const auto& one) { return std::isnan(one.value.yaw); }));
  if (2 * lost > poses.size())
    return Error{ErrorCode::format,
                 no_rotation(topic) + ", in " + std::to_string(lost) + " of " + std::to_string(poses.size()) +
                     " messages",
                 where, "send z = sin(yaw / 2) and w = cos(yaw / 2), and record again"};
  // Drivers that leave the integration to others fill in the twist alone.
  const bool stands = std::all_of(poses.begin(), poses.end(), [&](const auto& one) {
    const PoseSample &pose = one.value, &first = poses.front().value;
    return pose.x == first.x && pose.y == first.y && pose.yaw == first.yaw;
  });
  if (topic.moves && stands)
    return Error{ErrorCode::empty, "the pose in " + topic.header.name + " never changes, its twist does",
                 where, "record odometry whose pose is integrated, or the joint states of the wheels"};
  return std::nullopt;
}

void fit_stamps(RecordingBuilder& builder, const Chosen& chosen) {
  for (Topic* topic : taken_topics(chosen))
    if (const std::size_t count = fit_missing_stamps(*topic); count > 0)
      builder.choose(topic->header.name + ": " + std::to_string(count) + " of " +
                     std::to_string(topic->count) +
                     " messages have no stamp (0); they are put where they were received among the others");
}

std::optional<Error> fill_chosen(RecordingBuilder& builder, Chosen& chosen, const std::string& where) {
  const bool no_angles = chosen[Part::wheel_speeds] != nullptr || speeds_only(chosen);
  builder.take_from(middleware_of(chosen));
  if (auto error = settle_publishers(builder, chosen, no_angles, where)) return error;
  for (const Part part : {Part::odometry, Part::pose})
    if (const Topic* topic = chosen[part]; topic != nullptr && topic->kind == Kind::odometry)
      if (auto error = odometry_fault(*topic, where)) return error;
  fit_stamps(builder, chosen);
  const Clock clock(chosen);
  if (!clock.remark().empty()) builder.choose(clock.remark());
  builder.count_from(clock.start());
  if (!is_in_order_of_reception(chosen)) builder.distrust_order();
  add_wheels(builder, chosen, clock, no_angles);
  if (const Topic* topic = chosen[Part::odometry]) add_poses(builder, *topic, clock, Part::odometry);
  if (const Topic* topic = chosen[Part::pose]) add_poses(builder, *topic, clock, Part::pose);
  if (const Topic* topic = chosen[Part::gyro]) add_gyro(builder, *topic, clock);
  if (Topic* topic = chosen[Part::scan]) add_scans(builder, *topic, clock);
  if (!builder.has_motion()) return builder.no_motion(where);
  return std::nullopt;
}

}  // namespace

std::optional<Error> fill(RecordingBuilder& builder, Collector& collector, const TopicChoices& choices,
                          const std::string& where) {
  std::vector<std::string> remarks;
  auto chosen = choose_topics(collector, choices, where, remarks);
  std::optional<Error> error;
  if (chosen) {
    tell_rest(builder, collector, chosen.value());
    if (const Topic* scans = chosen.value()[Part::scan])
      add_mounting(builder, collector.topics(), only_frame(*scans));
    error = fill_chosen(builder, chosen.value(), where);
  } else {
    error = chosen.error();
  }
  for (const std::string& remark : remarks) builder.choose(remark);
  if (error) return builder.with_remarks(*error);
  return std::nullopt;
}

}  // namespace odomcalib::ros
