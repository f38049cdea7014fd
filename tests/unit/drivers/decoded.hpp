// Output of `decode`, line by line.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "proto/result.hpp"

namespace odomcalib::drivers::test {

constexpr const char* kProfiles = "drivers/base/profiles";

inline std::vector<nlohmann::json> lines_of(const Result<std::string>& decoded) {
  EXPECT_TRUE(decoded.ok()) << (decoded.ok() ? "" : decoded.error().text());
  std::vector<nlohmann::json> lines;
  std::istringstream in(decoded.ok() ? decoded.value() : "");
  for (std::string line; std::getline(in, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

inline std::vector<nlohmann::json> of_type(const std::vector<nlohmann::json>& lines,
                                           const std::string& type) {
  std::vector<nlohmann::json> out;
  for (const nlohmann::json& line : lines)
    if (line.value("type", "") == type) out.push_back(line);
  return out;
}

/// Those without a name by their type.
inline std::vector<nlohmann::json> named(const std::vector<nlohmann::json>& lines, const std::string& name) {
  std::vector<nlohmann::json> out;
  for (const nlohmann::json& line : lines)
    if (line.value("name", line.value("type", "")) == name) out.push_back(line);
  return out;
}

inline void expect_accounted_summary(const nlohmann::json& line) {
  ASSERT_EQ(line["type"], "summary");
  EXPECT_EQ(line["bytes_in"].get<int>(),
            line["good"].get<int>() + line["skipped"].get<int>() + line["buffered"].get<int>());
}

}  // namespace odomcalib::drivers::test
