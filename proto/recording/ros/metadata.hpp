// metadata.yaml of a rosbag2 folder. Internal to proto/.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace odomcalib::ros {

/// The files of the recording (`relative_file_paths`), by their names without folders: early versions of
/// rosbag2 list them with one. Source: rosbag2_storage, YAML of BagMetadata. Empty where the text is damaged
/// or lists none. Aliases are not followed: what a few lines stand for cannot grow.
std::vector<std::string> files_listed(std::string_view yaml);

}  // namespace odomcalib::ros
