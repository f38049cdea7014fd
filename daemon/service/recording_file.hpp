// A recording on the disk: an LCM event log, and beside it the frames on the bus as a candump log.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "daemon/service/recording_writer.hpp"

namespace odomcalib {

/// @param path of the event log, which must not exist yet; the candump log is made with the first frame
std::unique_ptr<RecordingSink> recording_file(const std::filesystem::path& path,
                                              const std::string& channel_prefix);

}  // namespace odomcalib
