#include "daemon/config/toml_reader.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>
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

/// "; 150 looks like mm: write 0.15" of a length that a millimetre's factor makes one.
std::string in_mm(const std::string& key, double value, const config::settings::Bounds& allowed) {
  constexpr double kMetresInMm = 1e-3;
  const bool is_length = key.ends_with("diameter") || key.ends_with("track_width");
  const double metres = kMetresInMm * value;
  if (!is_length || !(value > allowed.most) || metres < allowed.least || metres > allowed.most) return "";
  return fmt::format(" m; {} looks like mm: write {}", value, metres);
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
  if (value && std::isfinite(*value) && *value >= allowed.least && *value <= allowed.most) return *value;
  state_->complain(key, fmt::format("a number from {} to {}{}", allowed.least, allowed.most,
                                    value ? in_mm(key, *value, allowed) : ""));
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
  const auto* array = node.as_array();
  std::array<double, 3> pose{};
  bool good = array != nullptr && array->size() == pose.size();
  for (std::size_t i = 0; good && i < pose.size(); ++i) {
    const auto value = (*array)[i].value<double>();
    good = value && std::isfinite(*value);
    if (good) pose.at(i) = *value;
  }
  if (good) return pose;
  state_->complain(key, "a list of three numbers: x in m, y in m, yaw in rad");
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
