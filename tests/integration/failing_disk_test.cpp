// A disk that answers one request with an error: whichever it is, the write-back ends wholly old or wholly
// new, in the drive's RAM and in its permanent memory, and the client is told which.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

#include "daemon/writeback/history.hpp"
#include "daemon/writeback/journal.hpp"
#include "tests/integration/service_loop.hpp"

namespace {

int syncs_until_error = 0;  // 0: none

bool disk_full = false;

/// In the state directory of a daemon.
bool of_state(int fd) {
  std::array<char, 256> path{};
  const std::string link = "/proc/self/fd/" + std::to_string(fd);
  return readlink(link.c_str(), path.data(), path.size() - 1) > 0 &&
         std::string_view(path.data()).find("/state/") != std::string_view::npos;
}

/// A full disk refuses only bytes beyond the present end of a file.
bool is_full_for(int fd, std::int64_t end) {
  struct stat file {};
  const bool full = disk_full && of_state(fd) && fstat(fd, &file) == 0 && end > file.st_size;
  if (full) errno = ENOSPC;
  return full;
}

int sync_or_fail(long call, int fd) {
  if (syncs_until_error > 0 && --syncs_until_error == 0) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(syscall(call, fd));
}

}  // namespace

// In this program these come before the functions of the C library.
extern "C" int fdatasync(int fd) { return sync_or_fail(SYS_fdatasync, fd); }
extern "C" int fsync(int fd) { return sync_or_fail(SYS_fsync, fd); }
extern "C" ssize_t write(int fd, const void* bytes, size_t count) {
  if (disk_full && is_full_for(fd, lseek(fd, 0, SEEK_CUR) + static_cast<std::int64_t>(count))) return -1;
  return syscall(SYS_write, fd, bytes, count);
}
extern "C" ssize_t pwrite(int fd, const void* bytes, size_t count, off_t at) {
  if (is_full_for(fd, at + static_cast<std::int64_t>(count))) return -1;
  return syscall(SYS_pwrite64, fd, bytes, count, at);
}
extern "C" int posix_fallocate(int fd, off_t at, off_t count) {
  if (is_full_for(fd, at + count)) return ENOSPC;
  return syscall(SYS_fallocate, fd, 0, at, count) == 0 ? 0 : errno;
}

namespace odomcalib::failing_disk_test {
namespace {

using Raw = std::array<std::uint32_t, 3>;

constexpr Raw kOldRaw{150000, 150000, 400000}, kNewRaw{151200, 149800, 403300};
const json kNew{{"left_wheel_diameter", 0.1512}, {"right_wheel_diameter", 0.1498}, {"track_width", 0.4033}};

// The calibration (file, folder), then begin, write, readback_ok, store_begin.
constexpr int kLastBeforeStore = 6;

class OnFailingDisk : public ServiceLoop, public testing::WithParamInterface<int> {
 protected:
  void TearDown() override {
    syncs_until_error = 0;
    ServiceLoop::TearDown();
  }
  control::Reply apply() {
    json parameters = json::object();
    for (const auto& [name, value] : kNew.items())
      parameters[name] = {{"value", value}, {"std", 1e-5}, {"unit", "m"}};
    acquire();
    return ask(
        "Apply",
        {{"lease", lease_},
         {"of_this_robot", true},
         {"calibration",
          {{"format", "odomcalib-calibration/1"}, {"verdict", "accepted"}, {"parameters", parameters}}}},
        30.0);
  }
  sim::DriveNode& node() { return robot_->node(); }
};

TEST_P(OnFailingDisk, a_write_back_ends_wholly_old_or_wholly_new_and_says_which) {
  syncs_until_error = GetParam();
  const auto reply = apply();
  EXPECT_EQ(syncs_until_error, 0) << "there was no such request";
  run(1.0);
  const bool stored = node().geometry_stored() == kNewRaw;
  std::printf("error at request %d: %s, %s\n", GetParam(), stored ? "new" : "old", reply.error.c_str());
  EXPECT_EQ(node().geometry_stored(), stored ? kNewRaw : kOldRaw);
  EXPECT_EQ(node().geometry_in_ram(), stored ? kNewRaw : kOldRaw);
  EXPECT_EQ(status()["operator_needed"], false);
  EXPECT_EQ(stored, GetParam() > kLastBeforeStore) << "no action without its record, none undone for one";
  if (!stored) {
    EXPECT_NE(reply.error, "") << "the old values are in force";
  }
  if (stored && !reply.error.empty()) {
    EXPECT_NE(reply.parameters.find("the values are in the controller"), std::string::npos)
        << reply.parameters;
  }
}

TEST_P(OnFailingDisk, the_next_start_finds_nothing_undecided) {
  syncs_until_error = GetParam();
  (void)apply();
  run(1.0);
  const Raw before = node().geometry_stored();
  end_service();
  start_service();
  ASSERT_TRUE(run_until([this] { return ready(); }, 10.0)) << service_->status_json();
  run(1.0);
  EXPECT_EQ(node().geometry_stored(), before);
  EXPECT_EQ(node().geometry_in_ram(), before);
  EXPECT_EQ(status()["operator_needed"], false);
  EXPECT_FALSE(Journal::open(folder_ / "state" / "journal").value().unfinished());
}

// A disk that is full, or becomes it.
class OnFullDisk : public ServiceLoop {
 protected:
  void TearDown() override {
    disk_full = false;
    ServiceLoop::TearDown();
  }
  control::Reply call(const std::string& method, json parameters = json::object()) {
    if (lease_.empty()) acquire();
    parameters["lease"] = lease_;
    return ask(method, parameters, 30.0);
  }
  json history() { return json::parse(call("History").parameters)["entries"]; }
  void restart() {
    end_service();
    start_service();
    ASSERT_TRUE(run_until([this] { return ready(); }, 10.0)) << service_->status_json();
  }
  [[nodiscard]] std::size_t entries_on_disk() const {
    return History(folder_ / "state" / "history").entries().size();
  }
};

TEST_F(OnFullDisk, nothing_is_sent_to_the_drive) {
  disk_full = true;
  const auto reply = call("SetParameters", {{"values", kNew}});
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.Io") << reply.parameters;
  EXPECT_NE(reply.parameters.find("No space left"), std::string::npos) << reply.parameters;
  EXPECT_EQ(robot_->node().geometry_in_ram(), kOldRaw);
  EXPECT_EQ(std::filesystem::file_size(folder_ / "state" / "journal"), 0U);
  EXPECT_EQ(status()["operator_needed"], false);
  disk_full = false;
  EXPECT_EQ(call("SetParameters", {{"values", kNew}}).error, "");
}

TEST_F(OnFullDisk, that_becomes_full_meanwhile_a_write_back_ends_and_is_remembered) {
  acquire();
  TestClient writer(folder_ / "control");
  writer.call("SetParameters", {{"lease", lease_}, {"values", kNew}});
  ASSERT_TRUE(run_until([this] { return robot_->node().geometry_in_ram() != kOldRaw; }, 10.0));
  disk_full = true;
  EXPECT_EQ(wait_reply(writer, 30.0).error, "");
  EXPECT_EQ(robot_->node().geometry_stored(), kNewRaw);
  EXPECT_EQ(entries_on_disk(), 0U) << "the disk was not full: this tests nothing";
  for (int start = 0; start < 2; ++start) {
    ASSERT_EQ(history().size(), 1U);
    EXPECT_EQ(history()[0]["outcome"], "committed");
    restart();
  }
  const auto reply = call("Rollback");
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.Io") << "it knows where to go: " << reply.parameters;
  EXPECT_EQ(robot_->node().geometry_in_ram(), kNewRaw);
  disk_full = false;
  EXPECT_EQ(call("Rollback").error, "");
  EXPECT_EQ(robot_->node().geometry_stored(), kOldRaw);
  EXPECT_EQ(entries_on_disk(), 2U);
}

// The calibration, six records, then history and calibration in force (file, folder each).
INSTANTIATE_TEST_SUITE_P(Service, OnFailingDisk, testing::Range(1, 13));

}  // namespace
}  // namespace odomcalib::failing_disk_test
