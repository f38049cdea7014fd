#include "proto/calibration/driven.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/value_of.hpp"

namespace odomcalib::driven_test {
namespace {

using ::testing::HasSubstr;

constexpr double kSomeDay_s = 1764411585.0;  // 2025-11-29T10:19:45Z

Calibration driven_at(std::vector<std::optional<double>> begins) {
  Calibration calibration;
  for (const auto& begin : begins) {
    DataUse data;
    data.begin = begin;
    data.duration = 300.5;
    calibration.data.push_back(data);
  }
  return calibration;
}

TEST(Driven, is_from_the_first_to_the_last_of_all_drives) {
  const auto driven = driven_of(driven_at({kSomeDay_s + 3600.0, kSomeDay_s}));
  ASSERT_TRUE(driven.has_value());
  EXPECT_EQ(iso_time(driven->begin), "2025-11-29T10:19:45Z");
  EXPECT_EQ(iso_time(driven->end), "2025-11-29T11:24:45Z");
  EXPECT_EQ(readable_time(*driven), "2025-11-29, 10:19 to 11:24 UTC");
  EXPECT_EQ(readable_time({kSomeDay_s, kSomeDay_s + 86400.0}), "2025-11-29, 10:19 to 2025-11-30, 10:19 UTC");
}

TEST(Driven, is_not_known_of_a_clock_that_counts_from_elsewhere) {
  EXPECT_FALSE(driven_of(driven_at({})).has_value());
  EXPECT_FALSE(driven_of(driven_at({0.0})).has_value());
  EXPECT_FALSE(driven_of(driven_at({std::nullopt})).has_value());
  EXPECT_FALSE(driven_of(driven_at({kSomeDay_s, 12.0})).has_value()) << "of one drive it is not known";
  EXPECT_FALSE(driven_of(driven_at({1e3 * kSomeDay_s})).has_value()) << "ms";
}

TEST(Driven, stands_in_the_file_once_and_follows_from_its_data) {
  const std::string text = to_json(driven_at({kSomeDay_s}));
  EXPECT_THAT(text, HasSubstr(R"("begin": "2025-11-29T10:19:45Z")"));
  EXPECT_EQ(to_json(value_of(calibration_from_json(text, "test"))), text);
  EXPECT_THAT(to_json(driven_at({0.0})), HasSubstr(R"("driven": null)"));
  EXPECT_THAT(text, HasSubstr(R"("robot_id": null)"));
}

}  // namespace
}  // namespace odomcalib::driven_test
