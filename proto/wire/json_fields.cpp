#include "proto/wire/json_fields.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>
#include <variant>

namespace odomcalib {
namespace {

constexpr int kDeepest = 64;
constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
constexpr double kExactInteger = 9007199254740992.0;  // 2^53

using Slot = std::variant<std::monostate, Scalar, Array, Text>;

// Names of DESIGN 4.2, of Censi's raw logs (readings, theta, ray_dt, stamps as [s, us]) and of his tuple
// files.
constexpr std::array<std::pair<std::string_view, Slot>, 43> kLineMembers{{
    {"type", Text::type},
    {"t", Scalar::t},
    {"left", Scalar::left},
    {"right", Scalar::right},
    {"segment", Scalar::segment},
    {"ranges", Array::ranges},
    {"readings", Array::ranges},
    {"angle_min", Scalar::angle_min},
    {"min_theta", Scalar::angle_min},
    {"max_theta", Scalar::angle_max},
    {"angle_increment", Scalar::angle_increment},
    {"time_increment", Scalar::time_increment},
    {"range_min", Scalar::range_min},
    {"range_max", Scalar::range_max},
    {"valid", Array::valid},
    {"nrays", Scalar::beams},
    {"angles", Array::angles},
    {"theta", Array::angles},
    {"times", Array::times},
    {"ray_dt", Array::times},
    {"intensities", Array::intensities},
    {"sensor", Text::sensor},
    {"x", Scalar::x},
    {"y", Scalar::y},
    {"yaw", Scalar::yaw},
    {"yaw_rate", Scalar::yaw_rate},
    {"wheel_diameter", Scalar::wheel_diameter},
    {"left_wheel_diameter", Scalar::left_wheel_diameter},
    {"right_wheel_diameter", Scalar::right_wheel_diameter},
    {"track_width", Scalar::track_width},
    {"ticks_per_rev", Scalar::ticks_per_rev},
    {"time_zero", Scalar::time_zero},
    {"lidar_pose", Array::lidar_pose},
    {"robot_id", Text::robot_id},
    {"controller", Text::controller},
    {"controller_id", Text::controller_id},
    {"timestamp", Array::timestamp},
    {"leftTimestamp", Array::left_timestamp},
    {"rightTimestamp", Array::right_timestamp},
    {"T", Scalar::tuple_duration},
    {"phi_l", Scalar::tuple_left},
    {"phi_r", Scalar::tuple_right},
    {"sm", Array::tuple_motion},
}};

std::pair<std::string_view, Slot> find_member(std::string_view name) {
  for (const auto& known : kLineMembers)
    if (known.first == name) return known;
  return {};
}

/// Events of nlohmann's parser; the names are fixed by its interface.
class Handler {
 public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  explicit Handler(JsonFields& fields) : fields_(fields) {}

  bool null() {
    if (depth_ == 1 && std::holds_alternative<Scalar>(slot_)) return true;  // absent
    const bool no_reading =
        std::holds_alternative<Array>(slot_) &&
        (std::get<Array>(slot_) == Array::ranges || std::get<Array>(slot_) == Array::intensities);
    return number(no_reading ? 0.0 : kAbsent);
  }
  bool boolean(bool value) {
    note_wrong_type();
    const bool flag = std::holds_alternative<Array>(slot_) && std::get<Array>(slot_) == Array::valid;
    return number(flag ? static_cast<double>(value) : kAbsent);
  }
  bool number_integer(number_integer_t value) {
    note_lone_number();
    return is_text() ? text(std::to_string(value)) : integer(value);
  }
  bool number_unsigned(number_unsigned_t value) {
    note_lone_number();
    if (is_text()) return text(std::to_string(value));
    if (value > static_cast<number_unsigned_t>(std::numeric_limits<std::int64_t>::max()))
      return number(static_cast<double>(value));
    return integer(static_cast<std::int64_t>(value));
  }
  bool number_float(number_float_t value, const string_t& written) {
    note_lone_number();
    if (is_text()) return text(written);
    if (depth_ == 1 && std::abs(value) <= kExactInteger && std::trunc(value) == value)
      return integer(static_cast<std::int64_t>(value));
    return number(value);
  }
  bool string(string_t& value) {
    if (is_text()) return text(std::move(value));
    if (!value.empty()) note_wrong_type();  // empty: what blank_non_finite() leaves
    return number(kAbsent);
  }
  bool binary(binary_t&) { return false; }
  bool start_object(std::size_t) {
    note_wrong_type();
    return open();
  }
  bool end_object() { return close(); }
  bool start_array(std::size_t) {
    if (depth_ == 0) return false;
    if (depth_ == 1 && std::holds_alternative<Array>(slot_)) {
      array_ = &fields_.arrays.at(static_cast<std::size_t>(std::get<Array>(slot_)));
      array_->clear();
    } else {
      note_wrong_type();
    }
    return open();
  }
  bool end_array() { return close(); }
  bool key(string_t& name) {
    if (depth_ == 1) std::tie(member_, slot_) = find_member(name);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) { return false; }

 private:
  [[nodiscard]] bool is_text() const { return depth_ == 1 && std::holds_alternative<Text>(slot_); }
  void note_wrong_type() {
    if (depth_ == 1 && !std::holds_alternative<std::monostate>(slot_)) fields_.wrong_types.push_back(member_);
  }
  void note_lone_number() {
    if (std::holds_alternative<Array>(slot_)) note_wrong_type();
  }
  bool text(std::string value) {
    fields_.texts.at(static_cast<std::size_t>(std::get<Text>(slot_))) = std::move(value);
    return true;
  }
  bool open() {
    if (++depth_ == 3 && array_ != nullptr) array_->push_back(kAbsent);  // a nested value is not a number
    return depth_ <= kDeepest;
  }
  bool close() {
    if (--depth_ == 1) array_ = nullptr;
    return true;
  }
  bool number(double value) {
    if (depth_ == 0) return false;  // a bare number is no object
    if (depth_ == 2 && array_ != nullptr) array_->push_back(value);
    if (depth_ == 1 && std::holds_alternative<Scalar>(slot_)) {
      const auto index = static_cast<std::size_t>(std::get<Scalar>(slot_));
      fields_.scalars.at(index) = value;
      fields_.present.at(index) = true;
    }
    return true;
  }
  bool integer(std::int64_t value) {
    if (depth_ == 1 && std::holds_alternative<Scalar>(slot_)) {
      if (std::get<Scalar>(slot_) == Scalar::left) fields_.counts[0] = value;
      if (std::get<Scalar>(slot_) == Scalar::right) fields_.counts[1] = value;
    }
    return number(static_cast<double>(value));
  }

  JsonFields& fields_;
  std::string_view member_;
  Slot slot_;
  std::vector<double>* array_ = nullptr;  // the known array that is open at depth 2
  int depth_ = 0;
};

/// NaN and Infinity are no JSON, yet common writers emit them. Replaces each outside of strings by an empty
/// string of the same width, which reads as "not a number"; false when there is none.
bool blank_non_finite(std::string& text) {
  bool in_string = false;
  bool changed = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && in_string) {
      ++i;
    } else if (text[i] == '"') {
      in_string = !in_string;
    } else if (!in_string && (text[i] == 'N' || text[i] == 'I' || text[i] == '-')) {
      for (const std::string_view word : {"NaN", "-NaN", "Infinity", "-Infinity"}) {
        if (text.compare(i, word.size(), word) != 0) continue;
        text.replace(i, word.size(), word.size(), ' ').replace(i, 2, "\"\"");
        i += word.size() - 1;
        changed = true;
        break;
      }
    }
  }
  return changed;
}

bool parse_strict(std::string_view text, JsonFields& fields) {
  fields.clear();
  Handler handler(fields);
  return nlohmann::json::sax_parse(text.data(), text.data() + text.size(), &handler);
}

}  // namespace

void JsonFields::clear() {
  scalars.fill(kAbsent);
  present.fill(false);
  counts = {};
  for (auto& array : arrays) array.clear();
  for (auto& text : texts) text.clear();
  wrong_types.clear();
}

bool parse_fields(std::string_view text, JsonFields& fields) {
  if (parse_strict(text, fields)) return true;
  if (text.find('N') == std::string_view::npos && text.find("Inf") == std::string_view::npos) return false;
  std::string blanked(text);
  return blank_non_finite(blanked) && parse_strict(blanked, fields);
}

}  // namespace odomcalib
