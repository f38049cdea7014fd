// Tuple files of Censi et al.: concatenated JSON objects {T, phi_l, phi_r, sm}, not always one a line.
#include "proto/recording/recording_readers.hpp"
#include "proto/wire/json_fields.hpp"

namespace odomcalib {
namespace {

/// Length of the object that begins the text, or npos when it does not end.
std::size_t object_length(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_string = !in_string;
    } else if (!in_string && c == '{') {
      ++depth;
    } else if (!in_string && c == '}' && --depth == 0) {
      return i + 1;
    }
  }
  return std::string_view::npos;
}

void add_tuple(const JsonFields& fields, RecordingBuilder& builder) {
  const auto& motion = fields[Array::tuple_motion];
  if (motion.size() != 3) return builder.discard("tuple", "\"sm\" is not three numbers");
  builder.add_increment({fields[Scalar::tuple_duration],
                         fields[Scalar::tuple_left],
                         fields[Scalar::tuple_right],
                         {motion[0], motion[1], motion[2]}});
}

}  // namespace

void read_tuples(std::string_view text, RecordingBuilder& builder) {
  JsonFields fields;
  for (std::size_t start = text.find('{'); start != std::string_view::npos; start = text.find('{')) {
    text.remove_prefix(start);
    // An object without its end, or one that a damaged byte has glued to the next: go on with the next line.
    const std::size_t line = text.find('\n');
    const std::size_t length = object_length(text.substr(0, line));
    if (length == std::string_view::npos) {
      builder.discard("tuple", line == std::string_view::npos ? "cut off" : "not valid JSON");
      text.remove_prefix(line == std::string_view::npos ? text.size() : line);
      continue;
    }
    if (parse_fields(text.substr(0, length), fields))
      add_tuple(fields, builder);
    else
      builder.discard("tuple", "not valid JSON");
    text.remove_prefix(length);
  }
}

}  // namespace odomcalib
