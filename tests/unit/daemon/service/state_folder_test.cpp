#include "daemon/service/state_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "daemon/service/parts/last_run.hpp"
#include "proto/file_bytes.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::state_folder_test {
namespace {

namespace fs = std::filesystem;

class StateFolderTest : public testing::Test {
 protected:
  TemporaryFolder path_;
};

TEST_F(StateFolderTest, is_for_one_daemon_at_a_time) {
  {
    const auto first = value_of(StateFolder::open(path_ / "state"));
    EXPECT_FALSE(first.read_only());
    const auto second = StateFolder::open(path_ / "state");
    ASSERT_FALSE(second.ok());
    EXPECT_NE(second.error().what.find("another daemon"), std::string::npos) << second.error().text();
  }
  EXPECT_TRUE(StateFolder::open(path_ / "state").ok()) << "the first has ended";
}

TEST_F(StateFolderTest, that_cannot_be_written_to_says_so_and_is_no_error) {
  std::ofstream(path_ / "file") << "in the way";
  const auto folder = value_of(StateFolder::open(path_ / "file" / "state"));
  ASSERT_TRUE(folder.read_only());
  EXPECT_FALSE(folder.read_only()->remedy.empty());
}

TEST_F(StateFolderTest, LastRun_says_why_the_robot_was_stopped_before_the_restart) {
  {
    LastRun run(path_ / "last_run.json", foreground());
    EXPECT_EQ(run.last_stop(), "");
    EXPECT_FALSE(run.after_crash());
    run.begins("straight");
    run.stopped("something is in the way");
    run.daemon_ends();
  }
  const LastRun next(path_ / "last_run.json", foreground());
  EXPECT_EQ(next.last_stop(), "something is in the way");
  EXPECT_FALSE(next.after_crash());
}

TEST_F(StateFolderTest, LastRun_knows_a_daemon_that_ended_in_a_motion_without_being_stopped) {
  { LastRun(path_ / "last_run.json", foreground()).begins("straight"); }
  const LastRun next(path_ / "last_run.json", foreground());
  EXPECT_TRUE(next.after_crash());
  EXPECT_NE(next.last_stop().find("straight"), std::string::npos) << next.last_stop();
}

TEST_F(StateFolderTest, LastRun_knows_that_a_motion_had_ended_before) {
  {
    LastRun run(path_ / "last_run.json", foreground());
    run.begins("straight");
    run.ends();
  }
  const LastRun next(path_ / "last_run.json", foreground());
  EXPECT_TRUE(next.after_crash());
  EXPECT_EQ(next.last_stop().find("straight"), std::string::npos) << next.last_stop();
}

TEST_F(StateFolderTest, LastRun_keeps_the_old_record_whole_where_the_disk_is_full) {
  const fs::path file = path_ / "last_run.json";
  {
    LastRun run(file, foreground());
    run.stopped("a wall");
    run.daemon_ends();
    fs::create_symlink("/dev/full", file.string() + ".new");
    run.stopped("a door");
  }
  ASSERT_TRUE(fs::is_regular_file(fs::symlink_status(file)));
  const LastRun next(file, foreground());
  EXPECT_FALSE(next.damage());
  EXPECT_EQ(next.last_stop(), "a wall");
  { LastRun(file, foreground()).stopped("a door"); }
  EXPECT_NE(read_file_bytes(file).value().find("a door"), std::string::npos) << "the disk has space again";
}

TEST_F(StateFolderTest, LastRun_knows_whether_the_robot_has_ever_moved) {
  for (const bool before : {false, true}) {
    LastRun run(path_ / "last_run.json", foreground());
    EXPECT_EQ(run.moved(), before);
    run.begins("straight");
    EXPECT_TRUE(run.moved());
    run.ends();
    run.daemon_ends();
  }
}

TEST_F(StateFolderTest, LastRun_says_that_a_damaged_file_is_damaged) {
  const fs::path file = path_ / "last_run.json";
  for (const char* text : {"", "{", "[1]", R"({"ended": 3, "doing": 4, "last_stop": null})",
                           R"({"ended": true, "doing": "", "last_stop": "", "moved": 1})"}) {
    std::ofstream(file) << text;
    const LastRun run(file, foreground());
    ASSERT_TRUE(run.damage()) << text;
    EXPECT_EQ(run.damage()->text().find(file.string() + ": is damaged; "), 0U) << run.damage()->text();
    EXPECT_EQ(run.last_stop(), "not known: " + file.string() + " is damaged") << text;
    EXPECT_FALSE(run.after_crash()) << text;
    EXPECT_FALSE(run.moved()) << text;
    EXPECT_FALSE(LastRun(file, foreground()).damage()) << "it was written anew";
  }
  fs::remove(file);
  fs::create_directory(file);
  const LastRun run(file, foreground());
  ASSERT_TRUE(run.damage());
  EXPECT_EQ(run.damage()->what, "cannot be read: is a folder");
}

TEST_F(StateFolderTest, LastRun_keeps_what_of_a_damaged_file_is_sound) {
  std::ofstream(path_ / "last_run.json")
      << R"({"ended": false, "doing": "spin", "last_stop": 1, "moved": true})";
  const LastRun run(path_ / "last_run.json", foreground());
  EXPECT_TRUE(run.damage());
  EXPECT_TRUE(run.after_crash());
  EXPECT_TRUE(run.moved());
  EXPECT_NE(run.last_stop().find("during \"spin\""), std::string::npos) << run.last_stop();
}

TEST_F(StateFolderTest, LastRun_takes_no_file_and_that_of_an_earlier_version_for_sound) {
  EXPECT_FALSE(LastRun(path_ / "last_run.json", foreground()).damage());
  std::ofstream(path_ / "last_run.json") << R"({"ended": true, "doing": "", "last_stop": "a wall"})";
  const LastRun run(path_ / "last_run.json", foreground());
  EXPECT_FALSE(run.damage());
  EXPECT_EQ(run.last_stop(), "a wall");
}

}  // namespace
}  // namespace odomcalib::state_folder_test
