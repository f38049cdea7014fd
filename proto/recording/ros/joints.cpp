#include "proto/recording/ros/joints.hpp"

#include <algorithm>

namespace odomcalib::ros {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
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

}  // namespace

std::vector<std::string> joint_names(const Topic& topic) {
  std::vector<std::string> names;
  for (const auto& list : topic.joint_names)
    for (const auto& name : list)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

std::optional<Joints> joints_by_name(const Topic& topic) {
  const auto names = joint_names(topic);
  const auto left = only_with(names, "left"), right = only_with(names, "right");
  if (!left || !right || *left == *right) return std::nullopt;
  return Joints{*left, *right};
}

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

}  // namespace odomcalib::ros
