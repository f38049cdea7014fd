// A disk that answers one request with an error: whichever it is, the write-back ends wholly old or wholly
// new, in the drive's RAM and in its permanent memory, and the client is told which.
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

#include "daemon/writeback/journal.hpp"
#include "tests/integration/service_loop.hpp"

namespace {

int syncs_until_error = 0;  // 0: none

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

// The calibration, six records, then history and calibration in force (file, folder each).
INSTANTIATE_TEST_SUITE_P(Service, OnFailingDisk, testing::Range(1, 13));

}  // namespace
}  // namespace odomcalib::failing_disk_test
