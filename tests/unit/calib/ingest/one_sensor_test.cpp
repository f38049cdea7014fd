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

/// A recording of a lidar with 360 beams.
Recording turns_of(const std::string& name, const std::string& sensor) {
  Recording recording = recording_of(name, {sensor, sensor, sensor});
  recording.robot.lidar_pose = {{0.1, 0.0, 0.0}};
  for (Scan& scan : recording.scans) {
    scan.ranges.assign(360, 2.0F);
    scan.angle_min = -3.14;
    scan.angle_increment = 0.01745;
    scan.range_min = 0.1;
    scan.range_max = 12.0;
  }
  return recording;
}

TEST(OneSensor, may_have_changed_its_name_where_nothing_else_differs_and_somebody_says_so) {
  std::vector<Recording> recordings = {turns_of("a", ""), turns_of("b", "laser"),
                                       turns_of("c", "laser_frame"), turns_of("d", "laser")};
  recordings[2].scans[1].ranges.resize(359);  // a head whose speed wanders
  const auto error = two_sensors(recordings);
  ASSERT_TRUE(error) << "nobody has said so: a second one of the model would look the same";
  EXPECT_NE(error->remedy.find("--same-lidar"), std::string::npos) << error->remedy;
  const Recordings named = of_one_name(Recordings(recordings));
  EXPECT_FALSE(two_sensors(named.view()));
  for (const Scan& scan : named[2].scans) EXPECT_EQ(scan.sensor, "laser");
  ASSERT_EQ(named[2].repairs.size(), 1U);
  EXPECT_EQ(named[2].repairs[0].chosen, "of the sensor \"laser_frame\", taken for \"laser\"");
  EXPECT_EQ(named[0].scans[0].sensor, "");
  EXPECT_TRUE(named[0].repairs.empty() && named[1].repairs.empty() && named[3].repairs.empty());
}

TEST(OneSensor, of_another_geometry_is_another_one_whatever_is_said) {
  const std::vector<std::pair<std::string, void (*)(Recording&)>> others = {
      {"450 beams, not 360",
       [](Recording& one) {
         for (Scan& scan : one.scans) scan.ranges.resize(450);
       }},
      {"steps of -0.01745 rad, not 0.01745",
       [](Recording& one) {
         for (Scan& scan : one.scans) scan.angle_increment *= -1.0;
       }},
      {"the first beam at 0 rad, not -3.14",
       [](Recording& one) {
         for (Scan& scan : one.scans) scan.angle_min = 0.0;
       }},
      {"ranges from 0.1 to 30 m, not 0.1 to 12",
       [](Recording& one) {
         for (Scan& scan : one.scans) scan.range_max = 30.0;
       }},
      {"mounted at -0.1, 0 m, 3.14 rad, not at 0.1, 0 m, 0 rad",
       [](Recording& one) {
         one.robot.lidar_pose = {{-0.1, 0.0, 3.14}};
       }},
      {"mounted at a place that nobody states, not at 0.1, 0 m, 0 rad",
       [](Recording& one) { one.robot.lidar_pose.reset(); }},
  };
  for (const auto& [what, change] : others) {
    std::vector<Recording> recordings = {turns_of("a", "front"), turns_of("b", "rear")};
    change(recordings[1]);
    const Recordings named = of_one_name(Recordings(recordings));
    EXPECT_EQ(named[1].scans[0].sensor, "rear");
    const auto error = two_sensors(named.view());
    ASSERT_TRUE(error) << what;
    EXPECT_EQ(error->what, "its scans are of the sensor \"rear\", but those of a of \"front\": " + what);
    EXPECT_EQ(error->remedy.find("--same-lidar"), std::string::npos) << error->remedy;
  }
}

}  // namespace
}  // namespace odomcalib::calib::ingest::one_sensor_test
