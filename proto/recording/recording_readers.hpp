// One reader per form of recording. Internal to proto/; callers use read_recording. Each takes the unpacked
// content, never fails, and counts in the builder what it could not use.
#pragma once

#include <string>
#include <string_view>

#include "proto/recording/recording_builder.hpp"
#include "proto/wire/json_fields.hpp"

namespace odomcalib {

/// JSON Lines, and Censi's raw JSON logs (their scans have "readings" and stamps as [s, us]): one object a
/// line. The text comes in pieces: an hour of it is several times the recording.
class JsonLines {
 public:
  /// @param builder outlives it
  explicit JsonLines(RecordingBuilder& builder) : builder_(&builder) {}
  void take(std::string_view piece);
  /// When nothing more comes: the last line may lack its end.
  void finish();

 private:
  void read_line(std::string_view line, const char* if_wrong);

  RecordingBuilder* builder_;
  JsonFields fields_;
  std::string begun_;  ///< line of which the end is still to come
};

/// Censi's tuple files.
void read_tuples(std::string_view text, RecordingBuilder& builder);

/// LCM event logs: native, MBot and MaeBot family, bot_core lidars.
void read_event_log(std::string_view bytes, RecordingBuilder& builder);

/// True when the first line that is no comment is one of CARMEN's.
bool looks_like_carmen(std::string_view text);

/// CARMEN logs. Counts are recovered from the odometry with `robot`; without it there are none.
void read_carmen(std::string_view text, const RobotDescription* robot, RecordingBuilder& builder);

}  // namespace odomcalib
