#include "proto/calibration/schema.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace odomcalib::schema_test {
namespace {

constexpr const char* kPublished = "docs/schema/calibration-1.json";

// The message says what to do: nobody writes the file by hand.
TEST(CalibrationSchema, is_the_published_one) {
  std::ifstream file(kPublished);
  ASSERT_TRUE(file.is_open()) << kPublished;
  const auto published = nlohmann::json::parse(file);
  const auto made = calibration_schema();
  const auto path = testing::TempDir() + "calibration-1.json";
  std::ofstream(path) << made.dump(2) << "\n";
  EXPECT_EQ(nlohmann::json::parse(made.dump()), published)
      << "copy " << path << " to " << kPublished
      << "; what differs: " << nlohmann::json::diff(published, nlohmann::json::parse(made.dump())).dump(1);
}

/// Members with a limit: their names, or those of the object that they are all of.
void find_limits(const nlohmann::json& schema, const std::string& name, std::set<std::string>& found) {
  const bool is_count = schema.value("type", nlohmann::json()) == "integer";
  if (schema.contains("maximum") || (schema.contains("minimum") && !(is_count && schema["minimum"] == 0)))
    found.insert(name);
  for (const auto& [key, value] : schema.items())
    if (value.is_object()) find_limits(value, key, found);
}

TEST(CalibrationSchema, limits_are_those_that_tests_try) {
  std::set<std::string> found;
  find_limits(nlohmann::json::parse(calibration_schema().dump()), "", found);
  EXPECT_EQ(found, (std::set<std::string>{"count", "std", "value"}))
      << "try the new one in field_list_test.cpp";
}

}  // namespace
}  // namespace odomcalib::schema_test
