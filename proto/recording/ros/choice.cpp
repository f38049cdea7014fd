#include "proto/recording/ros/choice.hpp"

#include <algorithm>

namespace odomcalib::ros {
namespace {

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

}  // namespace

Result<Chosen> choose_topics(Collector& collector, const TopicChoices& choices, const std::string& where,
                             std::vector<std::string>& remarks) {
  Choosing choosing(collector, choices, where);
  auto chosen = choosing.choose();
  remarks = choosing.remarks();
  return chosen;
}

}  // namespace odomcalib::ros
