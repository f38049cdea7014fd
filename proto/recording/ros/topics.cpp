#include "proto/recording/ros/topics.hpp"

#include <algorithm>

#include "proto/recording/ros/choice.hpp"
#include "proto/recording/ros/clock.hpp"

namespace odomcalib::ros {
namespace {

void add_joint_samples(RecordingBuilder& builder, const Topic& topic, const Joints& joints,
                       const Clock& clock, bool speeds) {
  const auto at = places(topic, joints);
  std::size_t without = 0;
  for (const auto& one : topic.joints) {
    const auto& place = at[one.value.names];
    const auto& values = speeds ? one.value.velocities : one.value.positions;
    if (!place || values.empty()) {
      ++without;
      continue;
    }
    const WheelSample sample{clock(one), values[(*place)[0]], values[(*place)[1]]};
    speeds ? builder.add_wheel_speeds(sample) : builder.add_wheels(sample);
  }
  builder.discard("message", topic.header.name + ": without the joints of the wheels", without);
}

/// Some drivers publish speeds only.
bool has_positions(const Topic& topic, const Joints& joints) {
  const auto at = places(topic, joints);
  return std::any_of(topic.joints.begin(), topic.joints.end(),
                     [&](const auto& one) { return at[one.value.names] && !one.value.positions.empty(); });
}

void add_wheels(RecordingBuilder& builder, Chosen& chosen, const Clock& clock) {
  const auto tell = [&](const Topic& topic, const char* part) {
    builder.choose(std::string(part) + ": joints " + chosen.joints.left + " (left) and " +
                   chosen.joints.right + " (right) of " + described(topic));
  };
  if (const Topic* topic = chosen[Part::wheels]) {
    const bool positions = has_positions(*topic, chosen.joints);
    tell(*topic, positions ? "wheels" : "wheel_speeds, there are no angles");
    add_joint_samples(builder, *topic, chosen.joints, clock, !positions);
  }
  if (const Topic* topic = chosen[Part::wheel_speeds]) {
    tell(*topic, "wheel_speeds");
    add_joint_samples(builder, *topic, chosen.joints, clock, true);
  }
}

void add_poses(RecordingBuilder& builder, const Topic& topic, const Clock& clock, Part part) {
  const std::string child = topic.child_frame.empty() ? "" : " of the frame " + topic.child_frame;
  builder.choose(name_of(part) + child + ": " + described(topic));
  for (const auto& one : topic.poses) {
    PoseSample sample = one.value;
    sample.t = clock(one);
    part == Part::odometry ? builder.add_odometry(sample) : builder.add_pose(sample);
  }
}

void add_scans(RecordingBuilder& builder, Topic& topic, const Clock& clock) {
  builder.choose("scan: " + described(topic));
  for (auto& one : topic.scans) {
    Scan scan = std::move(one.value);
    scan.t = clock(one);
    builder.add_scan(std::move(scan));
  }
  topic.scans.clear();
}

void add_gyro(RecordingBuilder& builder, const Topic& topic, const Clock& clock) {
  builder.choose("gyro: " + described(topic));
  for (const auto& one : topic.yaw_rates) builder.add_gyro({clock(one), one.value});
}

void tell_times(RecordingBuilder& builder, const Clock& clock) {
  if (clock.by_reception())
    builder.choose("times of reception: the stamps of these topics lie " + std::to_string(clock.apart_s()) +
                   " s apart, they come from different clocks");
}

/// What was there and is not used.
void tell_rest(RecordingBuilder& builder, const Collector& collector, const Chosen& chosen) {
  for (const Topic& topic : collector.topics()) {
    const bool taken = std::find(chosen.topics.begin(), chosen.topics.end(), &topic) != chosen.topics.end();
    if (topic.kind == Kind::none)
      builder.discard(
          "message", topic.header.type + " is not read" + (topic.problem.empty() ? "" : ": " + topic.problem),
          topic.count);
    else if (!taken)
      builder.discard("message", topic.header.name + " was not taken", topic.count);
    else
      builder.discard("message", topic.header.name + ": does not hold what its type says", topic.malformed);
  }
  for (const auto& [what, count] : collector.discarded()) builder.discard(what.first, what.second, count);
}

}  // namespace

std::optional<Error> fill(RecordingBuilder& builder, Collector& collector, const TopicChoices& choices,
                          const std::string& where) {
  std::vector<std::string> remarks;
  auto result = choose_topics(collector, choices, where, remarks);
  if (!result) return result.error();
  Chosen& chosen = result.value();
  tell_rest(builder, collector, chosen);
  const Clock clock(chosen);
  tell_times(builder, clock);
  add_wheels(builder, chosen, clock);
  if (const Topic* topic = chosen[Part::odometry]) add_poses(builder, *topic, clock, Part::odometry);
  if (const Topic* topic = chosen[Part::pose]) add_poses(builder, *topic, clock, Part::pose);
  if (const Topic* topic = chosen[Part::gyro]) add_gyro(builder, *topic, clock);
  if (Topic* topic = chosen[Part::scan]) add_scans(builder, *topic, clock);
  for (const std::string& remark : remarks) builder.choose(remark);
  return std::nullopt;
}

}  // namespace odomcalib::ros
