// How much of the past is kept on the disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace odomcalib {

struct Retention {
  std::uintmax_t most_bytes = 0;
  std::size_t most = 0;  ///< files; those whose names differ in the extension only count as one
};

/// Removes the oldest files of a folder until the others are no more than that; the newest stays however
/// large it is. What cannot be removed is passed over. @return names without extension of what was removed
std::vector<std::string> keep_newest(const std::filesystem::path& folder, const Retention& retention);

}  // namespace odomcalib
