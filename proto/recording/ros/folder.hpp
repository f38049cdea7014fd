// The files of a rosbag2 recording, which is a folder. Internal to proto/.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "proto/result.hpp"

namespace odomcalib::ros {

struct FolderFiles {
  std::vector<std::filesystem::path> files;  ///< in the order of recording
  std::vector<std::string> missing;          ///< names of splits that are not there
};

/// The storage files in a folder (.db3, .mcap, each packed with zstd or not), ordered by the number that
/// rosbag2 ends their names with. metadata.yaml is not needed: a recorder that was killed leaves none. Error:
/// io, format (no such file).
Result<FolderFiles> files_of(const std::filesystem::path& folder);

}  // namespace odomcalib::ros
