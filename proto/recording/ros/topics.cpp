#include "proto/recording/ros/topics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace odomcalib::ros {
namespace {

// Stamps and times of reception differ by the way of a message through the robot, at most as much as a
// recording may be out of order. Topics whose differences lie farther apart are stamped by clocks that do not
// know each other.
constexpr std::int64_t kClocksApart_ns = 1'000'000'000;
constexpr std::int64_t kStampSecond = 1'000'000'000;  // ns

enum class Part { scan, wheels, wheel_speeds, odometry, gyro, pose };
constexpr std::array<const char*, 6> kParts{"scan", "wheels", "wheel_speeds", "odometry", "gyro", "pose"};

std::optional<Part> part_named(const std::string& name) {
  const auto at = std::find(kParts.begin(), kParts.end(), name);
  if (at == kParts.end()) return std::nullopt;
  return static_cast<Part>(at - kParts.begin());
}

std::string name_of(Part part) { return kParts.at(static_cast<std::size_t>(part)); }

bool serves(const Topic& topic, Part part) {
  switch (part) {
    case Part::scan:
      return topic.kind == Kind::scan;
    case Part::wheels:
    case Part::wheel_speeds:
      return topic.kind == Kind::joints;
    case Part::odometry:
      return topic.kind == Kind::odometry;
    case Part::gyro:
      return topic.kind == Kind::imu;
    case Part::pose:
      return topic.kind == Kind::pose || topic.kind == Kind::odometry;
  }
  return false;
}

std::string types_for(Part part) {
  switch (part) {
    case Part::scan:
      return type_of(Kind::scan);
    case Part::wheels:
    case Part::wheel_speeds:
      return type_of(Kind::joints);
    case Part::odometry:
      return type_of(Kind::odometry);
    case Part::gyro:
      return type_of(Kind::imu);
    case Part::pose:
      break;
  }
  return std::string(type_of(Kind::pose)) + " or " + type_of(Kind::odometry);
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : ", ") + word;
  return out.empty() ? "none" : out;
}

std::string described(const Topic& topic) {
  std::string out =
      topic.header.name + " (" + topic.header.type + ", " + std::to_string(topic.count) + " messages";
  if (!topic.problem.empty()) out += ", not read: " + topic.problem;
  return out + ")";
}

/// Of a robot with hundreds of topics the first ones, those that can be read before all others.
std::string list_of(const std::vector<Topic>& topics) {
  constexpr std::size_t kMostListed = 40;
  std::vector<std::string> words;
  for (const bool readable : {true, false})
    for (const Topic& topic : topics)
      if ((topic.kind != Kind::none) == readable) words.push_back(described(topic));
  if (words.size() > kMostListed) {
    const std::size_t more = words.size() - kMostListed;
    words.resize(kMostListed);
    words.push_back("and " + std::to_string(more) + " more");
  }
  return joined(words);
}

// ---- the joints of the wheels

struct Joints {
  std::string left, right;
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

std::vector<std::string> joint_names(const Topic& topic) {
  std::vector<std::string> names;
  for (const auto& list : topic.joint_names)
    for (const auto& name : list)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

/// The only name with the word in it, or the only one of those that has "wheel" in it as well.
std::optional<std::string> only_with(const std::vector<std::string>& names, const std::string& word) {
  std::vector<std::string> found;
  for (const auto& name : names)
    if (lower(name).find(word) != std::string::npos) found.push_back(name);
  if (found.size() > 1)
    std::erase_if(found, [](const auto& name) { return lower(name).find("wheel") == std::string::npos; });
  if (found.size() != 1) return std::nullopt;
  return found.front();
}

std::optional<Joints> joints_by_name(const Topic& topic) {
  const auto names = joint_names(topic);
  const auto left = only_with(names, "left"), right = only_with(names, "right");
  if (!left || !right || *left == *right) return std::nullopt;
  return Joints{*left, *right};
}

/// Places of both joints in each list of names; nothing where a list lacks one.
std::vector<std::optional<std::array<std::size_t, 2>>> places(const Topic& topic, const Joints& joints) {
  std::vector<std::optional<std::array<std::size_t, 2>>> out;
  for (const auto& names : topic.joint_names) {
    const auto left = std::find(names.begin(), names.end(), joints.left);
    const auto right = std::find(names.begin(), names.end(), joints.right);
    if (left == names.end() || right == names.end())
      out.emplace_back();
    else
      out.push_back(std::array<std::size_t, 2>{static_cast<std::size_t>(left - names.begin()),
                                               static_cast<std::size_t>(right - names.begin())});
  }
  return out;
}

// ---- the choice

struct Chosen {
  std::array<Topic*, kParts.size()> topics{};  // by part
  Joints joints;
  Topic*& operator[](Part part) { return topics.at(static_cast<std::size_t>(part)); }
};

class Choosing {
 public:
  Choosing(Collector& collector, const TopicChoices& choices, const std::string& where)
      : collector_(collector), choices_(choices), where_(where) {}

  Result<Chosen> choose() {
    for (const TopicChoice& choice : choices_)
      if (auto error = take_chosen(choice)) return *error;
    if (auto error = choose_motion()) return *error;
    if (auto error = choose_reference()) return *error;
    choose_gyro();
    return chosen_;
  }

  [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  [[nodiscard]] Error usage(const std::string& what, const std::string& remedy) const {
    return {ErrorCode::usage, what, where_, remedy};
  }
  [[nodiscard]] std::string topics_there() const {
    return "topics there are: " + list_of(collector_.topics());
  }

  std::vector<Topic*> candidates(Part part) {
    std::vector<Topic*> out;
    for (Topic& topic : collector_.topics())
      if (serves(topic, part) && topic.count > topic.malformed) out.push_back(&topic);
    return out;
  }

  [[nodiscard]] Error ambiguous(Part part, const std::vector<Topic*>& topics) const {
    std::vector<std::string> words(topics.size());
    std::transform(topics.begin(), topics.end(), words.begin(),
                   [](const Topic* topic) { return described(*topic); });
    return usage("several topics could be the " + name_of(part) + ": " + joined(words),
                 "choose one: --topic " + name_of(part) + "=" + topics.front()->header.name);
  }

  std::optional<Error> take_chosen(const TopicChoice& choice) {
    const auto part = part_named(choice.part);
    if (!part)
      return usage("there is no part \"" + choice.part + "\"",
                   "parts are scan, wheels, wheel_speeds, "
                   "odometry, gyro and pose");
    const bool both = (*part == Part::wheels && chosen_[Part::wheel_speeds] != nullptr) ||
                      (*part == Part::wheel_speeds && chosen_[Part::wheels] != nullptr);
    if (chosen_[*part] != nullptr || both)
      return usage("two topics are chosen as " + std::string(both ? "wheels and wheel_speeds" : choice.part),
                   "choose one");
    Topic* topic = find(choice.topic, *part);
    if (topic == nullptr) return usage("there is no topic \"" + choice.topic + "\"", topics_there());
    if (!serves(*topic, *part))
      return usage(described(*topic) + " cannot be the " + choice.part,
                   "it needs " + types_for(*part) + "; " + topics_there());
    chosen_[*part] = topic;
    if (topic->kind == Kind::joints) return take_joints(*topic, choice);
    return std::nullopt;
  }

  /// By name; where one name has several types, the one that serves.
  Topic* find(const std::string& name, Part part) {
    Topic* found = nullptr;
    for (Topic& topic : collector_.topics())
      if (topic.header.name == name && (found == nullptr || serves(topic, part))) found = &topic;
    return found;
  }

  std::optional<Error> take_joints(const Topic& topic, const TopicChoice& choice) {
    const auto names = joint_names(topic);
    const std::string remedy = "name both: --topic " + choice.part + "=" + topic.header.name +
                               ":LEFT,RIGHT; joints there are: " + joined(names);
    if (choice.joints.empty()) {
      const auto found = joints_by_name(topic);
      if (!found)
        return usage("the joints of " + topic.header.name + " do not tell which are the wheels", remedy);
      chosen_.joints = *found;
      return std::nullopt;
    }
    for (const auto& joint : choice.joints)
      if (std::find(names.begin(), names.end(), joint) == names.end())
        return usage(topic.header.name + " has no joint \"" + joint + "\"", remedy);
    chosen_.joints = {choice.joints.front(), choice.joints.back()};
    return std::nullopt;
  }

  std::optional<Error> choose_motion() {
    for (const Part part : {Part::wheels, Part::wheel_speeds, Part::odometry})
      if (chosen_[part] != nullptr) return std::nullopt;
    std::vector<Topic*> joints = candidates(Part::wheels);
    std::erase_if(joints, [this](const Topic* topic) { return !has_wheels(*topic); });
    if (joints.size() > 1) return ambiguous(Part::wheels, joints);
    const auto odometry = candidates(Part::odometry);
    if (joints.size() == 1) {
      chosen_[Part::wheels] = joints.front();
      chosen_.joints = *joints_by_name(*joints.front());
      for (const Topic* topic : odometry)
        remarks_.push_back(
            topic->header.name +
            " not taken: wheel angles are finer (take it with --topic odometry=" + topic->header.name + ")");
      return std::nullopt;
    }
    if (odometry.size() > 1) return ambiguous(Part::odometry, odometry);
    if (odometry.empty())
      return Error{
          ErrorCode::empty, "no topic tells the motion of the wheels", where_,
          "record " + types_for(Part::wheels) + " or " + types_for(Part::odometry) + "; " + topics_there()};
    chosen_[Part::odometry] = odometry.front();
    return std::nullopt;
  }

  bool has_wheels(const Topic& topic) {
    if (joints_by_name(topic)) return true;
    remarks_.push_back("the joints of " + topic.header.name + " (" + joined(joint_names(topic)) +
                       ") do not tell which are the wheels; if two are: --topic wheels=" + topic.header.name +
                       ":LEFT,RIGHT");
    return false;
  }

  std::optional<Error> choose_reference() {
    const auto scans = candidates(Part::scan);
    if (chosen_[Part::scan] == nullptr && scans.size() == 1) chosen_[Part::scan] = scans.front();
    if (chosen_[Part::scan] == nullptr && scans.size() > 1 && chosen_[Part::pose] == nullptr)
      return ambiguous(Part::scan, scans);
    if (chosen_[Part::pose] != nullptr) return std::nullopt;
    std::vector<Topic*> poses = candidates(Part::pose);
    std::erase_if(poses, [](const Topic* topic) { return topic->kind != Kind::pose; });
    if (chosen_[Part::scan] == nullptr && poses.size() > 1) return ambiguous(Part::pose, poses);
    if (chosen_[Part::scan] == nullptr && poses.size() == 1) chosen_[Part::pose] = poses.front();
    for (const Topic* topic : poses)
      if (topic != chosen_[Part::pose])
        remarks_.push_back(topic->header.name +
                           " not taken: the scans are the reference (poses of the robot " +
                           "replace them with --topic pose=" + topic->header.name + ")");
    if (chosen_[Part::scan] == nullptr && chosen_[Part::pose] == nullptr)
      remarks_.push_back("no topic with scans or poses; " + topics_there());
    return std::nullopt;
  }

  void choose_gyro() {
    if (chosen_[Part::gyro] != nullptr) return;
    const auto rates = candidates(Part::gyro);
    if (rates.size() == 1) chosen_[Part::gyro] = rates.front();
    if (rates.size() > 1)
      remarks_.push_back("several topics could be the gyro, none is taken; choose one: --topic gyro=" +
                         rates.front()->header.name);
  }

  Collector& collector_;
  const TopicChoices& choices_;
  const std::string& where_;
  Chosen chosen_;
  std::vector<std::string> remarks_;
};

// ---- times

/// Both times of every message of one topic, whatever its kind.
template <typename Visit>
void each_time(const Topic& topic, Visit visit) {
  for (const auto& one : topic.scans) visit(one.stamp_ns, one.received_ns);
  for (const auto& one : topic.joints) visit(one.stamp_ns, one.received_ns);
  for (const auto& one : topic.yaw_rates) visit(one.stamp_ns, one.received_ns);
  for (const auto& one : topic.poses) visit(one.stamp_ns, one.received_ns);
}

/// The time that a header states; that of reception where it states none.
std::int64_t stamp_or_reception(std::int64_t stamp, std::int64_t received) {
  return stamp == 0 ? received : stamp;
}

/// Upper median of reception less stamp; 0 for a topic without messages. Differences that no clock shows
/// wrap.
std::int64_t lag_of(const Topic& topic) {
  std::vector<std::int64_t> lags;
  each_time(topic, [&](std::int64_t stamp, std::int64_t received) {
    lags.push_back(
        static_cast<std::int64_t>(static_cast<std::uint64_t>(received) -
                                  static_cast<std::uint64_t>(stamp_or_reception(stamp, received))));
  });
  if (lags.empty()) return 0;
  const auto middle = lags.begin() + static_cast<std::ptrdiff_t>(lags.size() / 2);
  std::nth_element(lags.begin(), middle, lags.end());
  return *middle;
}

class Clock {
 public:
  explicit Clock(const Chosen& chosen) {
    std::vector<double> lags;
    for (const Topic* topic : chosen.topics)
      if (topic != nullptr) lags.push_back(static_cast<double>(lag_of(*topic)));
    const auto [low, high] = std::minmax_element(lags.begin(), lags.end());
    apart_s_ = lags.empty() ? 0.0 : (*high - *low) / 1e9;
    by_reception_ = apart_s_ > static_cast<double>(kClocksApart_ns) / 1e9;
    for (const Topic* topic : chosen.topics)
      if (topic != nullptr && start_ == 0) set_start(*topic);
  }

  [[nodiscard]] bool by_reception() const { return by_reception_; }
  [[nodiscard]] double apart_s() const { return apart_s_; }
  [[nodiscard]] std::int64_t time_ns(std::int64_t stamp, std::int64_t received) const {
    return by_reception_ ? received : stamp_or_reception(stamp, received);
  }
  /// s after the start of the recording
  template <typename Value>
  double operator()(const Stamped<Value>& one) const {
    const std::int64_t time = time_ns(one.stamp_ns, one.received_ns);
    std::int64_t since = 0;
    if (__builtin_sub_overflow(time, start_, &since)) return std::nan("");
    const std::int64_t seconds = since / kStampSecond, rest = since % kStampSecond;
    return static_cast<double>(seconds) + 1e-9 * static_cast<double>(rest);
  }

 private:
  void set_start(const Topic& topic) {
    each_time(topic, [&](std::int64_t stamp, std::int64_t received) {
      if (start_ == 0) start_ = time_ns(stamp, received) / kStampSecond * kStampSecond;
    });
  }

  double apart_s_ = 0.0;
  bool by_reception_ = false;
  std::int64_t start_ = 0;  // ns
};

// ---- into the builder

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
  Choosing choosing(collector, choices, where);
  auto result = choosing.choose();
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
  for (const std::string& remark : choosing.remarks()) builder.choose(remark);
  return std::nullopt;
}

}  // namespace odomcalib::ros
