// Outputs go where a user points, whatever stands there.
#include "proto/file_bytes.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
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

/// Unpacks what comes in pieces of `size` bytes.
Unpacked gunzip_by(std::size_t size, std::string_view packed, std::size_t most = 1 << 20) {
  std::string bytes;
  Gunzip unpacking(most, [&](std::string_view piece) { bytes.append(piece); });
  for (; !packed.empty(); packed.remove_prefix(std::min(size, packed.size())))
    unpacking.feed(packed.substr(0, size));
  Unpacked result = unpacking.finish();
  result.bytes = bytes;
  return result;
}

TEST(Gunzip, gives_the_same_in_whatever_pieces_the_file_comes) {
  const std::string one = gzip("one\n").value(), two = gzip(std::string(200000, 'x')).value();
  std::string damaged = two;
  damaged[damaged.size() - 6] ^= '\x55';  // of the check sum
  struct Case {
    std::string packed;
    std::size_t least;  ///< bytes that can be unpacked
    std::string problem;
  };
  const std::vector<Case> cases{{one, 4, ""},
                                {one + two, 200004, ""},
                                {one + two + std::string(1000, '\0'), 200004, ""},
                                {one + '\0', 4, ""},
                                {one + std::string(1000, '\0') + 'x', 4, "bytes after the compressed data"},
                                {one + "x", 4, "bytes after the compressed data"},
                                {one + two[0], 4, "bytes after the compressed data"},
                                {one + two.substr(0, 2), 4, "compressed data is cut off"},
                                {one + two.substr(0, two.size() - 1), 200004, "compressed data is cut off"},
                                {one + damaged, 4, "compressed data is damaged"}};
  for (const Case& c : cases)
    for (const std::size_t size : {1U, 2U, 3U, 7U, 1000U, 1U << 20U}) {
      SCOPED_TRACE(c.problem + ", pieces of " + std::to_string(size));
      const Unpacked got = gunzip_by(size, c.packed);
      EXPECT_GE(got.bytes.size(), c.least);
      EXPECT_TRUE(got.bytes.starts_with("one\n"));
      EXPECT_EQ(got.problem, c.problem);
      EXPECT_EQ(got.whole, c.problem.empty());
      EXPECT_FALSE(got.over_limit);
    }
}

TEST(Gunzip, hands_over_hardly_more_than_the_limit) {
  const std::string packed = gzip(std::string(10 << 20, 'x')).value();
  for (const std::size_t size : {100U, 1U << 20U}) {
    const Unpacked got = gunzip_by(size, packed, 1 << 20);
    EXPECT_TRUE(got.over_limit);
    EXPECT_LE(got.bytes.size(), (1U << 20U) + (1U << 16U));
    EXPECT_FALSE(gunzip_by(size, packed, 10 << 20).over_limit) << "just as much as is allowed";
  }
}

TEST(Sha256, of_pieces_is_that_of_the_whole) {
  // FIPS 180-4, example of one block.
  Sha256 hash;
  for (const char* piece : {"a", "", "bc"}) hash.take(piece);
  EXPECT_EQ(hash.hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace odomcalib::file_bytes_test
