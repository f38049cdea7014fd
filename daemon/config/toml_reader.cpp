#include "daemon/config/toml_reader.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <regex>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include "proto/file_bytes.hpp"
#include "proto/near_miss.hpp"

namespace odomcalib {

struct TomlReader::State {
  toml::table table;
  std::string where, manual;
  std::set<std::string> asked;
  std::vector<std::string> left;  ///< prefixes
  std::map<std::string, std::string> translations;
  std::optional<Error> problem;

  toml::node_view<const toml::node> find(const std::string& key) {
    asked.insert(key);
    return static_cast<const toml::table&>(table).at_path(key);
  }
  void complain(const std::string& key, const std::string& allowed) {
    if (!problem)
      problem = Error{ErrorCode::format, fmt::format("key \"{}\" is not {}", key, allowed), where,
                      "correct the file; " + manual + " lists the keys"};
  }
  [[nodiscard]] bool is_left(const std::string& key) const {
    return std::any_of(left.begin(), left.end(), [&](const auto& prefix) { return key.starts_with(prefix); });
  }
  [[nodiscard]] std::string remedy(const std::string& key) const {
    const auto known = translations.find(key);
    if (known != translations.end()) return "write " + known->second;
    const auto meant = near_miss(key, asked);
    return (meant ? "did you mean \"" + *meant + "\"? " : "remove or correct it; ") + manual +
           " lists the keys";
  }
};

namespace {

// As the file spells it: without its quotes a key with a dot, or of no letters, would pass for a path of ours
// that nobody reads there.
std::string spelled(const toml::key& key) {
  const std::string_view name = key.str();
  const bool bare = !name.empty() && name.find('.') == std::string_view::npos;
  return bare ? std::string(name) : fmt::format("\"{}\"", name);
}

void collect_leaves(const toml::table& table, const std::string& prefix, std::set<std::string>& keys) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix.empty() ? spelled(key) : prefix + "." + spelled(key);
    if (const auto* inner = node.as_table())
      collect_leaves(*inner, path, keys);
    else
      keys.insert(path);
  }
}

/// Remedy for a line as people write it who know another format.
std::string syntax_remedy(const std::string& text, std::size_t line) {
  std::istringstream lines(text);
  std::string wrong;
  for (std::size_t k = 0; k < line && std::getline(lines, wrong); ++k) {
  }
  std::smatch found;
  if (std::regex_match(wrong, found, std::regex(R"(\s*([A-Za-z_.]+)\s*:\s*(\S.*))")))
    return "this is YAML; write TOML: " + found[1].str() + " = " + found[2].str();
  if (std::regex_match(wrong, found, std::regex(R"((\s*[A-Za-z_.]+\s*=\s*-?[0-9]+),([0-9]+)\s*(#.*)?)")))
    return "write a decimal point: " + found[1].str() + "." + found[2].str();
  return "correct the TOML syntax";
}

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

bool is_within(double value, const config::settings::Bounds& allowed) {
  return std::isfinite(value) && value >= allowed.least && value <= allowed.most;
}

/// "; 150 looks like mm: write 0.15" of a value that another usual unit makes one.
std::string in_other_unit(double value, const config::settings::Bounds& allowed) {
  constexpr double kMetresInMm = 1e-3;
  const bool is_length = std::string_view(allowed.unit) == "m";
  const double factor = is_length ? kMetresInMm : std::numbers::pi / 180.0;
  if (std::string_view(allowed.unit).empty() || !is_within(factor * value, allowed)) return "";
  return fmt::format("; {} looks like {}: write {:.6g}", value, is_length ? "mm" : "degrees", factor * value);
}

/// @param value as the file has it; NaN where it is no number
std::string range_text(double value, const config::settings::Bounds& allowed) {
  return fmt::format("from {:.10g} to {:.10g}{}{}{}", allowed.least, allowed.most,
                     std::string_view(allowed.unit).empty() ? "" : " ", allowed.unit,
                     in_other_unit(value, allowed));
}

/// Description of what the file should have; empty: it has a pose, which is `pose` now.
std::string take_pose(const toml::array* array, std::array<double, 3>& pose) {
  constexpr std::array kBounds = {config::settings::kLidarPlace_m, config::settings::kLidarPlace_m,
                                  config::settings::kLidarYaw_rad};
  constexpr std::array kNames = {"x", "y", "yaw"};
  bool numbers = array != nullptr && array->size() == pose.size();
  for (std::size_t i = 0; numbers && i < pose.size(); ++i) {
    pose.at(i) = (*array)[i].value<double>().value_or(kNoNumber);
    numbers = std::isfinite(pose.at(i));
  }
  if (!numbers) return "a list of three numbers: x in m, y in m, yaw in rad";
  for (std::size_t i = 0; i < pose.size(); ++i)
    if (!is_within(pose.at(i), kBounds.at(i)))
      return fmt::format("a place of a lidar: {} is {}", kNames.at(i), range_text(pose.at(i), kBounds.at(i)));
  return "";
}

}  // namespace

TomlReader::TomlReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
TomlReader::TomlReader(TomlReader&&) noexcept = default;
TomlReader& TomlReader::operator=(TomlReader&&) noexcept = default;
TomlReader::~TomlReader() = default;

Result<TomlReader> TomlReader::read(const std::filesystem::path& path, const std::string& manual) {
  const auto bytes = read_file_bytes(path);
  if (!bytes) return bytes.error();
  return parse(bytes.value(), path.string(), manual);
}

Result<TomlReader> TomlReader::parse(const std::string& text, const std::string& where,
                                     const std::string& manual) {
  auto state = std::make_unique<State>();
  state->where = where;
  state->manual = manual;
  try {
    state->table = toml::parse(text);
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    return Error{ErrorCode::format, std::string(error.description()),
                 fmt::format("{}:{}:{}", where, at.line, at.column), syntax_remedy(text, at.line)};
  }
  return TomlReader(std::move(state));
}

double TomlReader::number(const std::string& key, double otherwise, const config::settings::Bounds& allowed) {
  const auto node = state_->find(key);
  if (!node) return otherwise;
  const auto value = node.value<double>();
  if (value && is_within(*value, allowed)) return *value;
  state_->complain(key, "a number " + range_text(value.value_or(kNoNumber), allowed));
  return otherwise;
}

std::string TomlReader::text(const std::string& key, const std::string& otherwise) {
  const auto node = state_->find(key);
  if (!node) return otherwise;
  if (const auto value = node.value<std::string>()) return *value;
  state_->complain(key, "a text in quotes");
  return otherwise;
}

bool TomlReader::flag(const std::string& key, bool otherwise) {
  const auto node = state_->find(key);
  if (!node) return otherwise;
  if (const auto value = node.value<bool>()) return *value;
  state_->complain(key, "true or false");
  return otherwise;
}

std::optional<std::array<double, 3>> TomlReader::pose(const std::string& key) {
  const auto node = state_->find(key);
  if (!node) return std::nullopt;
  std::array<double, 3> pose{};
  const std::string wanted = take_pose(node.as_array(), pose);
  if (wanted.empty()) return pose;
  state_->complain(key, wanted);
  return std::nullopt;
}

bool TomlReader::has_table(const std::string& key) const { return state_->table.at_path(key).is_table(); }

void TomlReader::leave(const std::string& prefix) { state_->left.push_back(prefix); }

void TomlReader::translate(const std::string& foreign, const std::string& instead) {
  state_->translations[foreign] = instead;
}

std::optional<Error> TomlReader::problem() const {
  if (state_->problem) return state_->problem;
  std::set<std::string> keys;
  collect_leaves(state_->table, "", keys);
  for (const auto& key : keys)
    if (!state_->asked.contains(key) && !state_->is_left(key))
      return Error{ErrorCode::format, fmt::format("unknown key \"{}\"", key), state_->where,
                   state_->remedy(key)};
  return std::nullopt;
}

}  // namespace odomcalib
