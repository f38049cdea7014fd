// Outputs go where a user points, whatever stands there.
#include "proto/file_bytes.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <fstream>

namespace odomcalib::file_bytes_test {
namespace {

namespace fs = std::filesystem;

class Output : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "elsewhere");
  }
  void TearDown() override { fs::remove_all(folder_); }
  static std::string content(const fs::path& path) { return read_file_bytes(path).value(); }
  static std::ptrdiff_t files_in(const fs::path& folder) {
    return std::distance(fs::directory_iterator(folder), {});
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("file_bytes_output_" + std::to_string(getpid()));
};

TEST_F(Output, behind_a_link_is_replaced_and_the_link_stays) {
  std::ofstream(folder_ / "elsewhere" / "file") << "old";
  fs::create_symlink("elsewhere/file", folder_ / "near");
  fs::create_symlink("near", folder_ / "far");
  ASSERT_TRUE(write_output(folder_ / "far", "new").ok());
  EXPECT_TRUE(fs::is_symlink(folder_ / "far"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "near"));
  EXPECT_EQ(content(folder_ / "elsewhere" / "file"), "new");
  EXPECT_EQ(files_in(folder_ / "elsewhere"), 1) << "no temporary file stays";
}

TEST_F(Output, behind_a_link_into_nothing_is_made_where_the_link_points) {
  fs::create_symlink(folder_ / "elsewhere" / "file", folder_ / "link");
  ASSERT_TRUE(check_output(folder_ / "link").ok());
  ASSERT_TRUE(write_output(folder_ / "link", "new").ok());
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(content(folder_ / "elsewhere" / "file"), "new");
}

TEST_F(Output, that_is_a_fifo_takes_the_bytes) {
  const fs::path fifo = folder_ / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const int reader = open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_TRUE(write_output(fifo, "bytes").ok());
  std::array<char, 8> got{};
  EXPECT_EQ(read(reader, got.data(), got.size()), 5);
  close(reader);
  EXPECT_TRUE(fs::is_fifo(fifo));
}

TEST_F(Output, that_is_a_device_takes_the_bytes_and_stays_a_device) {
  const fs::path device = folder_ / "null";
  if (mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 3)) != 0 || access(device.c_str(), W_OK) != 0)
    GTEST_SKIP() << "needs the right to make a device";
  const int fd = open(device.c_str(), O_WRONLY);
  if (fd < 0) GTEST_SKIP() << "no devices on this file system";
  close(fd);
  ASSERT_TRUE(check_output(device).ok());
  ASSERT_TRUE(write_output(device, "bytes").ok());
  EXPECT_TRUE(fs::is_character_file(device));
}

TEST_F(Output, that_is_a_folder_is_refused) {
  EXPECT_EQ(check_output(folder_).error().what, "is a folder");
  EXPECT_EQ(write_output(folder_, "bytes").error().what, "is a folder");
}

TEST_F(Output, in_a_folder_that_is_not_there_is_refused_beforehand) {
  EXPECT_EQ(check_output(folder_ / "absent" / "file").error().code, ErrorCode::io);
  EXPECT_TRUE(check_output(folder_ / "file").ok());
  EXPECT_FALSE(fs::exists(folder_ / "file")) << "a check changes nothing";
}

// A program's own folder is no place where links lead out of it.
TEST_F(Output, of_the_program_itself_replaces_a_link) {
  std::ofstream(folder_ / "elsewhere" / "file") << "old";
  fs::create_symlink("elsewhere/file", folder_ / "link");
  ASSERT_TRUE(replace_file(folder_ / "link", "new").ok());
  EXPECT_FALSE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(content(folder_ / "elsewhere" / "file"), "old");
}

}  // namespace
}  // namespace odomcalib::file_bytes_test
