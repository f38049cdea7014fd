#include "proto/calibration/schema.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "proto/calibration/calibration.hpp"
#include "proto/calibration/field_list.hpp"

namespace odomcalib {
namespace {

using Json = nlohmann::ordered_json;
using fields::About;
using fields::Form;
using fields::Presence;

/// Says which type is meant where there is no value to tell it.
template <typename T>
struct Of {};

Json list_of(Json items, std::optional<std::size_t> fewest = std::nullopt, std::size_t most = 0) {
  Json out = {{"type", "array"}, {"items", std::move(items)}};
  if (!fewest) return out;
  out["minItems"] = *fewest;
  out["maxItems"] = most;
  return out;
}

Json object_of(Json properties, Json required) {
  return {{"type", "object"},
          {"properties", std::move(properties)},
          {"required", std::move(required)},
          {"additionalProperties", false}};
}

Json any_of_names(Json value) { return {{"type", "object"}, {"additionalProperties", std::move(value)}}; }

Json or_null(Json schema) { return {{"oneOf", Json::array({{{"type", "null"}}, std::move(schema)})}}; }

/// A value of one JSON type, or null.
Json or_null_by_type(Json schema) {
  schema["type"] = Json::array({schema["type"], "null"});
  return schema;
}

Json described(Json schema, const About& about) {
  if (*about.meaning != '\0') schema["description"] = about.meaning;
  return schema;
}

Json whole_if_whole(double value) {
  return std::floor(value) == value ? Json(static_cast<long long>(value)) : Json(value);
}

Json in_range(Json schema, const About& about) {
  if (std::isfinite(about.low)) schema["minimum"] = whole_if_whole(about.low);
  if (std::isfinite(about.high)) schema["maximum"] = whole_if_whole(about.high);
  return schema;
}

/// Schemas of values, without descriptions. Definitions that they refer to are collected.
class Maker {
 public:
  Json schema(Of<double>, const About& about) {
    const Json number = {{"type", "number"}};
    return in_range(about.form == Form::finite ? number : or_null_by_type(number), about);
  }
  Json schema(Of<bool>, const About&) { return {{"type", "boolean"}}; }
  Json schema(Of<int>, const About& about) { return in_range({{"type", "integer"}}, about); }
  Json schema(Of<std::size_t>, const About& about) {
    return in_range({{"type", "integer"}, {"minimum", 0}}, about);
  }
  Json schema(Of<std::string>, const About& about) {
    if (!about.values.empty())
      return {{"enum", Json(std::vector<std::string>(about.values.begin(), about.values.end()))}};
    Json text = {{"type", "string"}};
    if (about.pattern != nullptr) text["pattern"] = about.pattern;
    return about.form == Form::nullable ? or_null_by_type(text) : text;
  }
  Json schema(Of<Verdict>, const About&) {
    Json names = Json::array();
    for (const Verdict verdict : {Verdict::accepted, Verdict::accepted_with_warnings, Verdict::refused})
      names.push_back(name_of(verdict));
    return {{"enum", names}};
  }
  Json schema(Of<Middleware>, const About&) {
    return {{"enum", Json::array({name_of(Middleware::ros1), name_of(Middleware::ros2)})}};
  }
  Json schema(Of<Driven>, const About&) {
    return object_of(
        {{"begin", {{"type", "string"}, {"description", "ISO 8601, UTC"}}}, {"end", {{"type", "string"}}}},
        {"begin", "end"});
  }

  /// Where it is written only when it is set, it is no null.
  template <typename T>
  Json schema(Of<std::optional<T>>, const About& about) {
    Json value = schema(Of<T>{}, about);
    if (about.form == Form::null_by_type) return or_null_by_type(std::move(value));
    if (about.presence == Presence::if_set && about.form != Form::null_or_object) return value;
    if constexpr (std::is_same_v<T, double>) return value;
    const bool is_one_type =
        value.contains("type") && (value["type"] == "array" || value["type"] == "string");
    return is_one_type ? or_null_by_type(std::move(value)) : or_null(std::move(value));
  }

  template <typename T, std::size_t kSize>
  Json schema(Of<std::array<T, kSize>>, const About& about) {
    if (about.form == Form::by_axis) return axes();
    return list_of(schema(Of<T>{}, about), about.fewest > 0 ? about.fewest : kSize, kSize);
  }

  template <typename T>
  Json schema(Of<std::vector<T>>, const About& about) {
    return list_of(schema(Of<T>{}, about));
  }
  template <typename T>
  Json schema(Of<std::vector<std::pair<std::string, T>>>, const About& about) {
    return any_of_names(about.form == Form::answer ? answer() : schema(Of<T>{}, about));
  }
  Json schema(Of<std::vector<MethodResult>>, const About& about) {
    const Json refused = {{"type", "string"}, {"description", "why"}};
    return any_of_names(
        {{"oneOf", Json::array({schema(Of<MethodResult>{}, about),
                                object_of({{"refused", refused}}, Json::array({"refused"}))})}});
  }

  template <fields::IsRow T>
  Json schema(Of<T>, const About&) {
    constexpr std::size_t kCount = fields::Row<T>::kCount;
    return list_of(schema(Of<double>{}, {}), kCount, kCount);
  }

  template <fields::IsObject T>
  Json schema(Of<T>, const About&) {
    if constexpr (fields::IsPatterned<T>) return alike<T>();
    if constexpr (fields::IsDefined<T>) {
      const std::string name = fields::Members<T>::kDefinition;
      if (!definitions_.contains(name)) definitions_[name] = object(fields::Members<T>::list());
      return {{"$ref", "#/$defs/" + name}};
    } else {
      return object(fields::Members<T>::list());
    }
  }

  template <typename List>
  Json object(const List& list) {
    Json properties = Json::object(), required = Json::array();
    std::apply([&](const auto&... field) { (add(field, properties, required), ...); }, list);
    return object_of(std::move(properties), std::move(required));
  }

  [[nodiscard]] const Json& definitions() const { return definitions_; }

 private:
  static void require(std::string_view key, const About& about, Json& required) {
    if (about.presence == Presence::always || about.presence == Presence::usual)
      required.push_back(std::string(key));
  }

  template <typename T, typename Member>
  void add(const fields::Field<T, Member>& field, Json& properties, Json& required) {
    properties[std::string(field.key)] = described(schema(Of<Member>{}, field.about), field.about);
    require(field.key, field.about, required);
  }

  template <typename T>
  void add(const fields::PairField<T>& field, Json& properties, Json& required) {
    properties[std::string(field.key)] = described(schema(Of<std::array<double, 2>>{}, {}), field.about);
    require(field.key, field.about, required);
  }

  template <typename... Fields>
  void add(const fields::Group<Fields...>& group, Json& properties, Json& required) {
    properties[std::string(group.key)] = object(group.list);
    required.push_back(std::string(group.key));
  }

  /// All members are of one shape, and their names have a pattern.
  template <typename T>
  Json alike() {
    const Json whole = object(fields::Members<T>::list());
    return {{"type", "object"},
            {"patternProperties", {{fields::Members<T>::kPattern, whole["properties"].front()}}},
            {"required", whole["required"]},
            {"additionalProperties", false}};
  }

  Json axes() {
    const auto axis = [this](const char* unit) {
      return described(schema(Of<double>{}, {}), {.meaning = unit});
    };
    definitions_["axes"] =
        object_of({{"x", axis("m")}, {"y", axis("m")}, {"yaw", axis("rad")}}, {"x", "y", "yaw"});
    return {{"$ref", "#/$defs/axes"}};
  }

  /// A quantity with its deviation in true metres.
  Json answer() {
    const Json number = schema(Of<double>{}, {});
    return object_of({{"value", number},
                      {"std", described(schema(Of<double>{}, {.low = 0.0}),
                                        {.meaning = "against the metre of the reference"})},
                      {"unit", {{"enum", {"m", "rad"}}}},
                      {"std_absolute", described(number, {.meaning = "with the error of that metre"})}},
                     {"value", "std", "unit"});
  }

  Json definitions_ = Json::object();
};

}  // namespace

Json calibration_schema() {
  Maker maker;
  Json members = maker.object(std::tuple_cat(fields::contract(), fields::additions()));
  Json properties = Json::object(), required = Json::array({"format"});
  properties["format"] = {{"const", "odomcalib-calibration/1"}};
  properties.update(members["properties"]);
  for (const Json& name : members["required"]) required.push_back(name);
  Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"$id", "urn:odomcalib:schema:calibration:1"},
              {"title",
               "solve, calibrate, report, and the calibration file: members as docs/user/formats.md explains "
               "them"}};
  out.update(object_of(std::move(properties), std::move(required)));
  out["$defs"] = maker.definitions();
  return out;
}

}  // namespace odomcalib
