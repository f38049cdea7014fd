#include "proto/recording/ros/choice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace odomcalib::ros {
namespace {

// Share of their way by which a front and a rear wheel that turn alike may differ. Chosen: a control loop and
// a tyre make a per cent; in bends of a car's tightest radius steered wheels go a tenth farther, on average 3
// %.
constexpr double kUnlike = 0.02;

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
    tell_typeless();
    if (const auto there = candidates(Part::odometry); !there.empty())
      chosen_.odometry_there = there.front()->header.name;
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
      if (topic.kind == kind_for(part) && topic.count > topic.malformed) out.push_back(&topic);
    // Without a rotation in any message it is taken only where there is no other, and told for that.
    const auto is_of_use = [](const Topic* topic) {
      return topic->poses.empty() || std::any_of(topic->poses.begin(), topic->poses.end(),
                                                 [](const auto& one) { return !std::isnan(one.value.yaw); });
    };
    if (std::any_of(out.begin(), out.end(), is_of_use))
      std::erase_if(out, [&](const Topic* topic) { return !is_of_use(topic); });
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
    auto topic = topic_for(choice.topic, *part);
    if (!topic) return topic.error();
    chosen_[*part] = topic.value();
    if (!choice.right_topic.empty()) return take_two_topics(choice, *part);
    if (topic.value()->kind == Kind::joints && *part != Part::pose)
      return take_joints(*topic.value(), choice);
    return std::nullopt;
  }

  Result<Topic*> topic_for(const std::string& name, Part part) {
    const std::string line = "; --topic " + name_of(part) + "=TOPIC";
    Topic* topic = find(name, part);
    if (topic == nullptr) return usage("there is no topic \"" + name + "\"", topics_there() + line);
    if (!serves(*topic, part))
      return usage(described(*topic) + " cannot be the " + name_of(part),
                   "it needs " + types_for(part) + "; " + topics_there() + line);
    if (topic->count > 0 && topic->count == topic->malformed)
      return usage(described(*topic) + " cannot be the " + name_of(part) + ": no message of it is one",
                   topics_there() + line);
    return topic;
  }

  std::optional<Error> take_two_topics(const TopicChoice& choice, Part part) {
    auto right = topic_for(choice.right_topic, part);
    if (!right) return right.error();
    chosen_.right_wheel = right.value();
    const std::array<const Topic*, 2> topics{chosen_[part], right.value()};
    std::array<std::string, 2> joints;
    for (std::size_t side = 0; side < 2; ++side) {
      const auto names = joint_names(*topics.at(side));
      const auto wheel = wheel_by_name(*topics.at(side));
      if (names.size() != 1 && !wheel)
        return usage("the joints of " + topics.at(side)->header.name + " (" + names_of_joints(names) +
                         ") do not say which is the wheel",
                     "record a topic with the joint of one wheel");
      joints.at(side) = wheel ? wheel->joint : names.front();
    }
    chosen_.joints = {joints[0], joints[1]};
    return std::nullopt;
  }

  /// By name; where one name has several types, the one that serves.
  Topic* find(const std::string& name, Part part) {
    Topic* found = nullptr;
    for (Topic& topic : collector_.topics())
      if (topic.header.name == name && (found == nullptr || serves(topic, part))) found = &topic;
    return found;
  }

  /// "the joints of /joint_states (a, b) do not say which are the wheels: --topic
  /// wheels=/joint_states:LEFT,RIGHT"
  static std::string untold(const Topic& topic, const std::string& part) {
    return "the joints of " + topic.header.name + " (" + names_of_joints(topic) +
           ") do not say which are the wheels: --topic " + part + "=" + topic.header.name + ":LEFT,RIGHT";
  }

  std::optional<Error> take_joints(const Topic& topic, const TopicChoice& choice) {
    const auto names = joint_names(topic);
    const auto found = wheels_by_name(topic);
    if (choice.joints.empty()) {
      if (!found) return usage(untold(topic, choice.part), "");
      take_named(topic, *found, choice.part);
      return std::nullopt;
    }
    for (const auto& joint : choice.joints)
      if (std::find(names.begin(), names.end(), joint) == names.end())
        return usage(topic.header.name + " has no joint \"" + joint + "\"",
                     "joints there are: " + names_of_joints(names) + "; --topic " + choice.part + "=" +
                         topic.header.name + ":LEFT,RIGHT");
    chosen_.joints = {choice.joints.front(), choice.joints.back()};
    if (found) tell_unlike(topic, *found);
    return std::nullopt;
  }

  void take_named(const Topic& topic, const NamedWheels& wheels, const std::string& part) {
    chosen_.joints = wheels.taken;
    if (!wheels.front) return;
    remarks_.push_back("of the four wheels of " + topic.header.name +
                       " the rear pair is taken; the front pair: --topic " + part + "=" + topic.header.name +
                       ":" + wheels.front->left + "," + wheels.front->right);
    tell_unlike(topic, wheels);
  }

  /// Wheels of one side that are driven alike and not steered turn alike.
  void tell_unlike(const Topic& topic, const NamedWheels& wheels) {
    const auto shares = unlike(topic, wheels);
    if (!shares || std::max((*shares)[0], (*shares)[1]) <= kUnlike) return;
    const auto percent = [](double share) { return std::to_string(std::lround(100.0 * share)) + " %"; };
    remarks_.push_back("the front wheels of " + topic.header.name +
                       " turn otherwise than the rear wheels: by " + percent((*shares)[0]) +
                       " of their way on the left and " + percent((*shares)[1]) +
                       " on the right; they are steered, slip, or the robot moves sideways");
  }

  std::optional<Error> choose_motion() {
    for (const Part part : {Part::wheels, Part::wheel_speeds, Part::odometry})
      if (chosen_[part] != nullptr) return std::nullopt;
    const std::vector<Topic*> all = candidates(Part::wheels);
    std::vector<Topic*> joints = all;
    std::erase_if(joints, [](const Topic* topic) { return !wheels_by_name(*topic); });
    if (joints.size() > 1) return ambiguous(Part::wheels, joints);
    const auto odometry = candidates(Part::odometry);
    if (joints.size() == 1) {
      chosen_[Part::wheels] = joints.front();
      take_named(*joints.front(), *wheels_by_name(*joints.front()), name_of(Part::wheels));
    } else if (!choose_two_topics(all)) {
      tell_untold(all);
      if (odometry.size() > 1) return ambiguous(Part::odometry, odometry);
      if (odometry.empty()) return no_motion(all);
      chosen_[Part::odometry] = odometry.front();
      return std::nullopt;
    }
    for (const Topic* topic : odometry)
      remarks_.push_back(
          topic->header.name +
          " not taken: wheel angles are finer (take it with --topic odometry=" + topic->header.name + ")");
    return std::nullopt;
  }

  /// Where one topic has the left wheel only and one the right wheel only.
  bool choose_two_topics(const std::vector<Topic*>& topics) {
    std::array<std::vector<std::pair<Topic*, std::string>>, 2> wheels;  // by Side
    for (Topic* topic : topics)
      if (const auto wheel = wheel_by_name(*topic))
        wheels.at(static_cast<std::size_t>(wheel->side)).emplace_back(topic, wheel->joint);
    if (wheels[0].size() != 1 || wheels[1].size() != 1) return false;
    chosen_[Part::wheels] = wheels[0].front().first;
    chosen_.right_wheel = wheels[1].front().first;
    chosen_.joints = {wheels[0].front().second, wheels[1].front().second};
    return true;
  }

  void tell_untold(const std::vector<Topic*>& topics) {
    for (const Topic* topic : topics) untold_.push_back(untold(*topic, name_of(Part::wheels)));
    if (!candidates(Part::odometry).empty()) remarks_.insert(remarks_.end(), untold_.begin(), untold_.end());
  }

  [[nodiscard]] Error no_motion(const std::vector<Topic*>& joints) const {
    // The last one ends the error: it has the line to type.
    if (!joints.empty()) {
      std::string what;
      for (const auto& one : untold_) what += (what.empty() ? "" : "; or ") + one;
      return usage(what, "");
    }
    if (const auto typeless = without_type(); !typeless.empty())
      return usage(
          unsaid(typeless),
          "record with the packages of the messages installed, or say what they are: " + lines_for(typeless));
    return {ErrorCode::empty, "no topic holds the motion of the wheels", where_,
            "record " + types_for(Part::wheels) + " or " + types_for(Part::odometry) + "; " + topics_there()};
  }

  // ---- topics of which the file does not say what they are

  [[nodiscard]] std::vector<std::string> without_type() const {
    std::vector<std::string> names;
    for (const Topic& topic : collector_.topics())
      if (topic.header.type.empty() && topic.count > 0) names.push_back(topic.header.name);
    return names;
  }

  static std::string unsaid(const std::vector<std::string>& names) {
    constexpr std::size_t kMostListed = 12;
    std::string out = names.front();
    const std::size_t listed = std::min(names.size(), kMostListed);
    for (std::size_t k = 1; k < listed; ++k) out += (k + 1 == names.size() ? " and " : ", ") + names[k];
    if (listed < names.size()) out += " and " + std::to_string(names.size() - listed) + " more";
    return "the file does not say what " + out + (names.size() > 1 ? " are" : " is") + " (no schema)";
  }

  /// Options to type, as far as they follow from the names of the topics; else with a word for the name.
  static std::string lines_for(const std::vector<std::string>& names) {
    std::string lines;
    std::array<bool, kParts.size()> used{};
    for (const auto& name : names)
      if (const auto part = part_by_name(name); part && !used.at(static_cast<std::size_t>(*part))) {
        used.at(static_cast<std::size_t>(*part)) = true;
        lines += (lines.empty() ? "" : " ") + ("--topic " + name_of(*part)) + "=" + name;
      }
    return lines.empty() ? "--topic wheels=TOPIC --topic scan=TOPIC" : lines;
  }

  /// Reports topics that could be a part that is missing, or finer than the one that was taken.
  void tell_typeless() {
    const bool has_reference = chosen_[Part::scan] != nullptr || chosen_[Part::pose] != nullptr;
    const bool has_wheels = chosen_[Part::wheels] != nullptr || chosen_[Part::wheel_speeds] != nullptr;
    std::vector<std::string> names = without_type();
    std::erase_if(names, [&](const auto& name) {
      const auto part = part_by_name(name);
      return !(part == Part::scan && !has_reference) && !(part == Part::wheels && !has_wheels);
    });
    if (!names.empty())
      remarks_.push_back(unsaid(names) + "; say " + (names.size() > 1 ? "what they are: " : "what it is: ") +
                         lines_for(names));
  }

  std::optional<Error> choose_reference() {
    const auto scans = candidates(Part::scan);
    if (chosen_[Part::scan] == nullptr && scans.size() == 1) chosen_[Part::scan] = scans.front();
    if (chosen_[Part::scan] == nullptr && scans.size() > 1 && chosen_[Part::pose] == nullptr)
      return ambiguous(Part::scan, scans);
    if (chosen_[Part::pose] != nullptr) return std::nullopt;
    const std::vector<Topic*> poses = candidates(Part::pose);
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
  std::vector<std::string> untold_;  // topics whose joints do not tell the wheels
};

}  // namespace

std::vector<Topic*> taken_topics(const Chosen& chosen) {
  std::vector<Topic*> out;
  const auto add = [&](Topic* topic) {
    if (topic != nullptr && std::find(out.begin(), out.end(), topic) == out.end()) out.push_back(topic);
  };
  for (Topic* topic : chosen.topics) add(topic);
  add(chosen.right_wheel);
  return out;
}

std::map<std::string, Kind> kinds_of(const TopicChoices& choices) {
  std::map<std::string, Kind> kinds;
  for (const TopicChoice& choice : choices)
    if (const auto part = part_named(choice.part)) {
      kinds[choice.topic] = kind_for(*part);
      if (!choice.right_topic.empty()) kinds[choice.right_topic] = kind_for(*part);
    }
  return kinds;
}

Result<Chosen> choose_topics(Collector& collector, const TopicChoices& choices, const std::string& where,
                             std::vector<std::string>& remarks) {
  Choosing choosing(collector, choices, where);
  auto chosen = choosing.choose();
  remarks = choosing.remarks();
  return chosen;
}

}  // namespace odomcalib::ros
