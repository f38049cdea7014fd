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
  std::vector<std::string> remarks;          ///< what else somebody has to know of the choice
};

/// The storage files in a folder (.db3, .mcap, each packed with zstd or not): the splits NAME_0, NAME_1 and
/// so on of one recording, ordered by their numbers, or one file of any name. A file that is there packed and
/// unpacked is one. metadata.yaml tells which splits there should be; without it (a recorder that was killed
/// leaves none) only those between two others are known to be missing. Error: io, format (no such file),
/// usage (several recordings).
Result<FolderFiles> files_of(const std::filesystem::path& folder);

}  // namespace odomcalib::ros
