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

Kind kind_for(Part part) {
  switch (part) {
    case Part::scan:
      return Kind::scan;
    case Part::wheels:
    case Part::wheel_speeds:
      return Kind::joints;
    case Part::odometry:
      return Kind::odometry;
    case Part::gyro:
      return Kind::imu;
    case Part::pose:
      break;
  }
  return Kind::pose;
}

std::optional<Part> part_by_name(const std::string& topic) {
  struct Row {
    const char* word;
    Part part;
  };
  constexpr std::array<Row, 7> kWords{{{"joint", Part::wheels},
                                       {"scan", Part::scan},
                                       {"laser", Part::scan},
                                       {"lidar", Part::scan},
                                       {"odom", Part::odometry},
                                       {"imu", Part::gyro},
                                       {"gyro", Part::gyro}}};
  const auto row = std::find_if(kWords.begin(), kWords.end(),
                                [&](const Row& one) { return topic.find(one.word) != std::string::npos; });
  return row == kWords.end() ? std::nullopt : std::optional(row->part);
}

std::string types_for(Part part) {
  const std::string type = type_of(kind_for(part));
  return part == Part::pose ? type + " or " + type_of(Kind::odometry) : type;
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : ", ") + word;
  return out.empty() ? "none" : out;
}

std::string described(const Topic& topic) {
  const std::string type = topic.header.type.empty() ? "type not said" : topic.header.type;
  std::string out = topic.header.name + " (" + type + ", " + std::to_string(topic.count) + " messages";
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
