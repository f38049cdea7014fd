// A recording on the disk: an LCM event log, and beside it the frames on the bus as a candump log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "daemon/service/recording_writer.hpp"

namespace odomcalib {

/// @param path of the event log, which must not exist yet; the candump log is made with the first frame
/// @param most_bytes of the earlier recordings beside it: the oldest are removed
std::unique_ptr<RecordingSink> recording_file(const std::filesystem::path& path,
                                              const std::string& channel_prefix, std::uintmax_t most_bytes);

}  // namespace odomcalib
