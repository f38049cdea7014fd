// Helpers of the tests in this folder.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "proto/file_bytes.hpp"
#include "proto/recording/recording.hpp"
#include "tests/shared_folder.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::test {

constexpr const char* kRobotLine =
    R"({"type":"robot","wheel_diameter":0.154,"track_width":0.33,"ticks_per_rev":2000})"
    "\n";

inline RobotDescription example_robot() { return {0.154, 0.154, 0.33, 2000.0, std::nullopt, "", ""}; }

/// A file in the test's temporary folder.
inline std::filesystem::path write_file(const std::string& name, const std::string& bytes) {
  auto path = std::filesystem::path(testing::TempDir()) / ("odomcalib_" + name);
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

inline Result<Recording> read_text(const std::string& text, const RobotDescription* fallback = nullptr) {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  const auto path = write_file(std::string(info->test_suite_name()) + "." + info->name(), text);
  auto result = read_recording(path, fallback);
  std::filesystem::remove(path);
  return result;
}

inline std::size_t discarded(const Recording& recording, const std::string& what, const std::string& reason) {
  for (const auto& item : recording.discarded)
    if (item.what == what && item.reason == reason) return item.count;
  return 0;
}

inline std::string list_discarded(const Recording& recording) {
  std::string out;
  for (const auto& item : recording.discarded)
    out += item.what + ": " + item.reason + " x" + std::to_string(item.count) + "; ";
  return out;
}

/// Folder with the real recordings, which are not part of the repository.
inline std::filesystem::path shared_data() { return shared_folder("data"); }

}  // namespace odomcalib::test

/// For tests on real data: defines `variable`, or skips loudly.
// NOLINTBEGIN(bugprone-macro-parentheses): a declaration takes none
#define ODOMCALIB_SHARED_FILE(variable, name)                    \
  const auto variable = odomcalib::test::shared_data() / (name); \
  if (!std::filesystem::exists(variable))                        \
  GTEST_SKIP() << "REAL DATA ABSENT: " << variable << " not found; set ODOMCALIB_SHARED to its folder"
// NOLINTEND(bugprone-macro-parentheses)
