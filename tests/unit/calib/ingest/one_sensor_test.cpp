// Recordings that are solved together see with one lidar.
#include "calib/ingest/one_sensor.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "calib/ingest/put_right.hpp"

namespace odomcalib::calib::ingest::one_sensor_test {
namespace {

Recording recording_of(const std::string& name, const std::vector<std::string>& sensors) {
  Recording recording;
  recording.name = name;
  for (const std::string& sensor : sensors) {
    Scan scan;
    scan.t = 0.1 * static_cast<double>(recording.scans.size());
    scan.sensor = sensor;
    recording.scans.push_back(scan);
  }
  return recording;
}

TEST(OneSensor, that_a_recording_has_no_scans_of_is_an_error_that_names_both) {
  const std::vector<Recording> recordings = {recording_of("drive1.jsonl", {"front", "rear", "rear"}),
                                             recording_of("drive2.jsonl", {"rear"})};
  const auto error = lacks_sensor(recordings, "front");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::usage);
  EXPECT_EQ(error->where, "drive2.jsonl");
  EXPECT_EQ(error->what, "has no scans of the sensor \"front\", but of: rear (1)");
  EXPECT_FALSE(lacks_sensor(recordings, "rear"));
  EXPECT_FALSE(lacks_sensor(recordings, "")) << "none was asked for";
}

TEST(OneSensor, may_be_without_a_name_or_replaced) {
  Recording by_poses = recording_of("c", {"rear"});
  by_poses.poses.resize(2);
  Recording by_increments = recording_of("d", {"rear"});
  by_increments.increments.resize(2);
  const std::vector<Recording> recordings = {recording_of("a", {"front"}), recording_of("b", {"", ""}),
                                             by_poses, by_increments, recording_of("e", {})};
  EXPECT_FALSE(lacks_sensor(recordings, "front"));
  EXPECT_FALSE(two_sensors(recordings));
  const Recording partly = recording_of("f", {"", "rear"});
  EXPECT_TRUE(lacks_sensor({&partly, 1}, "front")) << "that of the rear may be taken";
}

TEST(OneSensor, of_each_recording_is_the_same) {
  const std::vector<Recording> recordings = {recording_of("a", {"front", "front", "rear"}),
                                             recording_of("b", {"front", "rear", "rear"})};
  const auto error = two_sensors(put_right(recordings).view());
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::refused);
  EXPECT_EQ(error->where, "b");
  EXPECT_EQ(error->what, "its scans are of the sensor \"rear\", but those of a of \"front\"");
  EXPECT_NE(error->remedy.find("--sensor"), std::string::npos);
  EXPECT_FALSE(two_sensors(put_right(recordings, "rear").view()));
}

}  // namespace
}  // namespace odomcalib::calib::ingest::one_sensor_test
