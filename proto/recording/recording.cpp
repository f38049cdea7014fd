#include "proto/recording/recording.hpp"

#include <optional>
#include <utility>

#include "proto/file_bytes.hpp"
#include "proto/recording/left_out.hpp"
#include "proto/recording/overview.hpp"
#include "proto/recording/recording_readers.hpp"
#include "proto/recording/ros/choice.hpp"
#include "proto/recording/ros/containers.hpp"
#include "proto/recording/ros/folder.hpp"
#include "proto/recording/ros/topic_overview.hpp"
#include "proto/recording/ros/topics.hpp"
#include "proto/wire/event_log.hpp"

namespace odomcalib {
namespace {

/// Bytes of a packed file that tell its form. Derived: recognise looks at less.
constexpr std::size_t kRecognised_bytes = std::size_t{1} << 20;

enum class Form { unknown, nothing, event_log, jsonl, tuples, carmen, pose_graph, ros, calibration };

Form recognise_json(std::string_view text) {
  const auto begin = text.substr(0, 4096);
  if (begin.substr(0, begin.find(',')).find("\"odomcalib-calibration/") != std::string_view::npos)
    return Form::calibration;
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
  if (ros::looks_like_container(bytes)) return Form::ros;
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
          "known are JSON Lines, LCM event logs, ROS bags (2.0), rosbag2 and MCAP recordings, Censi's tuple "
          "and JSON "
          "logs and CARMEN logs, plain or gzip"};
}

Error has_no_topics(const std::string& where) {
  return {ErrorCode::usage, "has no topics to choose from", where,
          "leave --topic out: only ROS recordings have them"};
}

std::string name_of(Form form, std::string_view bytes) {
  switch (form) {
    case Form::ros:
      return ros::container_name(bytes);
    case Form::jsonl:
      return "JSON Lines";
    case Form::event_log:
      return "LCM event log";
    case Form::carmen:
      return "CARMEN log";
    case Form::tuples:
      return "Censi's tuple file";
    case Form::pose_graph:
      return "pose graph";
    case Form::calibration:
      return "calibration";
    case Form::nothing:
    case Form::unknown:
      break;
  }
  return "unknown form";
}

std::optional<Error> read_ros(std::string_view bytes, const std::string& where, const TopicChoices& topics,
                              RecordingBuilder& builder, const UnpackLimit& limit, Overview& overview) {
  ros::Collector collector(ros::kinds_of(topics), limit);
  const auto error = ros::read_container(bytes, where, collector);
  overview.topics = ros::overview_of(collector.topics());
  return error ? error : ros::fill(builder, collector, topics, where);
}

/// Wishes of the caller of a reader.
struct Wanted {
  const RobotDescription* fallback;
  const TopicChoices& topics;
  const UnpackLimit& limit;
  Intensities intensities = Intensities::kept;
};

/// One file that comes in pieces, packed or not. JSON Lines are read as they come: their text is several
/// times the recording. Of other forms all bytes are kept until the last one is there.
class FileContent {
 public:
  /// @param size of the file, bytes
  /// @param overview outlives it
  FileContent(std::filesystem::path name, std::size_t size, const Wanted& wanted, Overview& overview)
      : name_(std::move(name)),
        size_(size),
        wanted_(wanted),
        limit_(wanted.limit),
        overview_(overview),
        builder_(wanted.intensities) {}

  void take(std::string_view piece) {
    hash_.take(piece);
    if (first_ && is_gzip(piece))
      unpacking_.emplace(limit_.of(size_), [this](std::string_view unpacked) { take_unpacked(unpacked); });
    else if (first_)
      bytes_.reserve(size_);
    first_ = false;
    if (unpacking_)
      unpacking_->feed(piece);
    else
      take_unpacked(piece);
  }

  Result<Recording> finish() && {
    const Unpacked unpacked = unpacking_ ? unpacking_->finish() : Unpacked{};
    if (unpacked.over_limit) return limit_.refusal(size_, name_.string());
    if (!unpacked.whole) builder_.discard("file", unpacked.problem);
    auto recording = finished();
    if (!recording) return recording;
    recording.value().name = name_.filename().string();
    recording.value().sha256 = hash_.hex();
    tell_where_it_ends(recording.value());
    return recording;
  }

 private:
  void take_unpacked(std::string_view piece) {
    if (lines_) return lines_->take(piece);
    const bool was_told = bytes_.size() >= kRecognised_bytes;
    bytes_.append(piece);
    if (was_told || bytes_.size() < kRecognised_bytes || recognise(bytes_) != Form::jsonl) return;
    lines_.emplace(builder_).take(bytes_);
    std::string().swap(bytes_);
    limit_ = limit_.in_pieces();
    if (unpacking_) unpacking_->allow(limit_.of(size_));
  }

  Result<Recording> finished() {
    using Need = RecordingBuilder::RobotNeed;
    Need need = Need::required;
    const std::string where = name_.string();
    const Form form = lines_ ? Form::jsonl : recognise(bytes_);
    overview_.form = name_of(form, bytes_);
    if (form != Form::ros && !wanted_.topics.empty()) return has_no_topics(where);
    switch (form) {
      case Form::ros:
        if (auto error = read_ros(bytes_, where, wanted_.topics, builder_, wanted_.limit, overview_))
          return *error;
        break;
      case Form::nothing:
        return Error{ErrorCode::empty, "holds no data", where, "record again"};
      case Form::calibration:
        return Error{ErrorCode::format, "is a calibration, not a recording", where,
                     "odomcalibctl report shows it; solve the recording that it was made from"};
      case Form::pose_graph:
        return Error{ErrorCode::format, "is a pose graph, not a recording", where,
                     "use \"odomcalibctl graph\""};
      case Form::unknown:
        return unknown_form(where);
      case Form::jsonl:
        if (!lines_) lines_.emplace(builder_).take(bytes_);
        lines_->finish();
        break;
      case Form::event_log:
        read_event_log(bytes_, builder_);
        break;
      case Form::carmen:
        read_carmen(bytes_, wanted_.fallback, builder_);
        break;
      case Form::tuples:
        // Wheel motion is in rad already: what is estimated from it is absolute and needs no nominal values.
        read_tuples(bytes_, builder_);
        need = Need::optional;
        break;
    }
    return std::move(builder_).finish(where, wanted_.fallback, need);
  }

  std::filesystem::path name_;
  std::size_t size_;
  Wanted wanted_;
  UnpackLimit limit_;
  Overview& overview_;
  RecordingBuilder builder_;
  Sha256 hash_;
  bool first_ = true;
  std::optional<Gunzip> unpacking_;
  std::string bytes_;  ///< unpacked
  std::optional<JsonLines> lines_;
};

Error not_understood(const std::string& text) {
  return {ErrorCode::usage, "\"" + text + "\" is no choice of a topic", "--topic",
          "write PART=TOPIC, wheels=TOPIC:LEFT,RIGHT or wheels=LEFT_TOPIC,RIGHT_TOPIC; parts are scan, "
          "wheels, wheel_speeds, odometry, gyro and "
          "pose"};
}

/// Whether the object that the text begins with has the member itself, not only an object within it: a pair
/// of scans names their types too. The text may be cut off.
bool has_member(std::string_view text, std::string_view name) {
  std::size_t depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '{' || text[i] == '[') ++depth;
    if ((text[i] == '}' || text[i] == ']') && depth > 0) --depth;
    if (text[i] != '"') continue;
    const std::size_t begin = ++i;
    while (i < text.size() && text[i] != '"') i += text[i] == '\\' ? 2 : 1;
    if (depth != 1 || i >= text.size() || text.substr(begin, i - begin) != name) continue;
    const auto next = text.find_first_not_of(" \t\r", i + 1);
    if (next != std::string_view::npos && text[next] == ':') return true;
  }
  return false;
}

}  // namespace

bool is_recording(std::string_view bytes) {
  Unpacked unpacked;
  if (is_gzip(bytes)) {
    unpacked = gunzip(bytes, UnpackLimit::allowed(kRecognised_bytes));
    bytes = unpacked.bytes;
  }
  switch (recognise(bytes)) {
    case Form::event_log:
    case Form::ros:
    case Form::tuples:
    case Form::carmen:
      return true;
    case Form::jsonl:
      return has_member(bytes.substr(0, bytes.find('\n')), "type");
    default:
      return false;
  }
}

Result<TopicChoice> parse_topic_choice(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos) return not_understood(text);
  TopicChoice choice;
  choice.part = text.substr(0, equals);
  const auto colon = text.find(':', equals);
  choice.topic = text.substr(equals + 1, colon == std::string::npos ? colon : colon - equals - 1);
  if (colon != std::string::npos) {
    const auto comma = text.find(',', colon);
    if (comma == std::string::npos) return not_understood(text);
    choice.joints = {text.substr(colon + 1, comma - colon - 1), text.substr(comma + 1)};
  }
  if (const auto comma = choice.topic.find(','); comma != std::string::npos) {
    choice.right_topic = choice.topic.substr(comma + 1);
    choice.topic.resize(comma);
    if (choice.right_topic.empty() || !choice.joints.empty()) return not_understood(text);
  }
  const bool joints = choice.part == "wheels" || choice.part == "wheel_speeds";
  const bool known = joints || choice.part == "scan" || choice.part == "odometry" || choice.part == "gyro" ||
                     choice.part == "pose";
  if (!known || choice.topic.empty() || (!joints && (!choice.joints.empty() || !choice.right_topic.empty())))
    return not_understood(text);
  return choice;
}

Result<Recording> read_recording_bytes(const std::string& bytes, const std::filesystem::path& name,
                                       const RobotDescription* fallback, const TopicChoices& topics,
                                       const UnpackLimit& limit) {
  Overview unused;
  FileContent content(name, bytes.size(), {fallback, topics, limit}, unused);
  content.take(bytes);
  return std::move(content).finish();
}

namespace {

/// Whether changes wait that SQLite has not moved into the file: a killed recorder leaves them beside it.
bool has_write_ahead_log(const std::filesystem::path& path) {
  std::error_code none;
  return std::filesystem::file_size(path.string() + "-wal", none) > 0 && !none;
}

constexpr const char* kMerge = "sqlite3 FILE 'PRAGMA wal_checkpoint(TRUNCATE)'";

std::string what_the_log_has() { return std::string("what lies in its -wal beside it; merge it: ") + kMerge; }

/// The error, with another remedy where what a file lacks may lie in its log.
Error with_log(Error error, const std::filesystem::path& path) {
  const bool is_lacking = error.code == ErrorCode::format || error.code == ErrorCode::empty;
  if (is_lacking && has_write_ahead_log(path))
    error.remedy = std::string("merge what lies in its -wal beside it first: ") + kMerge;
  return error;
}

/// All files of a rosbag2 folder as one recording; its hash is that of the hashes of its files, one a line.
Result<Recording> read_folder(const std::filesystem::path& folder, const Wanted& wanted, Overview& overview) {
  const auto found = ros::files_of(folder);
  if (!found) return found.error();
  RecordingBuilder builder(wanted.intensities);
  for (const auto& name : found.value().missing) builder.discard("file", name + " is missing");
  for (const auto& remark : found.value().remarks) builder.choose(remark);
  ros::Collector collector(ros::kinds_of(wanted.topics), wanted.limit);
  std::string hashes;
  for (const auto& path : found.value().files) {
    const auto file = read_file_bytes(path);
    if (!file) return file.error();
    hashes += sha256_hex(file.value()) + "\n";
    if (auto error = ros::read_container(file.value(), path.string(), collector))
      return with_log(*error, path);
    if (has_write_ahead_log(path))
      builder.discard("file", path.filename().string() + ": " + what_the_log_has());
  }
  overview.form = "rosbag2 folder";
  overview.topics = ros::overview_of(collector.topics());
  if (auto error = ros::fill(builder, collector, wanted.topics, folder.string())) return *error;
  auto recording =
      std::move(builder).finish(folder.string(), wanted.fallback, RecordingBuilder::RobotNeed::required);
  if (!recording) return recording;
  const auto name = folder.has_filename() ? folder : folder.parent_path();
  recording.value().name = name.filename().string();
  recording.value().sha256 = sha256_hex(hashes);
  tell_where_it_ends(recording.value());
  return recording;
}

Result<Recording> read_file(const std::filesystem::path& path, const Wanted& wanted, Overview& overview) {
  std::error_code none;
  // A pipe has no size before all of it is there.
  if (!std::filesystem::is_regular_file(path, none)) {
    const auto file = read_file_bytes(path);
    if (!file) return file.error();
    FileContent content(path, file.value().size(), wanted, overview);
    content.take(file.value());
    return std::move(content).finish();
  }
  FileContent content(path, std::filesystem::file_size(path, none), wanted, overview);
  const auto read = read_file_pieces(path, [&](std::string_view piece) { content.take(piece); });
  if (!read) return read.error();
  return std::move(content).finish();
}

/// A file, or a rosbag2 folder.
Result<Recording> read_any(const std::filesystem::path& path, const Wanted& wanted, Overview& overview) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) return read_folder(path, wanted, overview);
  auto recording = read_file(path, wanted, overview);
  if (!recording) return with_log(recording.error(), path);
  if (has_write_ahead_log(path)) recording.value().discarded.push_back({"file", what_the_log_has(), 1});
  return recording;
}

}  // namespace

Result<Recording> read_recording(const std::filesystem::path& path, const RobotDescription* fallback,
                                 const TopicChoices& topics, const UnpackLimit& limit,
                                 Intensities intensities) {
  Overview unused;
  return read_any(path, {fallback, topics, limit, intensities}, unused);
}

Result<Recording> read_recording_with_overview(const std::filesystem::path& path,
                                               const RobotDescription* fallback, const TopicChoices& topics,
                                               const UnpackLimit& limit, Overview& overview) {
  return read_any(path, {fallback, topics, limit}, overview);
}

}  // namespace odomcalib
