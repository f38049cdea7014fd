// Content of a file, for whoever looks at it.
#include "proto/recording/overview.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/temporary_folder.hpp"
#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_overview_test {
namespace {

using sim::RosLog;
using sim::Wire;
using test::kRosStart;
using test::small_log;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const TopicOverview& topic(const Overview& overview, const std::string& name) {
  for (const TopicOverview& one : overview.topics)
    if (one.name == name) return one;
  ADD_FAILURE() << name << " is missing";
  return overview.topics.front();
}

Result<Recording> look(const std::string& bytes, Overview& overview, const RobotDescription* robot) {
  const TemporaryFolder folder;
  std::ofstream(folder / "drive", std::ios::binary) << bytes;
  return read_recording_with_overview(folder / "drive", robot, {}, {}, overview);
}

TEST(RosOverview, lists_topics_with_their_rates_frames_and_joints) {
  const RobotDescription robot = test::ros_robot();
  Overview overview;
  ASSERT_TRUE(look(write_mcap(small_log(Wire::cdr_little)), overview, &robot));
  EXPECT_EQ(overview.form, "MCAP");
  const TopicOverview& scans = topic(overview, "/scan");
  EXPECT_EQ(scans.messages, 40U);
  EXPECT_EQ(scans.unread, "");
  ASSERT_TRUE(scans.begin && scans.end);
  EXPECT_NEAR(*scans.begin, 1e-9 * static_cast<double>(kRosStart) + 0.003, 1e-3);
  EXPECT_NEAR(*scans.end - *scans.begin, 3.9, 1e-3);
  EXPECT_NEAR(scans.longest_gap, 0.1, 1e-3);
  EXPECT_EQ(scans.without_stamp, 0U);
  EXPECT_EQ(scans.frames.size(), 1U);
  EXPECT_GE(topic(overview, "/joint_states").joints.size(), 2U);
  EXPECT_THAT(topic(overview, "/odom").frames, ElementsAre(HasSubstr(" -> ")));
}

TEST(RosOverview, takes_single_messages_without_a_stamp_for_no_gap) {
  const RobotDescription robot = test::ros_robot();
  for (const std::size_t without : {1U, 39U}) {
    // A simulation: its stamps begin long before those of reception.
    RosLog log = sim::ros_log(test::small_drive(), {.wire = Wire::ros1, .start_ns = 0});
    std::size_t k = 0;
    for (auto& message : log.messages) {
      message.received_ns += kRosStart;
      // The stamp follows the sequence number.
      if (log.topics[message.topic].name == "/scan" && k++ < without) message.bytes.replace(4, 8, 8, '\0');
    }
    Overview overview;
    (void)look(write_bag(log), overview, &robot);
    const TopicOverview& scans = topic(overview, "/scan");
    EXPECT_EQ(scans.without_stamp, without);
    EXPECT_EQ(scans.longest_gap < 1.0, without == 1) << scans.longest_gap;
  }
}

TEST(RosOverview, is_there_although_nothing_can_be_taken) {
  Overview overview;
  RosLog log =
      test::without_topic(test::without_topic(small_log(Wire::cdr_little), "/joint_states"), "/odom");
  log.add("/news", "std_msgs/String", kRosStart, "abcd");
  ASSERT_FALSE(look(write_mcap(log), overview, nullptr));
  EXPECT_EQ(topic(overview, "/scan").messages, 40U);
  EXPECT_THAT(topic(overview, "/news").unread, HasSubstr("no message that calibration uses"));
}

TEST(RosOverview, names_the_form_of_other_files) {
  const RobotDescription robot = test::ros_robot();
  Overview overview;
  ASSERT_TRUE(look(R"({"type":"ticks","t":0,"left":1,"right":1})"
                   "\n"
                   R"({"type":"ticks","t":1,"left":2,"right":2})",
                   overview, &robot));
  EXPECT_EQ(overview.form, "JSON Lines");
  EXPECT_TRUE(overview.topics.empty());
  EXPECT_FALSE(look("VERTEX_SE2 0 0 0 0\n", overview, &robot));
  EXPECT_EQ(overview.form, "pose graph");
}

}  // namespace
}  // namespace odomcalib::ros_overview_test
