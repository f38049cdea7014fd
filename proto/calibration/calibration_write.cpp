#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "proto/calibration/calibration.hpp"
#include "proto/calibration/discarded_json.hpp"
#include "proto/calibration/field_list.hpp"
#include "proto/calibration/scale.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib {
namespace {

using Json = nlohmann::ordered_json;
using fields::About;
using fields::Form;
using fields::Presence;

std::string on_one_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// A standard deviation that is negative was not estimated.
Json deviation_or_null(double value) { return value >= 0.0 ? number_or_null(value) : Json(nullptr); }

/// Text that is no JSON is kept as a string, so that nothing gets lost silently.
Json unknown_value(const std::string& text) {
  Json parsed = Json::parse(text, nullptr, false);
  return parsed.is_discarded() ? Json(text) : parsed;
}

bool is_said(const std::string& text) { return !text.empty(); }
bool is_said(Middleware middleware) { return middleware != Middleware::none; }
template <typename T>
bool is_said(const std::optional<T>& value) {
  return value.has_value();
}
template <typename T>
bool is_said(const std::vector<T>& list) {
  return !list.empty();
}
/// Values of other types always say something.
template <typename T>
bool is_said(const T&) {
  return true;
}

/// Path of a member of an object.
std::string below(std::string path, const std::string& name) {
  if (!path.empty()) path += ".";
  path += name;
  return path;
}

/// Writes values as the list of fields describes them.
class Writing {
 public:
  explicit Writing(const Calibration& calibration) : calibration_(&calibration) {}

  [[nodiscard]] Json json(double value, const About& about, const std::string&) const {
    return about.form == Form::deviation ? deviation_or_null(value) : number_or_null(value);
  }
  [[nodiscard]] Json json(bool value, const About&, const std::string&) const { return value; }
  [[nodiscard]] Json json(int value, const About&, const std::string&) const { return value; }
  [[nodiscard]] Json json(std::size_t value, const About&, const std::string&) const { return value; }
  [[nodiscard]] Json json(const std::string& value, const About& about, const std::string&) const {
    return about.form == Form::nullable && value.empty() ? Json(nullptr) : Json(value);
  }
  [[nodiscard]] Json json(Middleware value, const About&, const std::string&) const { return name_of(value); }
  [[nodiscard]] Json json(Verdict value, const About&, const std::string&) const { return name_of(value); }
  [[nodiscard]] Json json(const Driven& driven, const About&, const std::string& path) const {
    return with_unknown({{"begin", utc_text(driven.begin)}, {"end", utc_text(driven.end)}}, path);
  }

  template <typename T>
  [[nodiscard]] Json json(const std::optional<T>& value, const About& about, const std::string& path) const {
    return value ? json(*value, about, path) : Json(nullptr);
  }

  template <typename T, std::size_t kSize>
  [[nodiscard]] Json json(const std::array<T, kSize>& values, const About& about,
                          const std::string& path) const {
    if constexpr (std::is_same_v<T, double> && kSize == 3)
      if (about.form == Form::by_axis)
        return with_unknown({{"x", number_or_null(values[0])},
                             {"y", number_or_null(values[1])},
                             {"yaw", number_or_null(values[2])}},
                            path);
    return list(values, about, path);
  }

  template <typename T>
  [[nodiscard]] Json json(const std::vector<T>& values, const About& about, const std::string& path) const {
    return list(values, about, path);
  }

  template <typename T>
  [[nodiscard]] Json json(const std::vector<std::pair<std::string, T>>& values, const About& about,
                          const std::string& path) const {
    Json out = Json::object();
    for (const auto& [name, value] : values) out[name] = json(value, about, below(path, name));
    if constexpr (std::is_same_v<T, Quantity>)
      if (about.form == Form::answer && calibration_->scale)
        for (const auto& [name, quantity] : values)
          out[name]["std_absolute"] = deviation_or_null(absolute_deviation(quantity, *calibration_->scale));
    return out;
  }

  [[nodiscard]] Json json(const std::vector<MethodResult>& methods, const About& about,
                          const std::string& path) const {
    Json out = Json::object();
    for (const MethodResult& method : methods) {
      const std::string own = below(path, method.name);
      out[method.name] =
          method.refused ? with_unknown({{"refused", *method.refused}}, own) : json(method, about, own);
    }
    return out;
  }

  template <fields::IsRow T>
  [[nodiscard]] Json json(const T& row, const About&, const std::string& path) const {
    return list(fields::Row<T>::numbers(row), {}, path);
  }

  template <fields::IsObject T>
  [[nodiscard]] Json json(const T& value, const About&, const std::string& path) const {
    return object(value, fields::Members<T>::list(), path);
  }

  /// The members of a list, and those of its object that nobody knows.
  template <typename T, typename List>
  [[nodiscard]] Json object(const T& value, const List& list, const std::string& path) const {
    Json out = Json::object();
    std::apply([&](const auto&... field) { (add(value, field, path, out), ...); }, list);
    return path.empty() ? out : with_unknown(std::move(out), path);
  }

 private:
  template <typename List>
  [[nodiscard]] Json list(const List& values, const About& about, const std::string& path) const {
    Json out = Json::array();
    for (const auto& value : values)
      out.push_back(
          json(value, about, std::string(path).append("[").append(std::to_string(out.size())).append("]")));
    return out;
  }

  template <typename T, typename Member>
  void add(const T& value, const fields::Field<T, Member>& field, const std::string& path, Json& out) const {
    const Member& member = value.*field.member;
    if (field.about.presence == Presence::if_set && !is_said(member)) return;
    const std::string key(field.key);
    out[key] = json(member, field.about, below(path, key));
  }

  template <typename T>
  void add(const T& value, const fields::PairField<T>& field, const std::string&, Json& out) const {
    out[std::string(field.key)] = {number_or_null(value.*field.first), number_or_null(value.*field.second)};
  }

  template <typename T, typename... Fields>
  void add(const T& value, const fields::Group<Fields...>& group, const std::string& path, Json& out) const {
    const std::string key(group.key);
    out[key] = object(value, group.list, below(path, key));
  }

  [[nodiscard]] Json with_unknown(Json object, const std::string& path) const {
    const auto found = calibration_->unknown.find(path);
    if (found == calibration_->unknown.end()) return object;
    for (const auto& [name, text] : found->second)
      if (!object.contains(name)) object[name] = unknown_value(text);
    return object;
  }

  const Calibration* calibration_;
};

/// Members that not every file has, by name and one line each: their points would fill pages.
std::string lines_of_additions(const Calibration& calibration, const Json& contract) {
  const Json own = Writing(calibration).object(calibration, fields::additions(), "");
  std::map<std::string, std::string> lines;
  if (const auto found = calibration.unknown.find(""); found != calibration.unknown.end())
    for (const auto& [name, text] : found->second)
      if (!contract.contains(name)) lines[name] = on_one_line(unknown_value(text));
  for (const auto& [name, value] : own.items()) lines[name] = on_one_line(value);
  std::string out;
  for (const auto& [name, line] : lines) out += ",\n  " + on_one_line(Json(name)) + ": " + line;
  return out;
}

}  // namespace

std::array<double, 5> fields::Row<ErrorGrowth>::numbers(const ErrorGrowth& growth) {
  const double nan = std::nan("");
  return {growth.way, static_cast<double>(growth.stretches), growth.before.value_or(nan),
          growth.geometry.value_or(nan), growth.after.value_or(nan)};
}

nlohmann::ordered_json to_json(const Discarded& one) { return Writing(Calibration{}).json(one, {}, ""); }
nlohmann::ordered_json to_json(const Repair& one) { return Writing(Calibration{}).json(one, {}, ""); }
nlohmann::ordered_json to_json(const std::vector<Discarded>& list) {
  return Writing(Calibration{}).json(list, {}, "");
}
nlohmann::ordered_json to_json(const std::vector<Repair>& list) {
  return Writing(Calibration{}).json(list, {}, "");
}

nlohmann::ordered_json to_json(const SolveSettings& settings) {
  return Writing(Calibration{}).json(settings, {}, "");
}

nlohmann::ordered_json to_json(const ProposalEntry& proposal) {
  return Writing(Calibration{}).json(proposal, {}, "");
}

std::string to_json(const Calibration& calibration) {
  Json out = Json::object();
  out["format"] = "odomcalib-calibration/1";
  out.update(Writing(calibration).object(calibration, fields::contract(), ""));
  std::string text = out.dump(2, ' ', false, Json::error_handler_t::replace);
  text.insert(text.size() - 2, lines_of_additions(calibration, out));  // before the closing "\n}"
  return text + "\n";
}

}  // namespace odomcalib
