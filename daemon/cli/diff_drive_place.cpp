#include "daemon/cli/diff_drive_place.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "daemon/cli/settings.hpp"

namespace odomcalib::cli {
namespace {

constexpr const char* kSeparation = "wheel_separation";
constexpr const char* kRadius = "wheel_radius";
constexpr const char* kMerge = "<<";
/// Begins the parameters of a node of ROS 2.
constexpr const char* kParameters = "ros__parameters";
/// ROS 1: takes the place of those of both wheels where it is there.
constexpr const char* kOfBothWheels = "wheel_radius_multiplier";

/// Characters of the whole text, as the library counts them.
struct Span {
  std::size_t begin = 0, end = 0;
};

struct YamlValue {
  std::string key, text;
  Span span;
  std::size_t line = 0, key_column = 0;
  enum class Kind { plain, quoted, reference, collection } kind = Kind::plain;
  bool shared = false;  ///< has a name by which other places may refer to it
};

struct YamlMapping {
  std::optional<std::size_t> outer;  ///< the mapping that holds it, by number; none: it is the outermost
  std::string own_key;               ///< under which it stands there; empty in a sequence
  std::size_t line = 0;
  bool flow = false, shared = false;
  std::vector<YamlValue> values;

  [[nodiscard]] std::vector<const YamlValue*> of(std::string_view key) const {
    std::vector<const YamlValue*> found;
    for (const YamlValue& value : values)
      if (value.key == key) found.push_back(&value);
    return found;
  }
};

Error at_line(const std::string& where, std::size_t line, const std::string& what,
              const std::string& remedy) {
  return {ErrorCode::format, what, fmt::format("{}:{}", where, line), remedy + "; nothing was written"};
}

/// Follows the events of a document, and keeps each mapping with its keys and values.
class MappingReader {
 public:
  void take(const yaml_event_t& event) {
    switch (event.type) {
      case YAML_SCALAR_EVENT:
        take_scalar(event);
        break;
      case YAML_ALIAS_EVENT:
        take_value(event, YamlValue::Kind::reference, "*" + text_of(event.data.alias.anchor), false);
        break;
      case YAML_SEQUENCE_START_EVENT:
        begin(event, event.data.sequence_start.anchor != nullptr, std::nullopt);
        break;
      case YAML_MAPPING_START_EVENT:
        begin(event, event.data.mapping_start.anchor != nullptr,
              event.data.mapping_start.style == YAML_FLOW_MAPPING_STYLE);
        break;
      case YAML_SEQUENCE_END_EVENT:
      case YAML_MAPPING_END_EVENT:
        open_.pop_back();
        break;
      default:
        break;
    }
  }

  [[nodiscard]] const std::vector<YamlMapping>& mappings() const { return mappings_; }

 private:
  struct Open {
    std::optional<std::size_t> mapping;  ///< in mappings_; a sequence has none
    bool shared = false;
    bool value_next = false;
    std::string key = {};
    std::size_t key_column = 0;
  };

  static std::string text_of(const yaml_char_t* text) { return reinterpret_cast<const char*>(text); }

  void take_scalar(const yaml_event_t& event) {
    const auto& scalar = event.data.scalar;
    const std::string text(reinterpret_cast<const char*>(scalar.value), scalar.length);
    if (!open_.empty() && open_.back().mapping && !open_.back().value_next) {
      open_.back().key = text;
      open_.back().key_column = event.start_mark.column;
      open_.back().value_next = true;
      return;
    }
    const bool plain = scalar.style == YAML_PLAIN_SCALAR_STYLE && scalar.tag == nullptr;
    take_value(event, plain ? YamlValue::Kind::plain : YamlValue::Kind::quoted, text,
               scalar.anchor != nullptr);
  }

  void take_value(const yaml_event_t& event, YamlValue::Kind kind, const std::string& text, bool shared) {
    if (open_.empty() || !open_.back().mapping) return;
    Open& open = open_.back();
    if (!open.value_next) {  // a reference or a collection as a key: none of ours
      open.key.clear();
      open.value_next = true;
      return;
    }
    open.value_next = false;
    mappings_[*open.mapping].values.push_back({open.key,
                                               text,
                                               {event.start_mark.index, event.end_mark.index},
                                               event.start_mark.line + 1,
                                               open.key_column,
                                               kind,
                                               shared});
  }

  void begin(const yaml_event_t& event, bool named, std::optional<bool> flow) {
    take_value(event, YamlValue::Kind::collection, "", named);
    Open inner;
    inner.shared = named || (!open_.empty() && open_.back().shared);
    if (flow) {
      inner.mapping = mappings_.size();
      const auto around = std::find_if(open_.rbegin(), open_.rend(),
                                       [](const Open& outer) { return outer.mapping.has_value(); });
      const bool is_value = !open_.empty() && open_.back().mapping.has_value();
      mappings_.push_back({around == open_.rend() ? std::nullopt : around->mapping,
                           is_value ? open_.back().key : "",
                           event.start_mark.line + 1,
                           *flow,
                           inner.shared,
                           {}});
    }
    open_.push_back(std::move(inner));
  }

  std::vector<YamlMapping> mappings_;
  std::vector<Open> open_;
};

struct DeleteParser {
  void operator()(yaml_parser_t* parser) const {
    yaml_parser_delete(parser);
    delete parser;  // NOLINT(cppcoreguidelines-owning-memory): of the unique_ptr that this is for
  }
};

Result<std::vector<YamlMapping>> mappings_of(const std::string& yaml, const std::string& where) {
  const std::unique_ptr<yaml_parser_t, DeleteParser> parser(new yaml_parser_t{});
  if (yaml_parser_initialize(parser.get()) == 0) return Error{ErrorCode::io, "out of memory", where, ""};
  // Other encodings have other bytes for what is counted in characters.
  yaml_parser_set_encoding(parser.get(), YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(parser.get(), reinterpret_cast<const unsigned char*>(yaml.data()),
                               yaml.size());
  MappingReader reader;
  for (bool ended = false; !ended;) {
    yaml_event_t event{};
    if (yaml_parser_parse(parser.get(), &event) == 0)
      return at_line(where, parser->problem_mark.line + 1,
                     fmt::format("is no YAML: {}", parser->problem != nullptr ? parser->problem : "damaged"),
                     "name the file with the controller's parameters");
    reader.take(event);
    ended = event.type == YAML_STREAM_END_EVENT;
    yaml_event_delete(&event);
  }
  return reader.mappings();
}

/// The lines of the mappings that have a key, as a list.
std::string lines_with(const std::vector<YamlMapping>& mappings, const char* key) {
  std::vector<std::size_t> lines;
  for (const YamlMapping& mapping : mappings)
    for (const YamlValue* value : mapping.of(key)) lines.push_back(value->line);
  return lines.empty() ? "nowhere" : fmt::format("in line {}", fmt::join(lines, ", "));
}

Result<const YamlMapping*> place_in(const std::vector<YamlMapping>& mappings, const std::string& where) {
  std::vector<const YamlMapping*> places;
  std::vector<std::size_t> lines;
  for (const YamlMapping& mapping : mappings) {
    if (mapping.of(kSeparation).empty() || mapping.of(kRadius).empty()) continue;
    places.push_back(&mapping);
    lines.push_back(mapping.of(kRadius).front()->line);
  }
  if (places.size() == 1) return places.front();
  if (places.empty())
    return Error{ErrorCode::format,
                 fmt::format("no place has both {} ({}) and {} ({})", kSeparation,
                             lines_with(mappings, kSeparation), kRadius, lines_with(mappings, kRadius)),
                 where, "name the file with the parameters of diff_drive_controller; nothing was written"};
  return Error{ErrorCode::format,
               fmt::format("{} places have {} and {}: lines {}", places.size(), kSeparation, kRadius,
                           fmt::join(lines, ", ")),
               where, "change one of them by hand, with what export prints; nothing was written"};
}

/// Keys that lead to a mapping, the outermost first.
std::vector<std::string> path_of(const std::vector<YamlMapping>& mappings, const YamlMapping& mapping) {
  std::vector<std::string> keys;
  for (const YamlMapping* at = &mapping; at->outer; at = &mappings[*at->outer]) keys.push_back(at->own_key);
  std::reverse(keys.begin(), keys.end());
  return keys;
}

/// Parameters of a node of ROS.
struct NodeSection {
  std::vector<std::string> node;       ///< names between slashes, from the keys above "ros__parameters"
  std::vector<std::string> parameter;  ///< keys from there on, which begin the parameter's name
};

NodeSection section_of(const std::vector<std::string>& path) {
  const auto end = std::find(path.begin(), path.end(), kParameters);
  NodeSection section{{}, {end, path.end()}};
  for (auto key = path.begin(); key != end; ++key)
    for (std::size_t at = 0; at <= key->size();) {
      const std::size_t slash = std::min(key->find('/', at), key->size());
      if (slash > at) section.node.push_back(key->substr(at, slash - at));
      at = slash + 1;
    }
  return section;
}

bool is_wildcard(const std::string& name) { return name.find('*') != std::string::npos; }

/// Whether a node may have both names; "**" stands for any number of names, another wildcard for one.
bool are_of_one_node(std::span<const std::string> a, std::span<const std::string> b) {
  if (a.empty() && b.empty()) return true;
  if (a.size() + b.size() > settings::kMostNamesOfNodes) return true;
  if (!a.empty() && a[0] == "**")
    return are_of_one_node(a.subspan(1), b) || (!b.empty() && are_of_one_node(a, b.subspan(1)));
  if (!b.empty() && b[0] == "**") return are_of_one_node(b, a);
  if (a.empty() || b.empty()) return false;
  return (a[0] == b[0] || is_wildcard(a[0]) || is_wildcard(b[0])) &&
         are_of_one_node(a.subspan(1), b.subspan(1));
}

bool has_wildcard(const std::vector<std::string>& node) {
  return std::any_of(node.begin(), node.end(), is_wildcard);
}

/// A value that the controller takes beside those of the place, or instead of them.
struct Rival {
  const YamlValue* value;
  double wanted;
};

using WantedValues = std::vector<std::pair<std::string, double>>;

/// The first value of a mapping that is another than the wanted one.
std::optional<Rival> other_value(const YamlMapping& mapping, const WantedValues& values) {
  for (const auto& [key, wanted] : values)
    for (const YamlValue* value : mapping.of(key))
      if (value->kind != YamlValue::Kind::plain || number_in(value->text) != wanted)
        return Rival{value, wanted};
  return std::nullopt;
}

/// Finds values elsewhere that may count for the controller of a place.
class RivalSearch {
 public:
  RivalSearch(const std::vector<YamlMapping>& mappings, const YamlMapping& place, const WantedValues& values)
      : mappings_(mappings), place_(place), own_(section_of(path_of(mappings, place))), all_(values) {
    all_.insert(all_.end(), for_both_.begin(), for_both_.end());
  }

  [[nodiscard]] std::optional<Rival> first() const {
    for (const YamlMapping& mapping : mappings_) {
      const bool is_place = &mapping == &place_;
      if (!other_value(mapping, is_place ? for_both_ : all_)) continue;
      if (is_place || mapping.shared) return other_value(mapping, is_place ? for_both_ : all_);
      const NodeSection section = section_of(path_of(mappings_, mapping));
      if (section.parameter != own_.parameter || !are_of_one_node(section.node, own_.node)) continue;
      if (const auto found = other_value(mapping, yields(mapping, section) ? for_both_ : all_)) return found;
    }
    return std::nullopt;
  }

 private:
  /// ROS 2 takes the later one of two sections of a node; other readers may take the one without wildcards.
  [[nodiscard]] bool yields(const YamlMapping& mapping, const NodeSection& section) const {
    return mapping.line < place_.line && has_wildcard(section.node) && !has_wildcard(own_.node);
  }

  const std::vector<YamlMapping>& mappings_;
  const YamlMapping& place_;
  const NodeSection own_;
  const WantedValues for_both_ = {{kOfBothWheels, 1.0}};
  WantedValues all_;
};

Error rival_error(const Rival& rival, const std::string& where) {
  const YamlValue& value = *rival.value;
  const std::string shown = value.kind == YamlValue::Kind::collection ? "" : ": " + value.text;
  return at_line(
      where, value.line,
      fmt::format("{}{} stands beside the parameters that change, and may apply to the same controller",
                  value.key, shown),
      value.key == kOfBothWheels
          ? "remove it or make it 1.0: it would take the place of both wheels' multipliers"
          : fmt::format("remove it, or make it {}", real_text(rival.wanted)));
}

/// YAML counts characters, an edit counts bytes.
std::size_t byte_of(const std::string& text, std::size_t characters) {
  std::size_t at = 0;
  for (; at < text.size() && characters > 0; --characters)
    for (++at; at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;) ++at;
  return at;
}

/// Why this is not a number that can be replaced by another; empty: it is one.
std::string hindrance(const YamlValue& value) {
  if (value.kind == YamlValue::Kind::reference) return "refers to another place (" + value.text + ")";
  if (value.shared) return "has a name that other places may refer to";
  if (value.text.find("${") != std::string::npos || value.text.find("$(") != std::string::npos)
    return "is an expression (" + value.text + ")";
  if (value.kind != YamlValue::Kind::plain || !number_in(value.text)) return "is no number";
  return "";
}

class DiffDriveEditor {
 public:
  DiffDriveEditor(const std::string& yaml, const YamlMapping& place, const std::string& where)
      : yaml_(yaml), place_(place), where_(where) {}

  Result<std::vector<TextEdit>> edits(const std::vector<std::pair<std::string, double>>& values) {
    if (place_.shared || !place_.of(kMerge).empty())
      return at_line(where_, place_.line, "these parameters are shared with another place (&, << or *)",
                     "change them by hand, with what export prints");
    std::string missing;
    for (const auto& [key, number] : values) {
      const auto found = place_.of(key);
      if (found.empty()) missing += addition(key, number);
      if (found.empty()) continue;
      if (found.size() > 1)
        return at_line(where_, found.back()->line,
                       fmt::format("{} stands there a second time, first in line {}", key, found[0]->line),
                       "remove one of them");
      if (auto taken = replace(*found.front(), number); !taken) return taken.error();
    }
    if (!missing.empty()) edits_.push_back({end_of_radius(), 0, missing});
    return edits_;
  }

 private:
  Result<void> replace(const YamlValue& value, double number) {
    const std::size_t begin = byte_of(yaml_, value.span.begin), end = byte_of(yaml_, value.span.end);
    std::string why = hindrance(value);
    if (why.empty() && yaml_.substr(begin, end - begin) != value.text) why = "cannot be located";
    if (!why.empty())
      return at_line(where_, value.line, fmt::format("{} {}", value.key, why),
                     fmt::format("make it {} by hand", real_text(number)));
    if (number_in(value.text) != number) edits_.push_back({begin, end - begin, real_text(number)});
    return {};
  }

  [[nodiscard]] const YamlValue& radius() const { return *place_.of(kRadius).front(); }

  /// End of the value within braces, else of its line, behind a comment.
  [[nodiscard]] std::size_t end_of_radius() const {
    const std::size_t end = byte_of(yaml_, radius().span.end);
    if (place_.flow) return end;
    const std::size_t line_end = std::min(yaml_.find('\n', end), yaml_.size());
    return line_end > end && yaml_[line_end - 1] == '\r' ? line_end - 1 : line_end;
  }

  [[nodiscard]] std::string addition(const std::string& key, double number) const {
    if (place_.flow) return fmt::format(", {}: {}", key, real_text(number));
    const bool carriage = end_of_radius() < yaml_.size() && yaml_[end_of_radius()] == '\r';
    return fmt::format("{}{:{}}{}: {}", carriage ? "\r\n" : "\n", "", radius().key_column, key,
                       real_text(number));
  }

  const std::string& yaml_;
  const YamlMapping& place_;
  const std::string& where_;
  std::vector<TextEdit> edits_;
};

}  // namespace

Result<std::vector<TextEdit>> diff_drive_edits(const std::string& yaml,
                                               const std::vector<std::pair<std::string, double>>& values,
                                               const std::string& where) {
  const auto mappings = mappings_of(yaml, where);
  if (!mappings) return mappings.error();
  const auto place = place_in(mappings.value(), where);
  if (!place) return place.error();
  if (const auto rival = RivalSearch(mappings.value(), *place.value(), values).first())
    return rival_error(*rival, where);
  return DiffDriveEditor(yaml, *place.value(), where).edits(values);
}

}  // namespace odomcalib::cli
