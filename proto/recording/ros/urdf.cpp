#include "proto/recording/ros/urdf.hpp"

#include <tinyxml2.h>

#include <cmath>
#include <locale>
#include <sstream>
#include <string_view>

namespace odomcalib::ros {
namespace {

// Joints of a description; a robot has tens. Chosen.
constexpr std::size_t kMostJoints = 4096;

/// "1 2 3"; zeros where it is not stated.
std::optional<std::array<double, 3>> three_numbers(const char* text) {
  std::array<double, 3> out{};
  if (text == nullptr) return out;
  std::istringstream numbers{std::string(text)};
  numbers.imbue(std::locale::classic());
  for (double& one : out)
    if (!(numbers >> one) || !std::isfinite(one)) return std::nullopt;
  return out;
}

/// Quaternion of turns about the fixed axes x, y, z, one after the other: rad.
std::array<double, 4> quaternion_of(const std::array<double, 3>& rpy) {
  const double cr = std::cos(0.5 * rpy[0]), sr = std::sin(0.5 * rpy[0]);
  const double cp = std::cos(0.5 * rpy[1]), sp = std::sin(0.5 * rpy[1]);
  const double cy = std::cos(0.5 * rpy[2]), sy = std::sin(0.5 * rpy[2]);
  return {sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy,
          cr * cp * cy + sr * sp * sy};
}

/// The link that a joint names as its parent or child; empty: none.
std::string link_of(const tinyxml2::XMLElement& joint, const char* which) {
  const auto* element = joint.FirstChildElement(which);
  const char* link = element != nullptr ? element->Attribute("link") : nullptr;
  return link != nullptr ? link : "";
}

bool is_fixed(const tinyxml2::XMLElement& joint) {
  const char* type = joint.Attribute("type");
  return type != nullptr && std::string_view(type) == "fixed";
}

std::optional<Transform> pose_of(const tinyxml2::XMLElement& joint) {
  const auto* origin = joint.FirstChildElement("origin");
  const auto position = three_numbers(origin != nullptr ? origin->Attribute("xyz") : nullptr);
  const auto rpy = three_numbers(origin != nullptr ? origin->Attribute("rpy") : nullptr);
  Transform one{link_of(joint, "parent"), link_of(joint, "child"), {}, {}};
  if (!position || !rpy || one.frame.empty() || one.child.empty()) return std::nullopt;
  one.position = *position;
  one.quaternion = quaternion_of(*rpy);
  return one;
}

}  // namespace

std::optional<Transforms> fixed_joints(const std::string& urdf) {
  tinyxml2::XMLDocument document;
  if (document.Parse(urdf.c_str(), urdf.size()) != tinyxml2::XML_SUCCESS) return std::nullopt;
  const auto* robot = document.FirstChildElement("robot");
  if (robot == nullptr) return std::nullopt;
  Transforms joints;
  for (const auto* joint = robot->FirstChildElement("joint");
       joint != nullptr && joints.usable.size() < kMostJoints; joint = joint->NextSiblingElement("joint")) {
    if (!is_fixed(*joint)) continue;
    if (auto one = pose_of(*joint))
      joints.usable.push_back(std::move(*one));
    else
      ++joints.unusable;
  }
  return joints;
}

}  // namespace odomcalib::ros
