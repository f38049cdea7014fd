// Public recordings and captures that are no part of the repository.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace odomcalib {

/// A folder of theirs, whether it is there or not: below ODOMCALIB_SHARED, without it below ../shared.
inline std::filesystem::path shared_folder(const char* name) {
  const char* root = std::getenv("ODOMCALIB_SHARED");
  return std::filesystem::path(root != nullptr ? root : "../shared") / name;
}

}  // namespace odomcalib
