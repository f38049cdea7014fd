// A write-back that was interrupted, and what the service makes of it at its next start: the real driver on
// the simulated drive, in virtual time.
#include <fstream>

#include "daemon/writeback/history.hpp"
#include "daemon/writeback/journal.hpp"
#include "proto/file_bytes.hpp"
#include "tests/integration/service_loop.hpp"

namespace odomcalib::recovery_test {
namespace {

using Values = std::map<std::string, double>;
using Raw = std::array<std::uint32_t, 3>;

const Values kOld{{"left_wheel_diameter", 0.15}, {"right_wheel_diameter", 0.15}, {"track_width", 0.4}};
const Values kNew{{"left_wheel_diameter", 0.1512}, {"right_wheel_diameter", 0.1498}, {"track_width", 0.4033}};
constexpr Raw kOldRaw{150000, 150000, 400000}, kNewRaw{151200, 149800, 403300},
    kMixed{150000, 149800, 400000};

class Restarted : public ServiceLoop {
 protected:
  // The daemon dies, the journal ends like this, the drive holds that.
  void die(const JournalRecord& record, const Raw& ram) {
    end_service();
    ASSERT_TRUE(Journal::open(journal_path()).value().append(record).ok());
    for (std::uint8_t i = 0; i < 3; ++i)
      robot_->node().dictionary().set({0x2100, static_cast<std::uint8_t>(i + 1)}, ram[i]);
    for (int i = 0; i < 500; ++i) robot_->step(0.002);
    clock_.time += 1.0;
  }
  void restart() {
    end_service();
    start_service();
  }
  bool settled(bool operator_needed) {
    return run_until(
        [&] {
          if (++steps_ % 25 != 0) return false;
          const json now = status();
          return now["controller"]["state"] == "disabled" && now["state"] == "idle" &&
                 now["robot"]["in_controller"] == true && now["operator_needed"] == operator_needed;
        },
        10.0);
  }
  static JournalRecord record_of(JournalState state) {
    JournalRecord record;
    record.state = state;
    record.label = "apply";
    record.before = kOld;
    record.after = kNew;
    record.store_begun = state == JournalState::store_begin || state == JournalState::needs_operator;
    return record;
  }
  control::Reply call(const std::string& method, json parameters) {
    if (lease_.empty()) acquire();
    parameters["lease"] = lease_;
    return ask(method, parameters, 30.0);
  }
  [[nodiscard]] std::filesystem::path journal_path() const { return folder_ / "state" / "journal"; }
  [[nodiscard]] std::vector<std::string> journaled() const {
    std::vector<std::string> states;
    std::ifstream file(journal_path());
    for (std::string line;
         std::getline(file, line) && line.front() != '\0';)  // behind it is what is reserved
      states.push_back(name_of(from_line(line).value_or(JournalRecord{}).state));
    return states;
  }
  [[nodiscard]] std::vector<HistoryEntry> history() const {
    return History(folder_ / "state" / "history").entries();
  }
  sim::DriveNode& node() { return robot_->node(); }
};

TEST_F(Restarted, a_mixed_drive_gets_its_old_values_back_at_the_first_try) {
  die(record_of(JournalState::write), kMixed);
  restart();
  ASSERT_TRUE(settled(false)) << service_->status_json();
  EXPECT_EQ(node().geometry_in_ram(), kOldRaw);
  EXPECT_EQ(node().geometry_stored(), kOldRaw);
  EXPECT_EQ(node().store_count(), 0U);
  EXPECT_EQ(journaled(), (std::vector<std::string>{"write", "rollback", "rolled_back"}));
  ASSERT_EQ(history().size(), 1U);
  EXPECT_EQ(history()[0].outcome, "rolled_back");
  EXPECT_EQ(history()[0].device, "0xfee/0xd15/4242");
}

TEST_F(Restarted, a_read_that_fails_is_repeated_and_changes_nothing) {
  die(record_of(JournalState::write), kMixed);
  node().sdo_faults().abort_on_read[{0x2100, 2}] = 0x06060000;
  restart();
  run(8.0);
  EXPECT_EQ(status()["operator_needed"], true);
  EXPECT_EQ(journaled(), (std::vector<std::string>{"write"}));
  EXPECT_EQ(node().geometry_in_ram(), kMixed);
  node().sdo_faults().abort_on_read.clear();
  ASSERT_TRUE(settled(false)) << service_->status_json();
  EXPECT_EQ(node().geometry_in_ram(), kOldRaw);
  EXPECT_EQ(node().store_count(), 0U);
  EXPECT_EQ(history().size(), 1U);
}

TEST_F(Restarted, a_recovery_does_not_begin_while_the_wheels_turn) {
  die(record_of(JournalState::write), kMixed);
  restart();
  for (int i = 0; i < 1500; ++i) {
    robot_->shift_counts(3, 3);  // somebody pushes the robot
    step();
  }
  EXPECT_EQ(journaled(), (std::vector<std::string>{"write"}));
  EXPECT_EQ(node().geometry_in_ram(), kMixed);
  ASSERT_TRUE(settled(false)) << service_->status_json();
  EXPECT_EQ(node().geometry_in_ram(), kOldRaw);
}

TEST_F(Restarted, a_recovery_that_fails_stores_once_and_is_told_once) {
  die(record_of(JournalState::needs_operator), kMixed);
  node().faults.store_fails = true;
  restart();
  run(30.0);
  EXPECT_EQ(status()["operator_needed"], true);
  EXPECT_EQ(history().size(), 1U);
  const auto records = journaled().size();
  EXPECT_EQ(records, 3U);  // needs_operator, rollback, needs_operator
  const json check = json::parse(call("Check", json::object()).parameters)["checks"];
  EXPECT_NE(check.dump().find("store"), std::string::npos) << check;
  // Once more after a restart, but nothing new for the history.
  restart();
  run(5.0);
  EXPECT_EQ(journaled().size(), records + 2);
  EXPECT_EQ(history().size(), 1U);
  // And once more when the controller was away: now it can store.
  node().faults.store_fails = false;
  robot_->reset_drive();
  ASSERT_TRUE(settled(false)) << service_->status_json();
  EXPECT_EQ(node().geometry_stored(), kOldRaw);
}

TEST_F(Restarted, a_mixture_is_not_made_legal_by_an_apply_that_fails) {
  die(record_of(JournalState::needs_operator), kMixed);
  node().faults.store_fails = true;
  restart();
  run(5.0);
  ASSERT_EQ(status()["operator_needed"], true);
  node().dictionary().set({0x2100, 2}, kMixed[1]);
  const auto reply = call("SetParameters", {{"values", kNew}});
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.WriteUnknown");
  EXPECT_EQ(status()["operator_needed"], true);
  EXPECT_NE(call("SetParameters", {{"values", {{"track_width", 0.4033}}}}).error, "");
  EXPECT_EQ(Journal::open(journal_path()).value().unfinished()->before, kOld);
  node().faults.store_fails = false;
  run(0.5);  // it is read what the drive holds now
  EXPECT_EQ(call("Rollback", json::object()).error, "");
  EXPECT_EQ(status()["operator_needed"], false);
  EXPECT_EQ(node().geometry_stored(), kOldRaw);
  EXPECT_EQ(node().geometry_in_ram(), kOldRaw);
}

TEST_F(Restarted, the_controller_of_another_robot_is_not_written) {
  JournalRecord record = record_of(JournalState::store_begin);
  record.device = "0xfee/0xd15/7";
  die(record, kNewRaw);
  restart();
  run(6.0);
  EXPECT_EQ(status()["operator_needed"], true);
  EXPECT_EQ(node().store_count(), 0U);
  EXPECT_EQ(node().geometry_in_ram(), kNewRaw);
  EXPECT_EQ(journaled(), (std::vector<std::string>{"store_begin"}));
  const json checks = json::parse(call("Check", json::object()).parameters)["checks"];
  EXPECT_NE(checks.dump().find("this controller is"), std::string::npos) << checks;
  EXPECT_EQ(call("SetParameters", {{"values", kOld}}).error, "");
  EXPECT_EQ(status()["operator_needed"], false);
}

TEST_F(Restarted, values_are_read_again_when_the_controller_was_away) {
  node().dictionary().set({0x2100, 3}, 410000);  // in RAM only
  restart();
  ASSERT_TRUE(settled(false));
  EXPECT_NEAR(status()["robot"]["track_width"].get<double>(), 0.41, 1e-9);
  robot_->reset_drive();
  run(3.0);
  EXPECT_NEAR(status()["robot"]["track_width"].get<double>(), 0.40, 1e-9);
}

/// The daemon falls silent for so long that the drive leaves operational, so many seconds after a write-back
/// was asked for.
class SilentInBetween : public Restarted, public testing::WithParamInterface<double> {
 protected:
  void fall_silent() {
    for (double left = 0.3; left > 0.0; left -= 0.002) {
      robot_->step(0.002);
      clock_.time += 0.002;
    }
    ASSERT_EQ(node().nmt_state(), sim::NmtState::pre_operational);
  }
};

TEST_P(SilentInBetween, whatever_it_has_written_by_then_ends_wholly_old_or_wholly_new) {
  acquire();
  renewing_ = false;
  TestClient writer(folder_ / "control");
  writer.call("SetParameters", {{"lease", lease_}, {"values", kNew}});
  run(GetParam());
  fall_silent();
  const auto reply = wait_reply(writer, 20.0);
  const bool fresh = reply.error.empty();
  EXPECT_NE(reply.error, "org.odomcalib.Calibration.WriteUnknown") << reply.parameters;
  ASSERT_TRUE(settled(false)) << service_->status_json();
  EXPECT_EQ(node().geometry_in_ram(), fresh ? kNewRaw : kOldRaw);
  EXPECT_EQ(node().geometry_stored(), fresh ? kNewRaw : kOldRaw);
  EXPECT_FALSE(Journal::open(journal_path()).value().unfinished());
}

INSTANTIATE_TEST_SUITE_P(Service, SilentInBetween,
                         testing::Values(0.0, 0.004, 0.008, 0.012, 0.016, 0.020, 0.024, 0.028, 0.032, 0.036,
                                         0.040, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1, 0.12, 0.14));

TEST_F(Restarted, a_recovery_is_tried_again_whenever_the_drive_was_configured_anew) {
  die(record_of(JournalState::needs_operator), kMixed);
  node().faults.store_fails = true;
  restart();
  run(5.0);
  ASSERT_EQ(status()["operator_needed"], true);
  node().faults.store_fails = false;
  run(5.0);
  ASSERT_EQ(status()["operator_needed"], true) << "one that stays configured is only read";
  robot_->inject(sim::make_frame(0x701, {0x7F}));  // out of operational, never silent
  ASSERT_TRUE(settled(false)) << service_->status_json();
  EXPECT_EQ(node().geometry_stored(), kOldRaw);
}

TEST_F(Restarted, a_recovery_that_goes_on_failing_is_tried_less_and_less_often) {
  die(record_of(JournalState::needs_operator), kMixed);
  node().faults.store_fails = true;
  restart();
  for (int i = 0; i < 60; ++i) {
    run(1.0);
    robot_->inject(sim::make_frame(0x701, {0x7F}));
  }
  const auto records = journaled();
  const auto tries = std::count(records.begin(), records.end(), "rollback");
  EXPECT_GE(tries, 3);
  EXPECT_LE(tries, 6) << "60 s are 2 + 4 + 8 + 16 + 30";
  EXPECT_EQ(history().size(), 1U);
}

class Applied : public Restarted {
 protected:
  static json calibration(const Values& values) {
    json parameters = json::object();
    for (const auto& [name, value] : values)
      parameters[name] = {{"value", value}, {"std", 1e-5}, {"unit", "m"}};
    return {{"format", "odomcalib-calibration/1"}, {"verdict", "accepted"}, {"parameters", parameters}};
  }
  [[nodiscard]] std::filesystem::path active() const { return folder_ / "state" / "active.json"; }
};

TEST_F(Applied, a_recovery_that_commits_puts_the_calibration_in_force) {
  ASSERT_EQ(call("Apply", {{"calibration", calibration(kNew)}, {"of_this_robot", true}}).error, "");
  const std::string applied = read_file_bytes(active()).value();
  // As if the daemon had died before the last record.
  JournalRecord record = record_of(JournalState::store_ok);
  record.calibration = sha256_hex(applied);
  std::filesystem::remove(active());
  die(record, kNewRaw);
  restart();
  ASSERT_TRUE(settled(false));
  EXPECT_EQ(read_file_bytes(active()).value(), applied);
  EXPECT_EQ(status()["calibrated"], true);
  EXPECT_EQ(history()[0].outcome, "committed");
  EXPECT_TRUE(history()[0].calibration.has_value());
}

TEST_F(Applied, a_calibration_is_kept_with_its_evidence_but_without_the_points_of_its_figures) {
  json whole = calibration(kNew);
  whole["picture"] = {{"paths", json::array()}};
  whole["drive_errors"] = json::array();
  whole["made_elsewhere"] = {{"by", "hand"}};
  ASSERT_EQ(call("Apply", {{"calibration", whole}, {"of_this_robot", true}}).error, "");
  const std::string in_history = history()[0].calibration.value_or("{}");
  for (const std::string& text : {read_file_bytes(active()).value(), in_history}) {
    const json kept = json::parse(text);
    EXPECT_FALSE(kept.contains("picture"));
    EXPECT_EQ(kept.value("drive_errors", json()), json::array());
    EXPECT_EQ(kept.value("made_elsewhere", json()), whole["made_elsewhere"]);
  }
}

TEST_F(Applied, a_commit_that_was_the_last_thing_done_is_settled_at_the_next_start) {
  ASSERT_EQ(call("Apply", {{"calibration", calibration(kNew)}, {"of_this_robot", true}}).error, "");
  const std::string applied = read_file_bytes(active()).value();
  end_service();
  std::filesystem::remove(active());
  restart();
  EXPECT_EQ(read_file_bytes(active()).value(), applied);
}

TEST_F(Applied, an_apply_whose_calibration_cannot_be_put_in_force_says_so) {
  std::filesystem::create_directories(active() / "in the way");
  const auto reply = call("Apply", {{"calibration", calibration(kNew)}, {"of_this_robot", true}});
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.Io");
  EXPECT_NE(reply.parameters.find("the values are in the controller"), std::string::npos) << reply.parameters;
  EXPECT_EQ(node().geometry_stored(), kNewRaw);
}

TEST_F(Applied, rollback_without_an_id_undoes_the_newest_that_was_committed) {
  ASSERT_EQ(call("Apply", {{"calibration", calibration(kNew)}, {"of_this_robot", true}}).error, "");
  JournalRecord record = record_of(JournalState::write);
  record.before = kNew;
  record.after["track_width"] = 0.41;
  die(record, kNewRaw);
  restart();
  ASSERT_TRUE(settled(false));
  ASSERT_EQ(history()[0].outcome, "rolled_back");
  ASSERT_EQ(call("Rollback", json::object()).error, "");
  EXPECT_EQ(node().geometry_stored(), kOldRaw);
  EXPECT_FALSE(std::filesystem::exists(active()));
}

TEST_F(Applied, rollback_to_the_values_of_another_controller_is_refused_by_name) {
  History others(folder_ / "state" / "history");
  for (const char* device : {"0xfee/0xd15/4243", ""}) {
    HistoryEntry entry;
    entry.action = "apply";
    entry.outcome = "committed";
    entry.before = entry.after = kNew;
    entry.device = device;
    entry = others.numbered(entry);
    ASSERT_TRUE(others.write(entry).ok());
    others.keep(entry);
  }
  restart();
  ASSERT_TRUE(settled(false));
  const auto reply = call("Rollback", {{"id", "0001"}});
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.Refused");
  for (const char* name : {"0xfee/0xd15/4243", "0xfee/0xd15/4242"})
    EXPECT_NE(reply.parameters.find(name), std::string::npos) << reply.parameters;
  EXPECT_EQ(node().geometry_stored(), kOldRaw);
  EXPECT_EQ(call("Rollback", {{"id", "0002"}}).error, "") << "of a controller that nobody named";
  EXPECT_EQ(node().geometry_stored(), kNewRaw);
}

}  // namespace
}  // namespace odomcalib::recovery_test
