#include "proto/recording.hpp"

#include "proto/file_bytes.hpp"
#include "proto/recording_readers.hpp"

namespace odomcalib {
namespace {

enum class Form { unknown, nothing, jsonl };

Form recognise(std::string_view bytes) {
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos) return Form::nothing;
  return bytes[start] == '{' ? Form::jsonl : Form::unknown;
}

Error unknown_form(const std::string& where) {
  return {ErrorCode::format, "is not a recording in a known format", where,
          "known are JSON Lines, LCM event logs, Censi tuples and CARMEN logs, plain or gzip"};
}

Result<Recording> read_bytes(std::string_view bytes, const std::string& where, RecordingBuilder builder,
                             const RobotDescription* fallback) {
  using Need = RecordingBuilder::RobotNeed;
  switch (recognise(bytes)) {
    case Form::nothing:
      return Error{ErrorCode::empty, "holds no data", where, "record again"};
    case Form::jsonl:
      read_jsonl(bytes, builder);
      return std::move(builder).finish(where, fallback, Need::required);
    case Form::unknown:
      break;
  }
  return unknown_form(where);
}

}  // namespace

Result<Recording> read_recording(const std::filesystem::path& path, const RobotDescription* fallback) {
  auto file = read_file_bytes(path);
  if (!file) return file.error();
  RecordingBuilder builder;
  const std::string sha256 = sha256_hex(file.value());
  if (is_gzip(file.value())) {
    auto unpacked = gunzip(file.value());
    if (!unpacked.whole) builder.discard("file", unpacked.problem);
    file = std::move(unpacked.bytes);
  }
  auto recording = read_bytes(file.value(), path.string(), std::move(builder), fallback);
  if (!recording) return recording;
  recording.value().name = path.filename().string();
  recording.value().sha256 = sha256;
  return recording;
}

}  // namespace odomcalib
