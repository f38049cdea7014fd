// Real recordings that are not part of the repository; tests that use them say loudly when they are absent.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/shared_folder.hpp"

namespace odomcalib::test_support {

/// ./test.sh --long: more robots and recordings than are needed to see a fault.
inline bool long_tests() { return std::getenv("ODOMCALIB_LONG") != nullptr; }

inline std::filesystem::path shared_data(const std::string& name) { return shared_folder("data") / name; }

/// Files of a folder whose names contain `part`, sorted.
inline std::vector<std::filesystem::path> shared_files(const std::string& folder, const std::string& part) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::exists(shared_data(folder))) return files;
  for (const auto& entry : std::filesystem::directory_iterator(shared_data(folder)))
    if (entry.path().filename().string().find(part) != std::string::npos) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace odomcalib::test_support

#define ODOMCALIB_NEEDS_SHARED(name)                                                 \
  if (!std::filesystem::exists(odomcalib::test_support::shared_data(name)))          \
  GTEST_SKIP() << "REAL DATA ABSENT: " << odomcalib::test_support::shared_data(name) \
               << " not found; set ODOMCALIB_SHARED"
