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

/// The storage files in a folder (.db3, .mcap, each packed with zstd or not): the splits NAME_0, NAME_1 and
/// so on of one recording, ordered by their numbers, or one file of any name. metadata.yaml is not needed: a
/// recorder that was killed leaves none. Error: io, format (no such file), usage (several recordings).
Result<FolderFiles> files_of(const std::filesystem::path& folder);

}  // namespace odomcalib::ros
