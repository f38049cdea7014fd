// One reader per form of recording. Internal to proto/; callers use read_recording.
#pragma once

#include <string_view>

#include "proto/recording_builder.hpp"

namespace odomcalib {

/// JSON Lines (DESIGN 4.2) and Censi's raw JSON logs (their scans have "readings" and split time stamps): one
/// object a line.
void read_jsonl(std::string_view text, RecordingBuilder& builder);

}  // namespace odomcalib
