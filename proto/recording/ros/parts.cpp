#include "proto/recording/ros/parts.hpp"

#include <algorithm>

namespace odomcalib::ros {

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

}  // namespace odomcalib::ros
