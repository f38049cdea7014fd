#include "daemon/cli/lidar_joint_place.hpp"

#include <expat.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>

#include "daemon/cli/settings.hpp"

namespace odomcalib::cli {
namespace {

constexpr const char* kByHand = "change it by hand, with what export prints; nothing was written";

struct JointOrigin {
  std::size_t at = 0, length = 0;  ///< of its tag, bytes
};

struct Joint {
  std::string name, type, parent, child;
  std::size_t line = 0;
  std::vector<JointOrigin> origins;
};

/// Keeps the joints of a robot, and where their origins stand.
class JointReader {
 public:
  explicit JointReader(XML_Parser parser) : parser_(parser) {}

  void begin(const std::string& element, const XML_Char** attributes) {
    const auto attribute = [&](const char* name) -> std::string {
      for (const XML_Char** one = attributes; *one != nullptr; one += 2)
        if (std::string_view(*one) == name) return one[1];
      return "";
    };
    ++depth_;
    if (element == "joint") {
      joints.push_back({attribute("name"), attribute("type"), "", "", XML_GetCurrentLineNumber(parser_), {}});
      joint_depth_ = depth_;
    }
    if (joint_depth_ == 0 || depth_ != joint_depth_ + 1) return;
    Joint& joint = joints.back();
    if (element == "parent") joint.parent = attribute("link");
    if (element == "child") joint.child = attribute("link");
    if (element == "origin")
      joint.origins.push_back({static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_)),
                               static_cast<std::size_t>(XML_GetCurrentByteCount(parser_))});
  }

  void end() {
    if (depth_ == joint_depth_) joint_depth_ = 0;
    --depth_;
  }

  std::vector<Joint> joints;

 private:
  XML_Parser parser_;
  int depth_ = 0, joint_depth_ = 0;  // 0: within no joint
};

Result<std::vector<Joint>> joints_of(const std::string& urdf, const std::string& where) {
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate(nullptr), &XML_ParserFree);
  if (parser == nullptr) return Error{ErrorCode::io, "out of memory", where, ""};
  JointReader reader(parser.get());
  XML_SetUserData(parser.get(), &reader);
  XML_SetElementHandler(
      parser.get(),
      [](void* to, const XML_Char* name, const XML_Char** attributes) {
        static_cast<JointReader*>(to)->begin(name, attributes);
      },
      [](void* to, const XML_Char*) { static_cast<JointReader*>(to)->end(); });
  if (XML_Parse(parser.get(), urdf.data(), static_cast<int>(urdf.size()), 1) == XML_STATUS_OK)
    return std::move(reader.joints);
  return Error{ErrorCode::format,
               fmt::format("is no XML: {}", XML_ErrorString(XML_GetErrorCode(parser.get()))),
               fmt::format("{}:{}", where, XML_GetCurrentLineNumber(parser.get())),
               "name the URDF or xacro file of the robot; nothing was written"};
}

bool is_named_as_lidar(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  constexpr std::array kNames = {"laser", "lidar", "scan"};
  return std::any_of(kNames.begin(), kNames.end(),
                     [&](const char* word) { return name.find(word) != std::string::npos; });
}

Result<Joint> joint_of(const std::vector<Joint>& joints, const std::string& link, const std::string& where) {
  std::vector<const Joint*> found;
  std::vector<std::string> names, lines;
  for (const Joint& joint : joints) {
    if (!joint.child.empty()) names.push_back(joint.child);
    if (joint.child.empty() || (link.empty() ? !is_named_as_lidar(joint.child) : joint.child != link))
      continue;
    found.push_back(&joint);
    lines.push_back(fmt::format("{} ({})", joint.line, joint.child));
  }
  if (found.size() == 1) return *found.front();
  if (found.empty())
    return Error{
        ErrorCode::format,
        fmt::format("no joint holds {}; links on joints: {}",
                    link.empty() ? "a link with laser, lidar or scan in its name" : "\"" + link + "\"",
                    names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))),
        where, "name the lidar's with --link; nothing was written"};
  return Error{ErrorCode::format,
               fmt::format("{} joints may hold the lidar: lines {}", found.size(), fmt::join(lines, ", ")),
               where, link.empty() ? "name the lidar's link with --link; nothing was written" : kByHand};
}

/// The value of an attribute within the text of its tag; the tag is well-formed.
std::optional<JointOrigin> value_in(std::string_view tag, std::string_view name) {
  constexpr std::string_view kSpace = " \t\r\n";
  for (std::size_t at = tag.find_first_of(kSpace); at < tag.size();) {
    at = tag.find_first_not_of(kSpace, at);
    const std::size_t equals = tag.find('=', at);
    if (equals == std::string_view::npos) break;
    const std::size_t open = tag.find_first_of("\"'", equals);
    const std::size_t close = open == std::string_view::npos ? open : tag.find(tag[open], open + 1);
    if (close == std::string_view::npos) break;
    const auto found = tag.substr(at, tag.find_first_of("= \t\r\n", at) - at);
    if (found == name) return JointOrigin{open + 1, close - open - 1};
    at = close + 1;
  }
  return std::nullopt;
}

struct Triple {
  std::array<TextEdit, 3> places;  ///< of each number, with its text
  std::array<double, 3> values{};
};

/// Three numbers with space between them.
std::optional<Triple> triple_in(std::string_view text, std::size_t at) {
  constexpr std::string_view kSpace = " \t\r\n";
  Triple triple;
  std::size_t from = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    from = text.find_first_not_of(kSpace, from);
    if (from == std::string_view::npos) return std::nullopt;
    const std::size_t end = std::min(text.find_first_of(kSpace, from), text.size());
    const auto value = number_in(text.substr(from, end - from));
    if (!value) return std::nullopt;
    triple.values.at(i) = *value;
    triple.places.at(i) = {at + from, end - from, ""};
    from = end;
  }
  if (text.find_first_not_of(kSpace, from) != std::string_view::npos) return std::nullopt;
  return triple;
}

class OriginEditor {
 public:
  OriginEditor(const std::string& urdf, const JointOrigin& origin, std::string where)
      : tag_(std::string_view(urdf).substr(origin.at, origin.length)),
        begin_(origin.at),
        where_(std::move(where)) {}

  Result<std::vector<TextEdit>> edits(const LidarPlace& lidar) {
    if (auto placed = change("xyz", {lidar.x, lidar.y, std::nullopt}); !placed) return placed.error();
    if (auto turned = change("rpy", {std::nullopt, std::nullopt, lidar.yaw}); !turned) return turned.error();
    return edits_;
  }

 private:
  Error refused(const std::string& what) const { return {ErrorCode::format, what, where_, kByHand}; }

  Result<void> change(const char* name, const std::array<std::optional<double>, 3>& wanted) {
    const auto place = value_in(tag_, name);
    if (!place) return add(name, wanted);
    const auto text = tag_.substr(place->at, place->length);
    if (text.find('$') != std::string_view::npos)
      return refused(fmt::format("{} is an expression of xacro ({})", name, text));
    auto triple = triple_in(text, begin_ + place->at);
    if (!triple) return refused(fmt::format("{} is not three numbers ({})", name, text));
    const auto& [roll, pitch, yaw] = triple->values;
    if (name == std::string_view("rpy") && std::cos(roll) * std::cos(pitch) < settings::kLevelLidar)
      return refused("the lidar leans or is upside down there: its yaw in the plane is another angle");
    for (std::size_t i = 0; i < 3; ++i)
      if (wanted.at(i) && *wanted.at(i) != triple->values.at(i)) {
        triple->places.at(i).text = fmt::format("{}", *wanted.at(i));
        edits_.push_back(triple->places.at(i));
      }
    return {};
  }

  /// Absent values are zero.
  Result<void> add(const char* name, const std::array<std::optional<double>, 3>& wanted) {
    std::array<double, 3> values{};
    for (std::size_t i = 0; i < 3; ++i) values.at(i) = wanted.at(i).value_or(0.0);
    if (values == std::array<double, 3>{}) return {};
    constexpr std::size_t kTag = std::string_view("<origin").size();
    edits_.push_back({begin_ + kTag, 0, fmt::format(" {}=\"{}\"", name, fmt::join(values, " "))});
    return {};
  }

  std::string_view tag_;
  std::size_t begin_;
  std::string where_;
  std::vector<TextEdit> edits_;
};

/// Why the pose on the base is not what this joint states; empty: it is.
std::string hindrance_of(const std::string& urdf, const Joint& joint) {
  for (const std::string& text : {joint.child, joint.parent, joint.type})
    if (text.find('$') != std::string::npos) return "is made by an expression of xacro (" + text + ")";
  if (joint.type != "fixed") return "is not fixed";
  if (joint.parent != "base_link" && joint.parent != "base_footprint")
    return fmt::format("holds it on \"{}\", and its place is known on base_link", joint.parent);
  if (joint.origins.size() != 1)
    return joint.origins.empty() ? "has no <origin>: add <origin xyz=\"0 0 0\" rpy=\"0 0 0\"/>"
                                 : "has several origins";
  // An entity may stand for it.
  const std::size_t at = joint.origins.front().at;
  if (at >= urdf.size() || !std::string_view(urdf).substr(at).starts_with("<origin"))
    return "has its origin from elsewhere";
  return "";
}

}  // namespace

Result<std::vector<TextEdit>> lidar_joint_edits(const std::string& urdf, const LidarPlace& lidar,
                                                const std::string& link, const std::string& where) {
  const auto joints = joints_of(urdf, where);
  if (!joints) return joints.error();
  const auto joint = joint_of(joints.value(), link, where);
  if (!joint) return joint.error();
  const std::string place = fmt::format("{}:{}", where, joint.value().line);
  if (const std::string why = hindrance_of(urdf, joint.value()); !why.empty())
    return Error{ErrorCode::format, fmt::format("the joint \"{}\" {}", joint.value().name, why), place,
                 kByHand};
  const JointOrigin& origin = joint.value().origins.front();
  return OriginEditor(urdf, origin, fmt::format("{}:{}", where, line_of(urdf, origin.at))).edits(lidar);
}

}  // namespace odomcalib::cli
