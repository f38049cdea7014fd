// ROS bags, rosbag2 and MCAP, in every packing and encoding, whole and cut off.
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_containers_test {
namespace {

using sim::RosPacking;
using sim::Wire;
using test::bytes_of;
using test::discarded_like;
using test::expect_small_drive;
using test::list_discarded;
using test::read_ros;
using test::small_log;
using test::told;

struct Form {
  std::string name;
  std::string bytes;
};

std::string rosbag2_bytes(Wire wire, const sim::Rosbag2Options& options = {}) {
  // Tests of this file run beside each other, each in a process of its own.
  const auto name = "odomcalib_rosbag2_" + std::to_string(getpid()) + ".db3";
  const auto path = std::filesystem::path(testing::TempDir()) / name;
  sim::write_rosbag2(small_log(wire), path, options);
  std::string bytes = bytes_of(path);
  std::filesystem::remove(path);
  return bytes;
}

/// As several frames, one after the other, so that what was cut off can be unpacked up to there: in one frame
/// of so small a file nothing could.
std::string packed_in_frames(const std::string& bytes) {
  constexpr std::size_t kFrame = 8192;
  std::string out;
  for (std::size_t at = 0; at < bytes.size(); at += kFrame)
    out += sim::packed(RosPacking::zstd, bytes.substr(at, kFrame));
  return out;
}

/// Small chunks, so that there are many.
std::vector<Form> forms() {
  constexpr std::size_t kChunk = 5000;
  std::vector<Form> out;
  for (const auto& [name, packing] :
       {std::pair("plain", RosPacking::none), {"bz2", RosPacking::bz2}, {"lz4", RosPacking::lz4}}) {
    const std::string bag = std::string("bag_") + name;
    out.push_back({bag, write_bag(small_log(Wire::ros1), {.packing = packing, .chunk_bytes = kChunk})});
    out.push_back({bag + "_open", write_bag(small_log(Wire::ros1),
                                            {.packing = packing, .chunk_bytes = kChunk, .closed = false})});
  }
  for (const auto& [name, packing] :
       {std::pair("plain", RosPacking::none), {"lz4", RosPacking::lz4}, {"zstd", RosPacking::zstd}})
    for (const auto& [wire_name, wire] : {std::pair("ros1", Wire::ros1),
                                          {"cdr_little", Wire::cdr_little},
                                          {"cdr_big", Wire::cdr_big},
                                          {"cdr2_little", Wire::cdr2_little},
                                          {"cdr2_big", Wire::cdr2_big}})
      out.push_back({std::string("mcap_") + name + "_" + wire_name,
                     write_mcap(small_log(wire), {.packing = packing, .chunk_bytes = kChunk})});
  out.push_back({"mcap_without_chunks", write_mcap(small_log(Wire::cdr_little), {.chunk_bytes = 0})});
  out.push_back(
      {"mcap_open", write_mcap(small_log(Wire::cdr_little), {.chunk_bytes = kChunk, .closed = false})});
  out.push_back({"rosbag2", rosbag2_bytes(Wire::cdr_little)});
  out.push_back({"rosbag2_big", rosbag2_bytes(Wire::cdr_big)});
  out.push_back({"rosbag2_packed_messages", rosbag2_bytes(Wire::cdr_little, {.packed_messages = true})});
  out.push_back({"rosbag2_with_log", rosbag2_bytes(Wire::cdr_little, {.write_ahead_log = true})});
  out.push_back({"rosbag2_packed", packed_in_frames(rosbag2_bytes(Wire::cdr_little))});
  return out;
}

TEST(RosContainers, hold_the_same_drive_in_every_packing_and_encoding) {
  for (const Form& form : forms()) {
    SCOPED_TRACE(form.name);
    const auto read = read_ros(form.bytes);
    ASSERT_TRUE(read.ok()) << read.error().text();
    const Recording& result = read.value();
    expect_small_drive(result, MotionSource::wheels);
    EXPECT_TRUE(
        told(result, "joints wheel_left_joint (left) and wheel_right_joint (right) of /joint_states"));
    EXPECT_TRUE(told(result, "scan: /scan"));
    EXPECT_TRUE(told(result, "/odom not taken"));
    EXPECT_EQ(discarded_like(result, "message", "std_msgs/"), 1U) << list_discarded(result);
  }
}

// By the encoding: a type that the file does not name, or names in the manner of the other, is no sign.
TEST(RosContainers, say_whose_messages_they_hold) {
  for (const Form& form : forms()) {
    const bool is_ros1 = form.name.starts_with("bag_") || form.name.ends_with("_ros1");
    EXPECT_EQ(value_of(read_ros(form.bytes)).middleware, is_ros1 ? Middleware::ros1 : Middleware::ros2)
        << form.name;
  }
  sim::RosLog log = small_log(Wire::cdr_little);
  for (auto& topic : log.topics) topic.type.clear();
  const auto chosen =
      value_of(read_ros(write_mcap(log), {{"wheels", "/joint_states", {}}, {"scan", "/scan", {}}}));
  EXPECT_EQ(chosen.middleware, Middleware::ros2);
}

/// Whole parts are used, and a file that was cut says so.
TEST(RosContainers, that_are_cut_off_give_what_is_whole) {
  for (const Form& form : forms()) {
    SCOPED_TRACE(form.name);
    std::size_t most = 0;
    for (const double share : {0.35, 0.6, 0.85}) {
      const auto result = read_ros(
          form.bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(form.bytes.size()))));
      ASSERT_TRUE(result.ok()) << share << result.error().text();
      const Recording& r = result.value();
      const std::size_t count = r.ticks.size();
      EXPECT_GT(count, most) << share << list_discarded(r);
      EXPECT_LT(count, 200U);
      EXPECT_GE(discarded_like(r, "file", "") + discarded_like(r, "chunk", ""), 1U) << list_discarded(r);
      most = count;
    }
  }
}

TEST(RosContainers, that_are_packed_and_cut_off_before_anything_is_whole_say_so) {
  const std::string whole = sim::packed(RosPacking::zstd, rosbag2_bytes(Wire::cdr_little));
  const auto complete = value_of(read_ros(whole));
  expect_small_drive(complete, MotionSource::wheels);
  const auto cut = read_ros(whole.substr(0, 1000));
  ASSERT_FALSE(cut.ok());
  EXPECT_EQ(cut.error().code, ErrorCode::format);
  EXPECT_NE(cut.error().text().find("nothing of it can be unpacked"), std::string::npos)
      << cut.error().text();
}

TEST(RosContainers, that_are_whole_report_no_damage) {
  for (const Form& form : forms()) {
    const auto result = value_of(read_ros(form.bytes));
    EXPECT_EQ(discarded_like(result, "chunk", ""), 0U) << form.name;
    const bool open = form.name.ends_with("_open");  // of a recorder that was killed
    EXPECT_EQ(discarded_like(result, "file", ""), open ? 1U : 0U) << form.name << list_discarded(result);
  }
}

TEST(RosContainers, a_folder_is_read_with_all_its_splits_and_misses_those_that_are_not_there) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / "odomcalib_split_bag";
  fs::remove_all(folder);
  fs::create_directory(folder);
  const sim::RosLog whole = small_log(Wire::cdr_little);
  // Eleven splits: by name the eleventh comes before the third.
  constexpr std::size_t kSplits = 11;
  for (std::size_t k = 0; k < kSplits; ++k) {
    sim::RosLog part{whole.wire, whole.topics, {}};
    const std::size_t n = whole.messages.size();
    part.messages.assign(whole.messages.begin() + static_cast<std::ptrdiff_t>(n * k / kSplits),
                         whole.messages.begin() + static_cast<std::ptrdiff_t>(n * (k + 1) / kSplits));
    write_rosbag2(part, folder / ("drive_" + std::to_string(k) + ".db3"));
  }
  std::ofstream(folder / "metadata.yaml") << "rosbag2_bagfile_information: {}\n";
  const RobotDescription robot = test::ros_robot();
  auto result = value_of(read_recording(folder, &robot));
  expect_small_drive(result, MotionSource::wheels);
  EXPECT_EQ(result.name, "odomcalib_split_bag");
  EXPECT_EQ(result.sha256.size(), 64U);
  EXPECT_EQ(discarded_like(result, "file", ""), 0U);
  fs::remove(folder / "drive_4.db3");
  result = value_of(read_recording(folder, &robot));
  EXPECT_EQ(discarded_like(result, "file", "drive_4.db3 is missing"), 1U);
  EXPECT_LT(result.ticks.size(), 200U);
  fs::remove_all(folder);
}

TEST(RosContainers, a_folder_without_a_recording_is_named) {
  const auto empty = std::filesystem::path(testing::TempDir()) / "odomcalib_no_bag";
  std::filesystem::create_directory(empty);
  const auto none = read_recording(empty);
  std::filesystem::remove(empty);
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, ErrorCode::format);
  EXPECT_NE(none.error().text().find(".db3 or .mcap"), std::string::npos);
}

TEST(RosContainers, a_write_ahead_log_beside_the_file_is_told) {
  const auto path =
      test::write_file("with_log.db3", rosbag2_bytes(Wire::cdr_little, {.write_ahead_log = true}));
  const auto log = path.string() + "-wal";
  std::ofstream(log) << "rows that are not in the file yet";
  const RobotDescription robot = test::ros_robot();
  const auto result = read_recording(path, &robot);
  std::filesystem::remove(path);
  std::filesystem::remove(log);
  ASSERT_TRUE(result.ok()) << result.error().text();
  EXPECT_EQ(discarded_like(result.value(), "file", "wal_checkpoint"), 1U) << list_discarded(result.value());
}

/// An empty folder of its own for the test that runs.
std::filesystem::path empty_folder(const std::string& name) {
  auto folder = std::filesystem::path(testing::TempDir()) / ("odomcalib_" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  return folder;
}

TEST(RosContainers, write_ahead_logs_in_a_folder_are_told_with_their_files) {
  const auto folder = empty_folder("folder_with_logs");
  const sim::RosLog whole = small_log(Wire::cdr_little);
  for (std::size_t k = 0; k < 3; ++k) {
    sim::RosLog part{whole.wire, whole.topics, {}};
    const auto n = static_cast<std::ptrdiff_t>(whole.messages.size());
    const auto at = static_cast<std::ptrdiff_t>(k);
    part.messages.assign(whole.messages.begin() + n * at / 3, whole.messages.begin() + n * (at + 1) / 3);
    write_rosbag2(part, folder / ("drive_" + std::to_string(k) + ".db3"), {.write_ahead_log = true});
  }
  for (const char* name : {"drive_1.db3-wal", "drive_2.db3-wal"})
    std::ofstream(folder / name) << "rows that are not in the file yet";
  std::ofstream(folder / "drive_0.db3-wal") << "";  // all of it was moved
  const RobotDescription robot = test::ros_robot();
  const auto result = value_of(read_recording(folder, &robot));
  std::filesystem::remove_all(folder);
  expect_small_drive(result, MotionSource::wheels);
  EXPECT_EQ(discarded_like(result, "file", "drive_1.db3: what lies in its -wal"), 1U)
      << list_discarded(result);
  EXPECT_EQ(discarded_like(result, "file", "drive_2.db3: what lies in its -wal"), 1U)
      << list_discarded(result);
  EXPECT_EQ(discarded_like(result, "file", "wal_checkpoint"), 2U) << list_discarded(result);
}

TEST(RosContainers, whose_content_all_lies_in_the_write_ahead_log_say_how_to_merge_it) {
  const RobotDescription robot = test::ros_robot();
  for (const std::size_t size : {std::size_t{0}, std::size_t{4096}}) {
    const auto folder = empty_folder("all_in_the_log");
    const auto file = folder / "drive_0.db3";
    std::ofstream(file, std::ios::binary) << rosbag2_bytes(Wire::cdr_little).substr(0, size);
    std::ofstream(file.string() + "-wal") << "rows that are not in the file yet";
    for (const auto& path : {file, folder}) {
      const auto result = read_recording(path, &robot);
      ASSERT_FALSE(result.ok()) << path << size;
      EXPECT_NE(result.error().text().find("; merge what lies in its -wal beside it first"),
                std::string::npos)
          << path << size << result.error().text();
    }
    std::filesystem::remove_all(folder);
  }
}

TEST(RosContainers, a_folder_of_several_recordings_is_refused_with_their_names) {
  const std::string bytes = rosbag2_bytes(Wire::cdr_little);
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"hall.db3", "lab.db3"}, "hall.db3, lab.db3"},
      {{"drive1.db3", "drive2.db3"}, "drive1.db3, drive2.db3"},
      {{"drive_01.db3", "drive_02.db3"}, "drive_01.db3, drive_02.db3"},
      {{"hall_0.db3", "hall_1.db3", "lab_0.db3"}, "hall_0.db3 to hall_1.db3, lab_0.db3"},
      {{"hall_0.db3", "hall_0.mcap"}, "hall_0.db3, hall_0.mcap"},
      {{"run_20240501.db3", "run_20240502.db3"}, "run_20240501.db3, run_20240502.db3"},
      {{"run_20240501120000.db3", "run_20240501130000.db3"},
       "run_20240501120000.db3, run_20240501130000.db3"},
  };
  const RobotDescription robot = test::ros_robot();
  for (const auto& [names, listed] : cases) {
    const auto folder = empty_folder("several_bags");
    for (const auto& name : names) std::ofstream(folder / name, std::ios::binary) << bytes;
    const auto result = read_recording(folder, &robot);
    std::filesystem::remove_all(folder);
    ASSERT_FALSE(result.ok()) << listed;
    EXPECT_NE(result.error().text().find("several_bags: holds several recordings: " + listed + "; name one"),
              std::string::npos)
        << result.error().text();
  }
}

TEST(RosContainers, a_folder_of_one_file_of_any_name_lacks_nothing) {
  const std::string bytes = rosbag2_bytes(Wire::cdr_little);
  const RobotDescription robot = test::ros_robot();
  for (const char* name :
       {"hall.db3", "drive2.db3", "7.db3", "drive_0.db3", "drive_02.db3", "run_20240501.db3"}) {
    const auto folder = empty_folder("one_bag");
    std::ofstream(folder / name, std::ios::binary) << bytes;
    const auto result = value_of(read_recording(folder, &robot));
    std::filesystem::remove_all(folder);
    expect_small_drive(result, MotionSource::wheels);
    EXPECT_EQ(discarded_like(result, "file", ""), 0U) << name << ": " << list_discarded(result);
  }
}

/// Writes metadata.yaml of a folder with these splits.
void list_splits(const std::filesystem::path& folder, const std::vector<std::string>& names) {
  std::ofstream metadata(folder / "metadata.yaml");
  metadata << "rosbag2_bagfile_information:\n"
              "  version: 5\n"
              "  duration:\n"
              "    nanoseconds: 60\n"
              "  relative_file_paths:\n";
  for (const auto& name : names) metadata << "    - " << name << "\n";
  metadata << "  files:\n    - path: drive_9.db3\n      message_count: 3\n";
}

std::string choices_of(const Recording& recording) {
  std::string all;
  for (const auto& choice : recording.choices) all += choice + "\n";
  return all;
}

TEST(RosContainers, what_a_folder_lacks_is_told_by_its_metadata) {
  struct Case {
    std::vector<std::string> listed, missing;
  };
  const std::vector<Case> cases{
      {{"drive_4.db3"}, {}},
      {{"drive_4.db3.zstd"}, {}},
      {{"old/drive_3.db3", "old/drive_4.db3", "old/drive_5.db3"}, {"drive_3.db3", "drive_5.db3"}},
      {{"drive_2.db3"}, {"drive_2.db3", "drive_3.db3"}},  // the recorder went on behind what it had listed
  };
  const RobotDescription robot = test::ros_robot();
  for (const auto& [listed, missing] : cases) {
    const auto folder = empty_folder("listed_bag");
    std::ofstream(folder / "drive_4.db3", std::ios::binary) << rosbag2_bytes(Wire::cdr_little);
    list_splits(folder, listed);
    const auto result = value_of(read_recording(folder, &robot));
    std::filesystem::remove_all(folder);
    expect_small_drive(result, MotionSource::wheels);
    EXPECT_EQ(discarded_like(result, "file", ""), missing.size()) << listed.front() << list_discarded(result);
    for (const auto& name : missing)
      EXPECT_EQ(discarded_like(result, "file", name + " is missing"), 1U) << list_discarded(result);
    EXPECT_EQ(choices_of(result).find("begins with"), std::string::npos) << choices_of(result);
  }
}

TEST(RosContainers, without_metadata_nobody_knows_of_the_splits_before_the_first_one) {
  const RobotDescription robot = test::ros_robot();
  for (const char* metadata :
       {"", "{[", "rosbag2_bagfile_information:\n  relative_file_paths:\n    - other_0.db3\n"}) {
    const auto folder = empty_folder("unlisted_bag");
    std::ofstream(folder / "drive_4.db3", std::ios::binary) << rosbag2_bytes(Wire::cdr_little);
    if (*metadata != '\0') std::ofstream(folder / "metadata.yaml") << metadata;
    const auto result = value_of(read_recording(folder, &robot));
    std::filesystem::remove_all(folder);
    EXPECT_EQ(discarded_like(result, "file", ""), 0U) << metadata << list_discarded(result);
    EXPECT_NE(choices_of(result).find("begins with drive_4.db3; whether splits before it were kept"),
              std::string::npos)
        << metadata << choices_of(result);
  }
}

// A recorder that keeps the newest splits only numbers them on.
TEST(RosContainers, splits_of_large_numbers_are_of_one_recording_where_the_metadata_lists_them) {
  const auto folder = empty_folder("ring_of_splits");
  const std::string bytes = rosbag2_bytes(Wire::cdr_little);
  for (const char* name : {"drive_5000.db3", "drive_5001.db3"})
    std::ofstream(folder / name, std::ios::binary) << bytes;
  const RobotDescription robot = test::ros_robot();
  EXPECT_FALSE(read_recording(folder, &robot).ok()) << "these may be dates";
  list_splits(folder, {"drive_5000.db3", "drive_5001.db3"});
  const auto result = read_recording(folder, &robot);
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(result.ok()) << result.error().text();
  EXPECT_EQ(discarded_like(result.value(), "file", ""), 0U) << list_discarded(result.value());
}

TEST(RosContainers, a_file_that_is_there_packed_and_unpacked_is_read_once) {
  const RobotDescription robot = test::ros_robot();
  const std::string bytes = rosbag2_bytes(Wire::cdr_little);
  const std::string packed = sim::packed(RosPacking::zstd, bytes);
  struct Case {
    std::string plain, said;
  };
  for (const char* name : {"drive_0.db3", "hall.db3", "run_20240501.db3"}) {
    const std::string file = name;
    for (const auto& [plain, said] :
         {Case{bytes, file + " is read; " + file + ".zstd is the same packed, and is not"},
          Case{bytes.substr(0, bytes.size() / 2),
               file + ".zstd is read; " + file + " is the same with less in it, and is not"}}) {
      const auto folder = empty_folder("packed_and_unpacked");
      std::ofstream(folder / file, std::ios::binary) << plain;
      std::ofstream(folder / (file + ".zstd"), std::ios::binary) << packed;
      const auto result = read_recording(folder, &robot);
      std::filesystem::remove_all(folder);
      ASSERT_TRUE(result.ok()) << result.error().text();
      expect_small_drive(result.value(), MotionSource::wheels);
      EXPECT_EQ(discarded_like(result.value(), "file", ""), 0U) << list_discarded(result.value());
      EXPECT_EQ(discarded_like(result.value(), "scan", ""), 0U) << list_discarded(result.value());
      EXPECT_NE(choices_of(result.value()).find(said), std::string::npos) << choices_of(result.value());
    }
  }
}

TEST(RosContainers, of_an_older_form_or_encrypted_say_what_to_do) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"#ROSBAG V1.2\n", "rosbag fix"},
      {sim::packed(RosPacking::zstd, "something else"), "zstd -d"},
      {"SQLite format 3" + std::string(200, '\0'), "integrity_check"},
  };
  for (const auto& [bytes, words] : cases) {
    const auto result = read_ros(bytes);
    ASSERT_FALSE(result.ok()) << words;
    EXPECT_EQ(result.error().code, ErrorCode::format);
    EXPECT_NE(result.error().text().find(words), std::string::npos) << result.error().text();
  }
  std::string bag = write_bag(small_log(Wire::ros1));
  const std::string plain = "conn_count=";
  // The header has no encryptor; one of the same length stands in for the count of connections.
  bag.replace(bag.find(plain), 15, "encryptor=aes12");
  const auto result = read_ros(bag);
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().text().find("encrypted"), std::string::npos) << result.error().text();
}

}  // namespace
}  // namespace odomcalib::ros_containers_test
