#include "drivers/base/profile/profile_reader.hpp"

#include <cmath>
#include <sstream>

#include "proto/number_text.hpp"

namespace odomcalib::drivers {
namespace {

std::optional<canopen::ObjectAddress> parse_object(std::string_view text) {
  const std::size_t colon = text.find(':');
  const auto index = number_from<std::uint16_t>(text.substr(0, colon), 16);
  const auto sub = colon == std::string_view::npos ? std::optional<std::uint8_t>(0)
                                                   : number_from<std::uint8_t>(text.substr(colon + 1), 16);
  if (!index || !sub) return std::nullopt;
  return canopen::ObjectAddress{*index, *sub};
}

std::optional<canopen::NumberType> parse_type(std::string_view text) {
  if (text.size() < 2 || (text[0] != 'u' && text[0] != 'i')) return std::nullopt;
  const auto bits = number_from<int>(text.substr(1), 10);
  if (!bits || (*bits != 8 && *bits != 16 && *bits != 32 && *bits != 64)) return std::nullopt;
  return canopen::NumberType{static_cast<std::uint8_t>(*bits / 8), text[0] == 'i'};
}

std::optional<canopen::PdoEntry> parse_entry(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto object = parse_object(text.substr(0, slash));
  const auto bits = number_from<std::uint8_t>(text.substr(slash + 1), 10);
  if (!object || !bits || *bits == 0 || *bits > 64 || *bits % 8 != 0) return std::nullopt;
  return canopen::PdoEntry{*object, *bits};
}

std::string found_text(const toml::node* node) {
  if (node == nullptr) return "it is missing";
  if (const auto text = node->value<std::string>()) return "\"" + *text + "\"";
  if (const auto number = node->value<double>()) {
    std::ostringstream out;
    out << *number;
    return out.str();
  }
  return "another type";
}

template <typename T>
std::string range_text(T least, T most) {
  std::ostringstream out;
  out << "a number within " << least << " and " << most;
  return out.str();
}

}  // namespace

const toml::node* ProfileTable::find(std::string_view key) {
  asked_.emplace(key);
  return table_ == nullptr ? nullptr : table_->get(key);
}

void ProfileTable::complain(std::string_view key, const std::string& found, const std::string& allowed) {
  if (problem_.first) return;
  problem_.first = Error{ErrorCode::format, "key \"" + prefix_ + std::string(key) + "\": " + found,
                         problem_.where, "allowed: " + allowed};
}

std::int64_t ProfileTable::integer(std::string_view key, std::optional<std::int64_t> otherwise,
                                   std::int64_t least, std::int64_t most) {
  const toml::node* node = find(key);
  if (node == nullptr && otherwise) return *otherwise;
  const auto value = node == nullptr ? std::nullopt : node->value_exact<std::int64_t>();
  if (value && *value >= least && *value <= most) return *value;
  complain(key, found_text(node), range_text(least, most) + ", whole");
  return otherwise.value_or(least);
}

double ProfileTable::number(std::string_view key, std::optional<double> otherwise, double least,
                            double most) {
  const toml::node* node = find(key);
  if (node == nullptr && otherwise) return *otherwise;
  const auto value = node == nullptr ? std::nullopt : node->value<double>();
  if (value && std::isfinite(*value) && *value >= least && *value <= most) return *value;
  complain(key, found_text(node), range_text(least, most));
  return otherwise.value_or(least);
}

std::string ProfileTable::text(std::string_view key, std::optional<std::string> otherwise) {
  const toml::node* node = find(key);
  if (node == nullptr && otherwise) return *otherwise;
  if (const auto value = node == nullptr ? std::nullopt : node->value_exact<std::string>()) return *value;
  complain(key, found_text(node), "a text");
  return otherwise.value_or("");
}

canopen::ObjectAddress ProfileTable::object(std::string_view key, std::optional<std::string> otherwise) {
  const std::string value = text(key, std::move(otherwise));
  if (const auto object = parse_object(value)) return *object;
  complain(key, "\"" + value + "\"", "an object like \"6064:01\" (index:sub, hexadecimal)");
  return {};
}

canopen::NumberType ProfileTable::type(std::string_view key, std::optional<std::string> otherwise) {
  const std::string value = text(key, std::move(otherwise));
  if (const auto type = parse_type(value)) return *type;
  complain(key, "\"" + value + "\"", "u8 i8 u16 i16 u32 i32 u64 i64");
  return {};
}

std::vector<canopen::PdoEntry> ProfileTable::entries(std::string_view key) {
  std::vector<canopen::PdoEntry> out;
  const toml::node* node = find(key);
  const toml::array* array = node == nullptr ? nullptr : node->as_array();
  if (array != nullptr) {
    for (const toml::node& element : *array) {
      const auto entry = parse_entry(element.value_or(std::string_view()));
      if (entry) out.push_back(*entry);
    }
  }
  std::size_t bits = 0;
  for (const canopen::PdoEntry& entry : out) bits += entry.bits;
  if (array == nullptr || out.size() != array->size() || out.empty() || bits > 64)
    complain(key, found_text(node), R"(1 to 8 entries like "6064:01/32", at most 64 bits together)");
  return out;
}

ProfileTable ProfileTable::table(std::string_view key) {
  const toml::node* node = find(key);
  const toml::table* inner = node == nullptr ? nullptr : node->as_table();
  if (node != nullptr && inner == nullptr) complain(key, found_text(node), "a table");
  return {inner, prefix_ + std::string(key) + ".", problem_};
}

std::vector<ProfileTable> ProfileTable::tables(std::string_view key) {
  std::vector<ProfileTable> out;
  const toml::node* node = find(key);
  const toml::array* array = node == nullptr ? nullptr : node->as_array();
  if (node != nullptr && array == nullptr) complain(key, found_text(node), "an array of tables");
  if (array == nullptr) return out;
  for (const toml::node& element : *array) {
    if (element.as_table() == nullptr) complain(key, found_text(&element), "an array of tables");
    const std::string prefix = prefix_ + std::string(key) + "[" + std::to_string(out.size()) + "].";
    out.emplace_back(element.as_table(), prefix, problem_);
  }
  return out;
}

void ProfileTable::finish() {
  if (table_ == nullptr) return;
  for (const auto& [key, value] : *table_) {
    const std::string_view name = key.str();
    if (!asked_.contains(name)) complain(name, "unknown key", "the keys of docs/user/profiles.md");
  }
}

}  // namespace odomcalib::drivers
