// One reader per form of recording. Internal to proto/; callers use read_recording. Each takes the whole
// unpacked content, never fails, and counts in the builder what it could not use.
#pragma once

#include <string_view>

#include "proto/recording/recording_builder.hpp"

namespace odomcalib {

/// JSON Lines, and Censi's raw JSON logs (their scans have "readings" and stamps as [s, us]): one object a
/// line.
void read_jsonl(std::string_view text, RecordingBuilder& builder);

/// Censi's tuple files.
void read_tuples(std::string_view text, RecordingBuilder& builder);

/// LCM event logs: native, MBot and MaeBot family, bot_core lidars.
void read_event_log(std::string_view bytes, RecordingBuilder& builder);

/// True when the first line that is no comment is one of CARMEN's.
bool looks_like_carmen(std::string_view text);

/// CARMEN logs. Counts are recovered from the odometry with `robot`; without it there are none.
void read_carmen(std::string_view text, const RobotDescription* robot, RecordingBuilder& builder);

}  // namespace odomcalib
