// ROS recordings against somebody else's programs (npm, and ROS 1's own rosbag): bags, MCAP files and rosbag2
// databases of their writers, encoders and compressors are read here; bags, databases and MCAP files that the
// tests write are read by them. What the readers and the tests' own writers misunderstand alike would show
// here.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib {
namespace {

namespace fs = std::filesystem;
using sim::RosPacking;
using sim::Wire;

class RosPeer : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = "/tmp/odomcalib-ros-peer-XXXXXX";
    folder_ = mkdtemp(name.data());
    ASSERT_EQ(setenv("NODE_PATH", ODOMCALIB_PEER_MODULES, 1), 0);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Runs one of the scripts in the folder of the test; its output goes to a file there.
  [[nodiscard]] std::string node(const std::string& script, const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && " + ODOMCALIB_NODE + " " +
                                ODOMCALIB_ROS_SCRIPTS + "/" + script + " " + arguments + " > out 2> err";
    EXPECT_EQ(system(command.c_str()), 0) << command << "\n" << test::bytes_of(folder_ / "err");
    return test::bytes_of(folder_ / "out");
  }

  /// Runs ROS 1's rosbag. Python of the distribution: its packages are for no other one.
  [[nodiscard]] std::string rosbag(const std::string& arguments, bool ends = true) const {
    const std::string command = "cd '" + folder_.string() + "' && /usr/bin/python3 " + ODOMCALIB_ROS_SCRIPTS +
                                "/rosbag_peer.py " + arguments + " > out 2> err";
    EXPECT_EQ(system(command.c_str()) == 0, ends) << command << "\n" << test::bytes_of(folder_ / "err");
    return test::bytes_of(folder_ / "out");
  }

  fs::path folder_;
};

/// The small drive with poses, which the peer writes as odometry and as motion capture.
fs::path write_drive(const fs::path& folder) {
  Recording drive = test::small_drive();
  for (int k = 0; k < 20; ++k) drive.poses.push_back({0.1 * k, 0.3 * k, -0.2 * k, 0.1 * k});
  fs::path path = folder / "drive.jsonl";
  EXPECT_TRUE(write_recording_jsonl(drive, path).ok());
  return path;
}

/// The file that the peer made of write_drive() must be read as it is, by wheels and by odometry.
void expect_peers_drive(const fs::path& path, bool closed = true) {
  const RobotDescription robot = test::ros_robot();
  const auto result = read_recording(path, &robot, {{"wheels", "/joint_states", {}}, {"pose", "/mocap", {}}});
  ASSERT_TRUE(result.ok()) << result.error().text();
  test::expect_small_drive(result.value(), MotionSource::wheels);
  EXPECT_EQ(test::discarded_like(result.value(), "chunk", ""), 0U) << test::list_discarded(result.value());
  EXPECT_EQ(test::discarded_like(result.value(), "file", "") == 0, closed)
      << test::list_discarded(result.value());
  ASSERT_EQ(result.value().poses.size(), 20U);
  EXPECT_NEAR(result.value().poses[7].y, -1.4, 1e-12);
  EXPECT_NEAR(result.value().poses[7].yaw, 0.7, 1e-12);
  const auto odometry = read_recording(path, &robot, {{"odometry", "/odom", {}}});
  ASSERT_TRUE(odometry.ok()) << odometry.error().text();
  ASSERT_EQ(odometry.value().odometry.size(), 20U);
  EXPECT_NEAR(odometry.value().odometry[7].x, 2.1, 1e-12);
  EXPECT_TRUE(test::told(odometry.value(), "of the frame base_footprint"));
}

TEST_F(RosPeer, writes_mcap_files_that_are_read) {
  write_drive(folder_);
  for (const char* ros : {"ros1", "ros2"})
    for (const char* packing : {"none", "lz4", "zstd"})
      for (const char* layout : {"whole", "bare"}) {
        const std::string form = std::string(ros) + " " + packing + " " + layout;
        SCOPED_TRACE(form);
        (void)node("write.js", "drive.jsonl drive.mcap " + form);
        expect_peers_drive(folder_ / "drive.mcap");
      }
}

TEST_F(RosPeer, writes_rosbag2_databases_that_are_read) {
  write_drive(folder_);
  for (const char* packing : {"none", "zstd"}) {
    SCOPED_TRACE(packing);
    (void)node("write.js", std::string("drive.jsonl drive.db3 ros2 ") + packing);
    expect_peers_drive(folder_ / "drive.db3");
  }
}

TEST_F(RosPeer, writes_bags_with_rosbag_that_are_read) {
  write_drive(folder_);
  for (const char* packing : {"none", "bz2", "lz4"})
    for (const char* end : {"whole", "shuffled"}) {
      SCOPED_TRACE(std::string(packing) + " " + end);
      (void)rosbag("write drive.jsonl drive.bag " + std::string(packing) + " " + end);
      expect_peers_drive(folder_ / "drive.bag");
    }
}

/// Without an index, and with the last chunk unfinished: its header says that nothing is in it.
TEST_F(RosPeer, writes_bags_with_rosbag_that_are_read_when_it_is_killed) {
  write_drive(folder_);
  (void)rosbag("write drive.jsonl drive.bag none killed", false);
  expect_peers_drive(folder_ / "drive.bag", false);
  for (const std::string packing : {"bz2", "lz4"}) {
    SCOPED_TRACE(packing);
    (void)rosbag("write drive.jsonl drive.bag " + packing + " killed", false);
    const RobotDescription robot = test::ros_robot();
    const auto found = value_of(read_recording(folder_ / "drive.bag", &robot));
    EXPECT_GT(found.ticks.size(), 100U);  // what was packed by then
    EXPECT_GT(test::discarded_like(found, "file", ""), 0U) << "the end is missing and nothing is said";
  }
}

/// The recording that the peer reads out of a file.
void expect_read_by_peer(const std::string& lines) {
  const auto result =
      read_recording_bytes(R"({"type":"robot","wheel_diameter":0.15,"track_width":0.4,"ticks_per_rev":4096})"
                           "\n" +
                               lines,
                           "peer.jsonl");
  ASSERT_TRUE(result.ok()) << result.error().text();
  test::expect_small_drive(result.value(), MotionSource::wheels);
}

TEST_F(RosPeer, reads_the_bags_and_mcap_files_of_the_tests) {
  constexpr std::size_t kChunk = 20'000;
  for (const RosPacking packing : {RosPacking::none, RosPacking::bz2, RosPacking::lz4}) {
    std::ofstream(folder_ / "drive.bag", std::ios::binary)
        << write_bag(test::small_log(Wire::ros1), {.packing = packing, .chunk_bytes = kChunk});
    expect_read_by_peer(node("read.js", "drive.bag"));
    expect_read_by_peer(rosbag("read drive.bag"));
  }
  for (const Wire wire : {Wire::ros1, Wire::cdr_little, Wire::cdr_big, Wire::cdr2_little, Wire::cdr2_big})
    for (const RosPacking packing : {RosPacking::none, RosPacking::lz4, RosPacking::zstd}) {
      std::ofstream(folder_ / "drive.mcap", std::ios::binary)
          << write_mcap(test::small_log(wire), {.packing = packing, .chunk_bytes = kChunk});
      expect_read_by_peer(node("read.js", "drive.mcap"));
    }
}

TEST_F(RosPeer, reads_the_rosbag2_databases_of_the_tests) {
  for (const Wire wire : {Wire::cdr_little, Wire::cdr_big, Wire::cdr2_little, Wire::cdr2_big}) {
    fs::remove(folder_ / "drive.db3");
    write_rosbag2(test::small_log(wire), folder_ / "drive.db3");
    expect_read_by_peer(node("read.js", "drive.db3"));
  }
}

}  // namespace
}  // namespace odomcalib
