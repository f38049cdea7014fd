// A disk that takes two seconds for each thing that it is asked for, in virtual time: a write-back takes its
// time, and the drive, its watchdog and the clients notice nothing of it.
#include <deque>

#include "daemon/writeback/journal.hpp"
#include "tests/integration/service_loop.hpp"

namespace odomcalib::slow_disk_test {
namespace {

using Raw = std::array<std::uint32_t, 3>;

constexpr double kSlow = 2.0;  // s
constexpr Raw kOldRaw{150000, 150000, 400000}, kNewRaw{151200, 149800, 403300};
const json kNew{{"left_wheel_diameter", 0.1512}, {"right_wheel_diameter", 0.1498}, {"track_width", 0.4033}};

/// Works when its time has come, not before: nothing can be known of it earlier.
class SlowDisk final : public Background {
 public:
  explicit SlowDisk(const VirtualClock& clock) : clock_(clock) {}
  void post(std::function<void()> work, std::function<void()> done) override {
    const double begin = jobs_.empty() ? clock_.now() : jobs_.back().due;
    jobs_.push_back({begin + kSlow, std::move(work), std::move(done)});
  }
  void serve() override {
    while (!jobs_.empty() && jobs_.front().due <= clock_.now()) {
      const Job job = std::move(jobs_.front());
      jobs_.pop_front();
      job.work();
      job.done();
    }
  }

 private:
  struct Job {
    double due;
    std::function<void()> work, done;
  };
  const VirtualClock& clock_;
  std::deque<Job> jobs_;
};

class OnSlowDisk : public ServiceLoop {
 protected:
  std::unique_ptr<Background> disk() override { return std::make_unique<SlowDisk>(clock_); }
  static json calibration() {
    json parameters = json::object();
    for (const auto& [name, value] : kNew.items())
      parameters[name] = {{"value", value}, {"std", 1e-5}, {"unit", "m"}};
    return {{"format", "odomcalib-calibration/1"}, {"verdict", "accepted"}, {"parameters", parameters}};
  }
  void begin_apply(TestClient& writer) {
    acquire();
    writer.call("Apply", {{"lease", lease_}, {"calibration", calibration()}, {"of_this_robot", true}});
  }
  [[nodiscard]] bool active() const { return std::filesystem::exists(folder_ / "state" / "active.json"); }
  [[nodiscard]] std::optional<JournalRecord> journaled() const {
    return Journal::open(folder_ / "state" / "journal").value().last();
  }
  sim::DriveNode& node() { return robot_->node(); }
};

TEST_F(OnSlowDisk, a_write_back_ends_committed_with_lease_and_heartbeat_kept) {
  TestClient writer(folder_ / "control");
  begin_apply(writer);
  bool operational = true;
  std::optional<control::Reply> reply;
  const double begin = clock_.time;
  ASSERT_TRUE(run_until(
      [&] {
        operational = operational && node().nmt_state() == sim::NmtState::operational;
        return (reply = writer.reply()).has_value();
      },
      30.0))
      << service_->status_json();
  EXPECT_EQ(reply->error, "") << reply->parameters;
  EXPECT_GT(clock_.time - begin, 8 * kSlow) << "announced, six records, history";
  EXPECT_TRUE(operational) << "the drive missed our heartbeat";
  EXPECT_EQ(node().geometry_stored(), kNewRaw);
  EXPECT_EQ(node().store_count(), 1U);
  EXPECT_TRUE(active());
  EXPECT_EQ(status()["operator_needed"], false);
  client_->call("Renew", {{"lease", lease_}});
  EXPECT_EQ(wait_reply(*client_, 0.1).error, "") << "the lease lapsed";
}

TEST_F(OnSlowDisk, no_value_is_written_before_its_record_is_there) {
  TestClient writer(folder_ / "control");
  begin_apply(writer);
  while (clock_.time < 1000.0 && node().geometry_in_ram() == kOldRaw) step();
  ASSERT_TRUE(journaled());
  EXPECT_EQ(journaled()->state, JournalState::write);
  while (clock_.time < 1000.0 && node().store_count() == 0) step();
  EXPECT_EQ(journaled()->state, JournalState::store_begin);
  EXPECT_EQ(wait_reply(writer, 30.0).error, "");
  EXPECT_EQ(journaled()->state, JournalState::commit);
}

TEST_F(OnSlowDisk, a_second_write_back_waits_for_the_whole_end_of_the_first) {
  TestClient writer(folder_ / "control"), other(folder_ / "control");
  begin_apply(writer);
  ASSERT_TRUE(run_until([&] { return node().store_count() == 1; }, 30.0));
  run(2.1 * kSlow);  // store_ok and commit are there, history and calibration are not
  ASSERT_EQ(journaled()->state, JournalState::commit);
  ASSERT_FALSE(active());
  EXPECT_TRUE(service_->writing());
  other.call("SetParameters", {{"lease", lease_}, {"values", kNew}});
  EXPECT_EQ(wait_reply(other, 0.1).error, "org.odomcalib.Calibration.Busy");
  EXPECT_EQ(wait_reply(writer, 3.0).error, "");
  EXPECT_TRUE(active());
  EXPECT_FALSE(service_->writing());
}

TEST_F(OnSlowDisk, a_daemon_that_ends_before_the_calibration_is_announced_writes_nothing) {
  TestClient writer(folder_ / "control");
  begin_apply(writer);
  run(0.5 * kSlow);
  service_->stop_all("told to end");
  EXPECT_EQ(wait_reply(writer, 0.1).error, "org.odomcalib.Calibration.Cancelled");
  run(3.0 * kSlow);
  EXPECT_EQ(node().geometry_in_ram(), kOldRaw);
  EXPECT_FALSE(journaled());
}

TEST_F(OnSlowDisk, a_drive_that_loses_its_power_while_the_disk_is_busy_ends_old_and_free_to_move) {
  TestClient writer(folder_ / "control");
  begin_apply(writer);
  ASSERT_TRUE(run_until([&] { return node().geometry_in_ram() == kNewRaw; }, 30.0));
  run(0.5 * kSlow);
  robot_->reset_drive();
  const auto reply = wait_reply(writer, 60.0);
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.WriteFailed") << reply.parameters;
  run(15.0 * kSlow);
  EXPECT_EQ(status()["operator_needed"], false);
  EXPECT_EQ(node().geometry_in_ram(), kOldRaw);
  EXPECT_EQ(node().geometry_stored(), kOldRaw);
  EXPECT_FALSE(active());
}

}  // namespace
}  // namespace odomcalib::slow_disk_test
