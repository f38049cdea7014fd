#include "daemon/service/state_folder.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <set>

#include "tests/temporary_folder.hpp"

namespace odomcalib::retention_test {
namespace {

namespace fs = std::filesystem;

class RetentionTest : public testing::Test {
 protected:
  void make(const std::string& name, std::size_t bytes, int hours_ago) {
    std::ofstream(folder_ / name) << std::string(bytes, 'x');
    fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - std::chrono::hours(hours_ago));
  }
  std::set<std::string> present() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.insert(entry.path().filename());
    return names;
  }
  TemporaryFolder folder_;
};

TEST_F(RetentionTest, removes_the_oldest_and_what_belongs_to_it) {
  make("spin-1.lcmlog", 400, 3);
  make("spin-1.candump", 100, 3);
  make("spin-2.lcmlog", 400, 2);
  make("spin-3.lcmlog", 400, 1);
  EXPECT_EQ(keep_newest(folder_, {900, 100}), std::vector<std::string>{"spin-1"});
  EXPECT_EQ(present(), (std::set<std::string>{"spin-2.lcmlog", "spin-3.lcmlog"}));
}

TEST_F(RetentionTest, removes_nothing_below_the_limits) {
  make("a.lcmlog", 400, 2);
  make("b.lcmlog", 500, 1);
  EXPECT_TRUE(keep_newest(folder_, {900, 2}).empty());
  EXPECT_EQ(present().size(), 2U);
}

TEST_F(RetentionTest, keeps_so_many_and_the_newest_however_large) {
  for (int i = 0; i < 5; ++i) make(std::to_string(i) + ".json", 10, i);
  EXPECT_EQ(keep_newest(folder_, {1000, 3}).size(), 2U);
  EXPECT_EQ(present(), (std::set<std::string>{"0.json", "1.json", "2.json"}));
  EXPECT_EQ(keep_newest(folder_, {5, 3}).size(), 2U);
  EXPECT_EQ(present(), std::set<std::string>{"0.json"});
}

TEST_F(RetentionTest, follows_no_link_and_no_folder) {
  make("old.lcmlog", 400, 9);
  fs::create_directory(folder_ / "older");
  const fs::path elsewhere = folder_.path().string() + "-elsewhere";
  std::ofstream(elsewhere) << "kept";
  fs::create_symlink(elsewhere, folder_ / "link.lcmlog");
  make("new.lcmlog", 400, 1);
  (void)keep_newest(folder_, {400, 9});
  EXPECT_EQ(present(), (std::set<std::string>{"link.lcmlog", "new.lcmlog", "older"}));
  EXPECT_TRUE(fs::exists(elsewhere));
  fs::remove(elsewhere);
}

TEST_F(RetentionTest, of_a_folder_that_is_not_there_is_nothing) {
  EXPECT_TRUE(keep_newest(folder_ / "absent", {0, 0}).empty());
}

}  // namespace
}  // namespace odomcalib::retention_test
