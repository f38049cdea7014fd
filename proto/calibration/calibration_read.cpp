#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>
#include <utility>

#include "proto/calibration/calibration.hpp"
#include "proto/calibration/field_list.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib {
namespace {

using Json = nlohmann::ordered_json;
using fields::About;
using fields::Form;
using fields::Presence;

constexpr std::string_view kFormatOfAnyVersion = "odomcalib-calibration/";
constexpr std::string_view kFormat = "odomcalib-calibration/1";
constexpr int kDeepestCalibration = 64;
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

std::string dumped(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// One JSON value and where it stands. Wrong types are noted once, in `problem`, and read as empty values.
class Node {
 public:
  /// A member of the file, or the file itself: no name.
  Node(const Json& json, std::string_view name, std::string& problem)
      : json_(&json), name_(name), problem_(&problem) {}

  [[nodiscard]] bool is_there() const { return is_there_; }
  [[nodiscard]] bool is_null() const { return json_->is_null(); }
  [[nodiscard]] const Json& json() const { return *json_; }
  [[nodiscard]] std::string path() const {
    const std::string before = parent_ == nullptr ? "" : parent_->path();
    if (index_ >= 0) return before + "[" + std::to_string(index_) + "]";
    return before.empty() ? std::string(name_) : before + "." + std::string(name_);
  }

  /// It holds as long as this one does.
  [[nodiscard]] Node operator[](std::string_view name) const {
    static const Json kNull;
    if (is_null() || !expect(json_->is_object(), "an object")) return {*this, kNull, name, -1, false};
    const auto found = json_->find(std::string(name));
    if (found == json_->end()) return {*this, kNull, name, -1, false};
    return {*this, *found, name, -1, true};
  }

  /// NaN for null: a value that was not finite when it was written.
  [[nodiscard]] double number() const {
    return !is_null() && expect(json_->is_number(), "a number") ? json_->get<double>() : kNotANumber;
  }
  [[nodiscard]] std::string text() const {
    return !is_null() && expect(json_->is_string(), "a text") ? json_->get<std::string>() : std::string();
  }
  /// Calls `visit(Node)` for each element; null is an empty list.
  template <typename Visit>
  void each(Visit visit) const {
    if (is_null() || !expect(json_->is_array(), "a list")) return;
    std::ptrdiff_t index = 0;
    for (const Json& element : *json_) visit(Node(*this, element, "", index++, true));
  }
  /// Calls `visit(name, Node)` for each member; null is an empty object.
  template <typename Visit>
  void each_member(Visit visit) const {
    if (is_null() || !expect(json_->is_object(), "an object")) return;
    for (const auto& [name, value] : json_->items()) visit(name, Node(*this, value, name, -1, true));
  }
  bool expect(bool holds, std::string_view what) const {
    if (!holds && problem_->empty()) *problem_ = "\"" + path() + "\" is not " + std::string(what);
    return holds;
  }

 private:
  Node(const Node& parent, const Json& json, std::string_view name, std::ptrdiff_t index, bool is_there)
      : json_(&json),
        parent_(&parent),
        name_(name),
        index_(index),
        problem_(parent.problem_),
        is_there_(is_there) {}

  const Json* json_;
  const Node* parent_ = nullptr;
  std::string_view name_;
  std::ptrdiff_t index_ = -1;  ///< in a list; negative: a member
  std::string* problem_;
  bool is_there_ = true;
};

template <typename List>
auto keys_of(const List& list) {
  return std::apply([](const auto&... field) { return std::array{field.key...}; }, list);
}

/// The member that says what kind of file it is.
struct FormatMark {
  std::string_view key = "format";
};

/// Reads values as the list of fields describes them.
class Reading {
 public:
  /// @param strict null and what is absent are no values, but where the list allows them
  /// @param unknown gets the members that the list does not have
  Reading(bool strict, UnknownMembers& unknown) : strict_(strict), unknown_(&unknown) {}

  void read(const Node& node, const About& about, double& out) {
    if (node.is_null() && about.form == Form::deviation) out = -1.0;
    if (node.is_null() && (about.form == Form::deviation || about.form == Form::zero)) return;
    if (about.form == Form::finite) node.expect(node.json().is_number(), "a number");
    out = node.number();
    check_range(node, about, out);
  }

  void read(const Node& node, const About&, bool& out) {
    if (!is_empty(node) && node.expect(node.json().is_boolean(), "true or false"))
      out = node.json().get<bool>();
  }

  void read(const Node& node, const About& about, std::size_t& out) {
    out = 0;
    if (is_empty(node) || !node.expect(node.json().is_number_unsigned(), "a count")) return;
    out = node.json().get<std::size_t>();
    check_range(node, about, static_cast<double>(out));
  }

  void read(const Node& node, const About& about, int& out) {
    if (is_empty(node) || !node.expect(node.json().is_number_integer(), "a whole number")) return;
    const auto whole = node.json().get<double>();
    if (!node.expect(std::abs(whole) < std::numeric_limits<int>::max(), "a whole number of usual size"))
      return;
    out = static_cast<int>(whole);
    check_range(node, about, out);
  }

  void read(const Node& node, const About& about, std::string& out) {
    out.clear();
    if (about.form != Form::nullable && is_empty(node)) return;
    out = node.text();
  }

  void read(const Node& node, const About&, Verdict& out) {
    const auto name = node.text();
    out = Verdict::refused;
    for (const Verdict known : {Verdict::accepted, Verdict::accepted_with_warnings})
      if (name == name_of(known)) out = known;
    if (out == Verdict::refused) node.expect(name == name_of(Verdict::refused), "a known verdict");
  }

  /// A name that this program does not know is of none that it treats in its own way.
  void read(const Node& node, const About&, Middleware& out) {
    out = Middleware::none;
    if (node.is_null()) return;
    const auto name = node.text();
    for (const Middleware known : {Middleware::ros1, Middleware::ros2})
      if (name == name_of(known)) out = known;
  }

  void read(const Node& node, const About&, Driven& out) {
    const auto begin = utc_from(node["begin"].text()), end = utc_from(node["end"].text());
    if (node.expect(begin && end, "two times like 2026-05-04T12:30:00Z")) out = {*begin, *end};
    keep_unknown(node, std::array<std::string_view, 2>{"begin", "end"});
  }

  template <typename T>
  void read(const Node& node, const About& about, std::optional<T>& out) {
    out.reset();
    if (!node.is_null()) read(node, about, out.emplace());
  }

  template <typename T, std::size_t kSize>
  void read(const Node& node, const About& about, std::array<T, kSize>& out) {
    out = {};
    if (node.is_null()) return;
    if (about.form == Form::by_axis) {
      read_by_axis(node, out);
      return;
    }
    std::size_t size = 0;
    node.each([&](const Node& element) {
      if (size < kSize) read(element, about, out.at(size));
      ++size;
    });
    const bool fits = size == kSize || (about.fewest > 0 && size >= about.fewest && size < kSize);
    if (!fits) node.expect(false, kSize == 3 ? "three numbers" : std::to_string(kSize) + " numbers");
    if constexpr (std::is_same_v<T, double>)
      for (std::size_t k = size; k < kSize; ++k) out.at(k) = kNotANumber;
  }

  template <typename T, std::size_t kColumns, std::size_t kRows>
  void read(const Node& node, const About& about, std::array<std::array<T, kColumns>, kRows>& out) {
    std::size_t row = 0;
    node.each([&](const Node& values) {
      if (row < kRows) read(values, about, out.at(row));
      ++row;
    });
    node.expect(row == kRows, "three rows");
  }

  template <typename T>
  void read(const Node& node, const About& about, std::vector<T>& out) {
    out.clear();
    if (strict_) node.expect(!node.is_null(), "a list");
    node.each([&](const Node& element) { read(element, about, out.emplace_back()); });
  }

  template <typename T>
  void read(const Node& node, const About& about, std::vector<std::pair<std::string, T>>& out) {
    out.clear();
    if (strict_) node.expect(!node.is_null(), "an object");
    node.each_member([&](const std::string& name, const Node& value) {
      out.emplace_back(name, T{});
      read(value, about, out.back().second);
      // The writer computes it from the scale.
      if (about.form == Form::answer) forget(value.path(), "std_absolute");
    });
  }

  void read(const Node& node, const About& about, std::vector<MethodResult>& out) {
    out.clear();
    node.each_member([&](const std::string& name, const Node& value) {
      MethodResult& method = out.emplace_back();
      method.name = name;
      if (!value["refused"].is_null()) method.refused = value["refused"].text();
      read(value, about, method);
      forget(value.path(), "refused");
    });
  }

  template <fields::IsRow T>
  void read(const Node& node, const About&, T& out) {
    std::array<double, fields::Row<T>::kCount> numbers{};
    numbers.fill(kNotANumber);
    std::size_t size = 0;
    node.each([&](const Node& element) {
      if (size < numbers.size()) numbers.at(size) = element.number();
      ++size;
    });
    out = fields::Row<T>::from(numbers);
  }

  template <fields::IsObject T>
  void read(const Node& node, const About&, T& out) {
    if (strict_ && !node.expect(node.json().is_object(), "an object")) return;
    read_list(node, fields::Members<T>::list(), out);
  }

  template <typename List, typename T>
  void read_list(const Node& node, const List& list, T& out) {
    std::apply([&](const auto&... field) { (read_field(node, field, out), ...); }, list);
    keep_unknown(node, keys_of(list));
  }

  /// Keeps the members of an object that are not among the known ones.
  template <std::size_t kSize>
  void keep_unknown(const Node& node, const std::array<std::string_view, kSize>& known) {
    if (!node.json().is_object()) return;
    for (const auto& [name, value] : node.json().items())
      if (std::find(known.begin(), known.end(), name) == known.end())
        (*unknown_)[node.path()][name] = dumped(value);
  }

  template <typename T, typename Member>
  void read_field(const Node& node, const fields::Field<T, Member>& field, T& out) {
    const Node value = node[field.key];
    const About& about = field.about;
    if (!value.is_there() && about.presence != Presence::always && (strict_ || is_optional(about))) return;
    if (strict_ && !value.expect(value.is_there(), "there")) return;
    read(value, about, out.*field.member);
  }

  template <typename T>
  void read_field(const Node& node, const fields::PairField<T>& field, T& out) {
    std::array<double, 2> numbers{};
    const Node value = node[field.key];
    if (strict_) value.expect(value.is_there(), "there");
    read(value, field.about, numbers);
    out.*field.first = numbers[0];
    out.*field.second = numbers[1];
  }

  template <typename T, typename... Fields>
  void read_field(const Node& node, const fields::Group<Fields...>& group, T& out) {
    read_list(node[group.key], group.list, out);
  }

 private:
  /// Where null is no value it is a problem of those who are strict, and an empty one for others.
  [[nodiscard]] bool is_empty(const Node& node) const {
    if (strict_ && node.is_null()) node.expect(false, "there");
    return node.is_null();
  }

  static bool is_optional(const About& about) {
    return about.presence == Presence::usual || about.presence == Presence::if_set;
  }

  template <std::size_t kSize>
  void read_by_axis(const Node& node, std::array<double, kSize>& out) {
    constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "yaw"};
    for (std::size_t k = 0; k < kSize; ++k) out.at(k) = node[kAxes.at(k)].number();
    keep_unknown(node, kAxes);
  }

  static void check_range(const Node& node, const About& about, double value) {
    if (value < about.low) node.expect(false, "at least " + dumped(about.low));
    if (value > about.high) node.expect(false, "at most " + dumped(about.high));
  }

  void forget(const std::string& path, const std::string& name) {
    const auto found = unknown_->find(path);
    if (found == unknown_->end()) return;
    found->second.erase(name);
    if (found->second.empty()) unknown_->erase(found);
  }

  bool strict_;
  UnknownMembers* unknown_;
};

/// Refuses deep nesting while parsing, before it costs memory.
Json parse_calibration(const std::string& text) {
  bool too_deep = false;
  const auto guard = [&](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > kDeepestCalibration;
    return !too_deep;
  };
  auto json = Json::parse(text, guard, false);
  return too_deep || json.is_discarded() ? Json() : json;
}

template <typename Member>
bool is_set(const std::optional<Member>& member) {
  return member.has_value();
}
template <typename Item>
bool is_set(const std::vector<Item>& member) {
  return !member.empty();
}

/// An addition that is not understood is no value, and stays in the file as it is. One of every file may be
/// null or empty.
template <typename Member>
void read_addition(const Json& json, const fields::Field<Calibration, Member>& field, Calibration& out) {
  const auto found = json.find(std::string(field.key));
  if (found == json.end()) return;
  const bool is_nothing = found->is_null() || (found->is_array() && found->empty());
  if (is_nothing && field.about.presence == Presence::later) return;
  std::string problem;
  UnknownMembers unknown;
  Member& member = out.*field.member;
  Reading(true, unknown).read(Node(*found, field.key, problem), field.about, member);
  if (!problem.empty() || !is_set(member)) {
    member = {};
    out.unknown[""][std::string(field.key)] = dumped(*found);
    return;
  }
  out.unknown.merge(unknown);
}

/// Files of earlier versions do not state it: there a choice names the type of the messages, as ROS 2 writes
/// it.
void complete_middleware(DataUse& use) {
  const bool names_ros2 = std::any_of(use.choices.begin(), use.choices.end(), [](const std::string& choice) {
    return choice.find("/msg/") != std::string::npos;
  });
  if (use.middleware == Middleware::none && names_ros2) use.middleware = Middleware::ros2;
}

Calibration calibration(const Json& json, std::string& problem) {
  const Node root(json, "", problem);
  Calibration out;
  Reading reading(false, out.unknown);
  const auto file = std::tuple_cat(std::tuple{FormatMark{}}, fields::contract(), fields::additions());
  std::apply([&](const auto&... field) { (reading.read_field(root, field, out), ...); }, fields::contract());
  std::apply([&](const auto&... field) { (read_addition(json, field, out), ...); }, fields::additions());
  reading.keep_unknown(root, keys_of(file));
  for (DataUse& use : out.data) complete_middleware(use);
  return out;
}

/// The covariance belongs to the named parameters: a matrix of another size cannot be read.
bool covariance_fits(const Calibration& calibration) {
  const std::size_t size = calibration.covariance_order.size();
  return (calibration.covariance.empty() && size == 0) ||
         (calibration.covariance.size() == size &&
          std::all_of(calibration.covariance.begin(), calibration.covariance.end(),
                      [size](const auto& row) { return row.size() == size; }));
}

std::optional<std::string> non_finite(const QuantityList& quantities, const std::string& path) {
  for (const auto& [name, quantity] : quantities)
    if (!std::isfinite(quantity.value)) return std::string(path).append(".").append(name);
  return std::nullopt;
}

}  // namespace

ErrorGrowth fields::Row<ErrorGrowth>::from(const std::array<double, kCount>& numbers) {
  constexpr double kMostStretches = 1e9;
  const auto known = [](double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; };
  const double stretches = numbers[1] > 0.0 ? std::min(numbers[1], kMostStretches) : 0.0;
  return {numbers[0], static_cast<std::size_t>(stretches), known(numbers[2]), known(numbers[3]),
          known(numbers[4])};
}

std::optional<std::string> non_finite_value(const Calibration& calibration) {
  if (auto path = non_finite(calibration.parameters, "parameters")) return path;
  for (const EffectResult& effect : calibration.effects)
    if (auto path = non_finite(effect.parameters, "effects." + effect.name)) return path;
  return std::nullopt;
}

Result<Calibration> calibration_from_json(const std::string& text, const std::string& where) {
  return calibration_from(parse_calibration(text), where);
}

Result<Calibration> calibration_from(const Json& json, const std::string& where) {
  if (!json.is_object())
    return Error{ErrorCode::format, "is not a calibration file (no JSON object)", where,
                 "name a file that solve wrote"};
  std::string problem;
  const std::string format = Node(json, "", problem)["format"].text();
  if (format != kFormat && format.starts_with(kFormatOfAnyVersion))
    return Error{ErrorCode::format, std::string(kOtherVersion) + ": \"" + format + "\"", where,
                 "update odomcalib, or solve the recording with this version"};
  if (format != kFormat)
    return Error{ErrorCode::format,
                 "is not a calibration file (\"format\" is not \"odomcalib-calibration/1\")", where,
                 "name a file that solve wrote"};
  auto out = calibration(json, problem);
  if (problem.empty() && !covariance_fits(out))
    problem = "\"covariance\" has a matrix that does not fit its order";
  if (!problem.empty())
    return Error{ErrorCode::format, "calibration file is damaged: " + problem, where,
                 "solve the recording again"};
  return out;
}

}  // namespace odomcalib
