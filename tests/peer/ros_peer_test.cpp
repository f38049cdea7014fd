// ROS recordings against somebody else's programs (npm): MCAP files of their writers, encoders and
// compressors are read here; bags and MCAP files that the tests write are read by them. What tests of our own
// misread and miswrite alike would show here.
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

  fs::path folder_;
};

TEST_F(RosPeer, writes_mcap_files_that_are_read) {
  Recording drive = test::small_drive();
  for (int k = 0; k < 20; ++k) drive.poses.push_back({0.1 * k, 0.3 * k, -0.2 * k, 0.1 * k});
  ASSERT_TRUE(write_recording_jsonl(drive, folder_ / "drive.jsonl").ok());
  const RobotDescription robot = test::ros_robot();
  for (const char* ros : {"ros1", "ros2"})
    for (const char* packing : {"none", "lz4", "zstd"})
      for (const char* layout : {"whole", "bare"}) {
        const std::string form = std::string(ros) + " " + packing + " " + layout;
        SCOPED_TRACE(form);
        (void)node("write_mcap.js", "drive.jsonl drive.mcap " + form);
        const auto result = read_recording(folder_ / "drive.mcap", &robot,
                                           {{"wheels", "/joint_states", {}}, {"pose", "/mocap", {}}});
        ASSERT_TRUE(result.ok()) << result.error().text();
        test::expect_small_drive(result.value(), MotionSource::wheels);
        EXPECT_EQ(test::discarded_like(result.value(), "file", "") +
                      test::discarded_like(result.value(), "chunk", ""),
                  0U)
            << test::list_discarded(result.value());
        ASSERT_EQ(result.value().poses.size(), 20U);
        EXPECT_NEAR(result.value().poses[7].y, -1.4, 1e-12);
        EXPECT_NEAR(result.value().poses[7].yaw, 0.7, 1e-12);
        const auto odometry = read_recording(folder_ / "drive.mcap", &robot, {{"odometry", "/odom", {}}});
        ASSERT_TRUE(odometry.ok()) << odometry.error().text();
        ASSERT_EQ(odometry.value().odometry.size(), 20U);
        EXPECT_NEAR(odometry.value().odometry[7].x, 2.1, 1e-12);
        EXPECT_TRUE(test::told(odometry.value(), "of the frame base_footprint"));
      }
}

TEST_F(RosPeer, reads_the_bags_and_mcap_files_of_the_tests) {
  std::vector<std::pair<std::string, std::string>> files;
  constexpr std::size_t kChunk = 20'000;
  for (const RosPacking packing : {RosPacking::none, RosPacking::bz2, RosPacking::lz4})
    files.emplace_back("drive.bag",
                       write_bag(test::small_log(Wire::ros1), {.packing = packing, .chunk_bytes = kChunk}));
  for (const Wire wire : {Wire::ros1, Wire::cdr_little, Wire::cdr_big})
    for (const RosPacking packing : {RosPacking::none, RosPacking::lz4, RosPacking::zstd})
      files.emplace_back("drive.mcap",
                         write_mcap(test::small_log(wire), {.packing = packing, .chunk_bytes = kChunk}));
  for (const auto& [name, bytes] : files) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    const std::string lines = node("read.js", name);
    const auto result = read_recording_bytes(
        R"({"type":"robot","wheel_diameter":0.15,"track_width":0.4,"ticks_per_rev":4096})"
        "\n" +
            lines,
        "peer.jsonl");
    ASSERT_TRUE(result.ok()) << result.error().text();
    test::expect_small_drive(result.value(), MotionSource::wheels);
  }
}

}  // namespace
}  // namespace odomcalib
