#include "proto/recording/recording.hpp"

#include "proto/file_bytes.hpp"
#include "proto/recording/recording_readers.hpp"
#include "proto/wire/event_log.hpp"

namespace odomcalib {
namespace {

enum class Form { unknown, nothing, event_log, jsonl, tuples, carmen, pose_graph };

Form recognise_json(std::string_view text) {
  const auto begin = text.substr(0, 4096);
  const bool tuples =
      begin.find("\"phi_l\"") != std::string_view::npos && begin.find("\"type\"") == std::string_view::npos;
  return tuples ? Form::tuples : Form::jsonl;
}

/// A file whose begin was lost is still one of ours when a line of it is.
bool has_json_line(std::string_view bytes) {
  const auto begin = bytes.substr(0, std::size_t{1} << 20);
  return begin.find("\n{\"type\"") != std::string_view::npos && begin.find('\0') == std::string_view::npos;
}

Form recognise(std::string_view bytes) {
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos) return Form::nothing;
  const auto text = bytes.substr(start);
  if (text.starts_with('{')) return recognise_json(text);
  if (looks_like_event_log(bytes)) return Form::event_log;
  if (looks_like_carmen(text)) return Form::carmen;
  if (text.starts_with("VERTEX") || text.starts_with("EDGE")) return Form::pose_graph;
  return has_json_line(text) ? Form::jsonl : Form::unknown;
}

Error unknown_form(const std::string& where) {
  return {ErrorCode::format, "is not a recording in a known format", where,
          "known are JSON Lines, LCM event logs, Censi's tuple and JSON logs and CARMEN logs, plain or gzip"};
}

Result<Recording> read_content(std::string_view bytes, const std::string& where, RecordingBuilder builder,
                               const RobotDescription* fallback) {
  using Need = RecordingBuilder::RobotNeed;
  Need need = Need::required;
  switch (recognise(bytes)) {
    case Form::nothing:
      return Error{ErrorCode::empty, "holds no data", where, "record again"};
    case Form::pose_graph:
      return Error{ErrorCode::format, "is a pose graph, not a recording", where,
                   "use \"odomcalibctl graph\""};
    case Form::unknown:
      return unknown_form(where);
    case Form::jsonl:
      read_jsonl(bytes, builder);
      break;
    case Form::event_log:
      read_event_log(bytes, builder);
      break;
    case Form::carmen:
      read_carmen(bytes, fallback, builder);
      break;
    case Form::tuples:
      // Wheel motion is in rad already: what is estimated from it is absolute and needs no nominal values.
      read_tuples(bytes, builder);
      need = Need::optional;
      break;
  }
  return std::move(builder).finish(where, fallback, need);
}

}  // namespace

Result<Recording> read_recording_bytes(const std::string& bytes, const std::filesystem::path& name,
                                       const RobotDescription* fallback) {
  RecordingBuilder builder;
  Unpacked unpacked;
  const bool packed = is_gzip(bytes);
  if (packed) unpacked = gunzip(bytes);
  if (!unpacked.whole) builder.discard("file", unpacked.problem);
  auto recording = read_content(packed ? unpacked.bytes : bytes, name.string(), std::move(builder), fallback);
  if (!recording) return recording;
  recording.value().name = name.filename().string();
  recording.value().sha256 = sha256_hex(bytes);
  return recording;
}

Result<Recording> read_recording(const std::filesystem::path& path, const RobotDescription* fallback) {
  const auto file = read_file_bytes(path);
  if (!file) return file.error();
  return read_recording_bytes(file.value(), path, fallback);
}

}  // namespace odomcalib
