#include "proto/calibration/scale.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "proto/calibration/calibration.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::scale_test {
namespace {

TEST(Scale, is_read_with_its_deviation) {
  const auto scale = value_of(scale_from_text("1.002+-0.001"));
  EXPECT_DOUBLE_EQ(scale.value, 1.002);
  EXPECT_DOUBLE_EQ(scale.std, 0.001);
  EXPECT_EQ(scale.source, "stated");
  ASSERT_TRUE(scale_from_text("0.99"));
  EXPECT_EQ(scale_from_text("0.99").value().std, 0.0);
}

TEST(Scale, that_is_none_is_refused_with_an_example) {
  for (const char* text : {"", "1.0+", "1.0+-", "+-0.1", "one", "1.0+-x", "1,002", "1000", "0.001", "nan",
                           "1.0+--0.1", "1.0+-0.5", "1.0 +- 0.1", "1.0+-nan"}) {
    const auto scale = scale_from_text(text);
    ASSERT_FALSE(scale) << text;
    EXPECT_EQ(scale.error().code, ErrorCode::usage);
    EXPECT_NE(scale.error().text().find("1.002+-0.001"), std::string::npos);
  }
}

TEST(Scale, widens_lengths_and_nothing_else) {
  const Scale scale{1.0, 0.003, "tape"};
  EXPECT_DOUBLE_EQ(absolute_deviation({0.4, 0.0016, "m"}, scale), std::hypot(0.0016, 0.0012));
  EXPECT_DOUBLE_EQ(absolute_deviation({0.4, 0.0016, "rad"}, scale), 0.0016);
  EXPECT_EQ(absolute_deviation({0.4, -1.0, "m"}, scale), -1.0) << "not estimated";
}

TEST(Scale, stands_in_the_file_with_the_deviation_of_every_parameter) {
  Calibration calibration;
  calibration.parameters = {{"track_width", {0.4, 0.0016, "m"}}, {"lidar_yaw", {0.1, 0.01, "rad"}}};
  EXPECT_EQ(to_json(calibration).find("std_absolute"), std::string::npos) << "no scale, no such deviation";
  calibration.scale = {1.0, 0.003, "lidar data sheet"};
  const std::string text = to_json(calibration);
  EXPECT_NE(text.find("\"std_absolute\": 0.002"), std::string::npos) << text;
  const auto read = value_of(calibration_from_json(text, "here"));
  ASSERT_TRUE(read.scale);
  EXPECT_EQ(read.scale->source, "lidar data sheet");
  EXPECT_EQ(to_json(read), text);
}

TEST(Scale, that_is_not_understood_is_none) {
  Calibration calibration;
  calibration.unknown[""]["scale"] = "[1.0]";
  const auto read = value_of(calibration_from_json(to_json(calibration), "here"));
  EXPECT_FALSE(read.scale);
  EXPECT_EQ(read.unknown, calibration.unknown) << "it is kept";
}

}  // namespace
}  // namespace odomcalib::scale_test
