#include "proto/recording/ros/joints.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <set>
#include <string_view>

#include "proto/recording/ros/parts.hpp"

namespace odomcalib::ros {
namespace {

// ns, over which the ways of two wheels are compared. Chosen: encoders and stamps differ by less than the
// wheels turn in that time.
constexpr std::int64_t kCompared_ns = 500'000'000;

enum class Axle : std::uint8_t { unknown, front, rear };

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) { return lower(c); });
  return text;
}

bool has_any(const std::string& name, std::initializer_list<std::string_view> parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [text = lower(name)](auto part) { return text.find(part) != std::string::npos; });
}

/// "drivewhl_fl_joint" and "wheelFL" in their words.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  bool was_lower = false;
  for (const char c : name) {
    const bool is_upper = c >= 'A' && c <= 'Z';
    const bool is_letter = is_upper || (c >= 'a' && c <= 'z');
    if (!is_letter || (is_upper && was_lower)) words.emplace_back();
    if (is_letter) words.back() += lower(c);
    was_lower = is_letter && !is_upper;
  }
  return words;
}

bool has_word(const std::string& name, std::initializer_list<std::string_view> words) {
  const auto own = words_of(name);
  return std::any_of(own.begin(), own.end(), [&](const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  });
}

bool is_driven(const std::string& name) {
  return has_any(name, {"wheel", "whl", "motor", "drive", "tire", "tyre"});
}

bool has_side(const std::string& name, Side side) {
  const bool left = has_any(name, {"left"}), right = has_any(name, {"right"});
  if (left || right) return side == Side::left ? left : right;
  // Letters stand for sides only where a wheel is meant.
  if (!is_driven(name)) return false;
  return side == Side::left ? has_word(name, {"l", "fl", "rl", "bl", "lf", "lr", "lb", "lwheel"})
                            : has_word(name, {"r", "fr", "rr", "br", "rf", "rb", "rwheel"});
}

Axle axle_of(const std::string& name) {
  const bool front = has_any(name, {"front"}) || has_word(name, {"fl", "fr", "lf", "rf"});
  const bool rear =
      has_any(name, {"rear", "back"}) || has_word(name, {"rl", "rr", "bl", "br", "lr", "lb", "rb"});
  if (front == rear) return Axle::unknown;
  return front ? Axle::front : Axle::rear;
}

/// Those on one side; where there are several, those that are called wheels, and of these the driven ones.
std::vector<std::string> on_side(const std::vector<std::string>& names, Side side) {
  std::vector<std::string> found;
  std::copy_if(names.begin(), names.end(), std::back_inserter(found),
               [side](const auto& name) { return has_side(name, side); });
  const auto keep = [&](auto wanted) {
    if (found.size() > 1 && std::any_of(found.begin(), found.end(), wanted))
      std::erase_if(found, [&](const auto& name) { return !wanted(name); });
  };
  keep([](const auto& name) { return has_any(name, {"wheel"}); });
  keep([](const auto& name) { return !has_any(name, {"caster", "castor", "steer", "swivel"}); });
  return found;
}

std::optional<NamedWheels> two_pairs(const std::vector<std::string>& left,
                                     const std::vector<std::string>& right) {
  std::array<std::optional<Joints>, 2> pairs;  // front, rear
  for (const auto& l : left)
    for (const auto& r : right)
      if (const Axle axle = axle_of(l); axle != Axle::unknown && axle == axle_of(r))
        pairs.at(axle == Axle::front ? 0 : 1) = Joints{l, r};
  if (!pairs[0] || !pairs[1]) return std::nullopt;
  return NamedWheels{*pairs[1], pairs[0]};
}

double step(double from, double to) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  // Some drivers keep angles within one turn.
  return std::abs(to - from) > std::numbers::pi ? std::remainder(to - from, kTurn) : to - from;
}

/// Way of one joint between two messages, in rad; by its speed where there are no angles.
double way(const Stamped<JointValues>& from, const Stamped<JointValues>& to, std::size_t joint) {
  if (!from.value.positions.empty() && !to.value.positions.empty())
    return step(from.value.positions[joint], to.value.positions[joint]);
  if (from.value.velocities.empty()) return 0.0;
  return from.value.velocities[joint] * 1e-9 *
         (static_cast<double>(to.received_ns) - static_cast<double>(from.received_ns));
}

/// Ways of a front and a rear wheel, compared piece by piece.
struct Comparison {
  double front = 0.0, rear = 0.0;        // since the last piece
  double differences = 0.0, ways = 0.0;  // of all pieces
  void finish_piece() {
    differences += std::abs(front - rear);
    ways += (std::abs(front) + std::abs(rear)) / 2.0;
    front = rear = 0.0;
  }
};

}  // namespace

std::vector<std::string> joint_names(const Topic& topic) {
  std::vector<std::string> names;
  std::set<std::string> known;
  for (const auto& list : topic.joint_names)
    for (const auto& name : list)
      if (known.insert(name).second) names.push_back(name);
  return names;
}

std::string names_of_joints(const std::vector<std::string>& names) {
  constexpr std::size_t kMostListed = 24;
  if (names.size() <= kMostListed) return joined(names);
  return joined({names.begin(), names.begin() + kMostListed}) + " and " +
         std::to_string(names.size() - kMostListed) + " more";
}

std::string names_of_joints(const Topic& topic) { return names_of_joints(joint_names(topic)); }

std::optional<NamedWheels> wheels_by_name(const Topic& topic) {
  const auto names = joint_names(topic);
  const auto left = on_side(names, Side::left), right = on_side(names, Side::right);
  if (left.size() == 1 && right.size() == 1 && left != right)
    return NamedWheels{{left.front(), right.front()}, std::nullopt};
  if (left.size() != 2 || right.size() != 2) return std::nullopt;
  const bool wheels = std::all_of(left.begin(), left.end(), is_driven) || names.size() == 4;
  return wheels ? two_pairs(left, right) : std::nullopt;
}

std::optional<NamedWheel> wheel_by_name(const Topic& topic) {
  const auto names = joint_names(topic);
  const auto left = on_side(names, Side::left), right = on_side(names, Side::right);
  if (left.size() + right.size() == 1)
    return left.empty() ? NamedWheel{Side::right, right.front()} : NamedWheel{Side::left, left.front()};
  std::vector<std::string> wheels = names;
  if (wheels.size() > 1) std::erase_if(wheels, [](const auto& name) { return !is_driven(name); });
  if (!left.empty() || !right.empty() || wheels.size() != 1) return std::nullopt;
  const bool is_left = has_side(topic.header.name, Side::left);
  if (is_left == has_side(topic.header.name, Side::right)) return std::nullopt;
  return NamedWheel{is_left ? Side::left : Side::right, wheels.front()};
}

std::vector<Places> places(const Topic& topic, const Joints& joints) {
  std::vector<Places> out;
  for (const auto& names : topic.joint_names) {
    const auto place = [&](const std::string& joint) -> std::optional<std::size_t> {
      const auto at = std::find(names.begin(), names.end(), joint);
      if (joint.empty() || at == names.end()) return std::nullopt;
      return static_cast<std::size_t>(at - names.begin());
    };
    out.push_back({place(joints.left), place(joints.right)});
  }
  return out;
}

std::optional<std::array<double, 2>> unlike(const Topic& topic, const NamedWheels& wheels) {
  if (!wheels.front) return std::nullopt;
  const auto rear = places(topic, wheels.taken), front = places(topic, *wheels.front);
  std::array<Comparison, 2> sides;
  const Stamped<JointValues>* last = nullptr;
  std::int64_t begin = 0;
  for (const auto& one : topic.joints) {
    const std::size_t list = one.value.names;
    if (!rear[list][0] || !rear[list][1] || !front[list][0] || !front[list][1]) continue;
    if (one.value.positions.empty() && one.value.velocities.empty()) continue;
    if (last != nullptr && last->value.names == list)
      for (std::size_t side = 0; side < 2; ++side) {
        sides.at(side).front += way(*last, one, *front[list].at(side));
        sides.at(side).rear += way(*last, one, *rear[list].at(side));
      }
    if (last == nullptr || one.received_ns - begin >= kCompared_ns) {
      for (Comparison& side : sides) side.finish_piece();
      begin = one.received_ns;
    }
    last = &one;
  }
  for (const Comparison& side : sides)
    if (!(side.ways > 0.0) || !std::isfinite(side.ways) || !std::isfinite(side.differences))
      return std::nullopt;
  return std::array<double, 2>{sides[0].differences / sides[0].ways, sides[1].differences / sides[1].ways};
}

}  // namespace odomcalib::ros
