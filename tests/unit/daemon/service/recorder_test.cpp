// Recordings and a disk that takes its time: nothing waits for it, nothing is lost, what fails is told.
#include <gtest/gtest.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <thread>
#include <vector>

#include "daemon/service/telemetry.hpp"
#include "proto/recording/recording.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/value_of.hpp"

namespace {

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 40U;
std::uint64_t bytes_free = kPlenty;

}  // namespace

// In this program it comes before the function of the C library.
extern "C" int statvfs(const char* path, struct statvfs* space) noexcept {
  *space = {};
  space->f_frsize = space->f_bsize = 1;
  space->f_bavail = space->f_bfree = bytes_free;
  return access(path, F_OK);
}

namespace odomcalib::recorder_test {
namespace {

using Path = std::filesystem::path;

/// A disk that does nothing until it is let go, and fails where it is told to.
struct Disk {
  std::atomic<bool> stalls = false;
  std::atomic<int> fails_at = -1;  ///< item; 0 also: the file cannot be made
  std::vector<RecordedItem> written;
  std::atomic<bool> whole = false;

  void wait() const {
    while (stalls) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
};

class SinkOnDisk final : public RecordingSink {
 public:
  explicit SinkOnDisk(std::shared_ptr<Disk> disk) : disk_(std::move(disk)) {}
  Result<void> open() override {
    disk_->wait();
    return fails(0);
  }
  Result<void> write(const RecordedItem& item) override {
    disk_->wait();
    if (auto done = fails(static_cast<int>(disk_->written.size()) + 1); !done) return done;
    disk_->written.push_back(item);
    return {};
  }
  Result<void> finish() override {
    disk_->wait();
    disk_->whole = true;
    return {};
  }

 private:
  [[nodiscard]] Result<void> fails(int at) const {
    if (disk_->fails_at != at) return {};
    return Error{ErrorCode::io, "disk full", "disk", ""};
  }
  std::shared_ptr<Disk> disk_;
};

class RecordingOnDisk : public ::testing::Test {
 protected:
  void TearDown() override {
    disk_->stalls = false;
    recorder_.reset();
  }
  void on_slow_disk() {
    recorder_ = std::make_unique<Recorder>(folder_, "P_", [this](const Path&, const std::string&) {
      return std::make_unique<SinkOnDisk>(disk_);
    });
  }
  Recorder::Done note() {
    return [this](const Result<Path>& path) { ended_ = std::make_unique<Result<Path>>(path); };
  }
  bool ends() {
    for (int i = 0; i < 20'000 && !ended_; ++i) {
      recorder_->serve();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return ended_ != nullptr;
  }

  TemporaryFolder folder_;
  std::shared_ptr<Disk> disk_ = std::make_shared<Disk>();
  std::unique_ptr<Recorder> recorder_;
  std::unique_ptr<Result<Path>> ended_;
};

// Every call returns while the disk stalls: if one waited for it, this test would never end.
TEST_F(RecordingOnDisk, goes_on_while_the_disk_stalls_and_loses_nothing) {
  on_slow_disk();
  disk_->stalls = true;
  ASSERT_TRUE(recorder_->start("slow").ok());
  constexpr int kItems = 20'000;
  for (int i = 0; i < kItems; ++i) recorder_->write(i, "TICKS", "message " + std::to_string(i));
  EXPECT_GT(recorder_->bytes_waiting(), 100'000U);
  recorder_->finish(note());
  for (int i = 0; i < 100; ++i) recorder_->serve();
  EXPECT_FALSE(ended_);
  EXPECT_TRUE(recorder_->finishing());
  disk_->stalls = false;
  ASSERT_TRUE(ends());
  EXPECT_TRUE(ended_->ok());
  EXPECT_TRUE(disk_->whole);
  ASSERT_EQ(disk_->written.size(), static_cast<std::size_t>(kItems));
  for (int i = 0; i < kItems; ++i) {
    ASSERT_EQ(disk_->written[static_cast<std::size_t>(i)].utime, i);
    ASSERT_EQ(disk_->written[static_cast<std::size_t>(i)].bytes, "message " + std::to_string(i));
    ASSERT_EQ(disk_->written[static_cast<std::size_t>(i)].channel, "P_TICKS");
  }
}

TEST_F(RecordingOnDisk, begins_anew_while_the_one_before_is_still_being_written) {
  on_slow_disk();
  disk_->stalls = true;
  const auto first = value_of(recorder_->start("same"));
  recorder_->finish({});
  const auto second = value_of(recorder_->start("same"));
  EXPECT_NE(first, second) << "the first file does not exist yet";
  for (std::size_t i = 2; i < Recorder::kMostUnfinished; ++i) {
    recorder_->finish({});
    ASSERT_TRUE(recorder_->start("same").ok());
  }
  recorder_->finish({});
  EXPECT_EQ(recorder_->start("same").error().code, ErrorCode::io) << "bounded";
}

TEST_F(RecordingOnDisk, does_not_begin_with_less_than_64_MB_of_free_space) {
  on_slow_disk();
  bytes_free = 64'000'000 - 1;
  const auto refused = recorder_->start("full");
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().text().find("64 MB"), std::string::npos) << refused.error().text();
  bytes_free += 1;
  EXPECT_TRUE(recorder_->start("just_enough").ok());
  bytes_free = kPlenty;
}

TEST_F(RecordingOnDisk, tells_a_queue_that_is_full) {
  on_slow_disk();
  disk_->stalls = true;
  ASSERT_TRUE(recorder_->start("full").ok());
  const std::string large(std::size_t{1} << 20, 'x');
  for (std::size_t i = 0; i <= RecordingWriter::kMostBytes / large.size(); ++i)
    recorder_->write(0, "SCAN", large);
  ASSERT_TRUE(recorder_->problem().has_value());
  EXPECT_NE(recorder_->problem()->what.find("keep up"), std::string::npos);
  disk_->stalls = false;
  recorder_->finish(note());
  ASSERT_TRUE(ends());
  EXPECT_EQ(ended_->error().code, ErrorCode::io);
}

class FailingDisk : public RecordingOnDisk, public ::testing::WithParamInterface<int> {};

TEST_P(FailingDisk, is_told_while_recording_and_at_the_end) {
  on_slow_disk();
  disk_->fails_at = GetParam();
  ASSERT_TRUE(recorder_->start("failing").ok());
  for (int i = 0; i < 10; ++i) recorder_->write(i, "TICKS", "x");
  for (int i = 0; i < 20'000 && !recorder_->problem(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_TRUE(recorder_->problem().has_value());
  EXPECT_EQ(recorder_->problem()->what, "disk full");
  recorder_->finish(note());
  ASSERT_TRUE(ends());
  EXPECT_EQ(ended_->error().what, "disk full");
  EXPECT_EQ(disk_->written.size(), static_cast<std::size_t>(std::max(0, GetParam() - 1)));
}

INSTANTIATE_TEST_SUITE_P(RecordingOnDisk, FailingDisk, ::testing::Values(0, 1, 5));

TEST_F(RecordingOnDisk, of_files_makes_room_for_itself_among_those_before_it) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "older.lcmlog") << std::string(3000, 'x');
  std::ofstream(folder_ / "older.candump") << std::string(3000, 'x');
  std::filesystem::last_write_time(folder_ / "older.lcmlog",
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
  std::filesystem::last_write_time(folder_ / "older.candump",
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
  std::ofstream(folder_ / "newer.lcmlog") << std::string(3000, 'x');
  recorder_ = std::make_unique<Recorder>(
      folder_, "ODOMCALIB_",
      [](const Path& path, const std::string& prefix) { return recording_file(path, prefix, 5000); });
  ASSERT_TRUE(recorder_->start("next").ok());
  recorder_->finish(note());
  ASSERT_TRUE(ends());
  ASSERT_TRUE(ended_->ok()) << ended_->error().text();
  EXPECT_FALSE(std::filesystem::exists(folder_ / "older.lcmlog"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "older.candump"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "newer.lcmlog"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "next.lcmlog"));
}

TEST_F(RecordingOnDisk, of_files_is_whole_when_its_end_is_told) {
  recorder_ =
      std::make_unique<Recorder>(folder_, "ODOMCALIB_", [](const Path& path, const std::string& prefix) {
        return recording_file(path, prefix, std::uintmax_t{1} << 30);
      });
  ASSERT_TRUE(recorder_->start("real").ok());
  RobotDescription robot;
  robot.left_wheel_diameter = robot.right_wheel_diameter = 0.15;
  robot.track_width = 0.4;
  robot.ticks_per_rev = 4096;
  recorder_->write(1'000'000, "ROBOT", messages::encode(1'000'000, robot));
  constexpr int kSamples = 3000;
  for (int i = 0; i < kSamples; ++i) {
    const messages::Stamp stamp{1'000'000 + 20'000 * i, std::int64_t{20'000'000} * i};
    recorder_->write(stamp.utime, "TICKS", messages::encode(stamp, TickSample{0.02 * i, i, i, 0}));
    drivers::CanFrame frame;
    frame.id = 0x181;
    recorder_->write_frame(stamp.utime, frame);
  }
  recorder_->finish(note());
  ASSERT_TRUE(ends());
  ASSERT_TRUE(ended_->ok()) << ended_->error().text();
  const auto recording = value_of(read_recording(ended_->value()));
  EXPECT_EQ(recording.ticks.size(), static_cast<std::size_t>(kSamples));
  std::ifstream frames(Path(ended_->value()).replace_extension(".candump"));
  int lines = 0;
  for (std::string line; std::getline(frames, line);) ++lines;
  EXPECT_EQ(lines, kSamples);
}

TEST_F(RecordingOnDisk, has_a_name_within_its_folder) {
  on_slow_disk();
  EXPECT_EQ(recorder_->start("../escape").error().code, ErrorCode::usage);
  EXPECT_EQ(recorder_->start("").error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace odomcalib::recorder_test
