// New values that wait in the controller's RAM while a motion proves them: they are stored when that is asked
// for, and in every other case the old ones come back. The real driver on the simulated drive, in virtual
// time.
#include "daemon/writeback/calibration_in_force.hpp"
#include "daemon/writeback/history.hpp"
#include "daemon/writeback/journal.hpp"
#include "proto/file_bytes.hpp"
#include "tests/integration/service_loop.hpp"

namespace odomcalib::proof_test {
namespace {

using Raw = std::array<std::uint32_t, 3>;
constexpr Raw kOldRaw{150000, 150000, 400000}, kNewRaw{150000, 150000, 403300};

class ServiceProof : public ServiceLoop {
 protected:
  void SetUp() override {
    ServiceLoop::SetUp();
    acquire();
    prover_ = std::make_unique<TestClient>(folder_ / "control");
  }
  void TearDown() override {
    prover_.reset();
    ServiceLoop::TearDown();
  }
  /// The lidar sees what odometry tells: no drive is worse than another.
  Calibrator calibrator() override {
    Calibrator functions;
    functions.match = [](const Scan&, const Scan&, const routines::Pose& guess, const auto&) {
      return std::optional(guess);
    };
    return functions;
  }
  void drive() {
    ASSERT_EQ(call("Straight", {{"distance", 0.5}}).error, "");
    ASSERT_EQ(call("Spin", {{"turns", 0.5}}).error, "");
  }
  control::Reply call(TestClient& caller, const std::string& method, json parameters) {
    parameters["lease"] = lease_;
    caller.call(method, parameters);
    return wait_reply(caller, 60.0);
  }
  control::Reply call(const std::string& method, const json& parameters = json::object()) {
    TestClient caller(folder_ / "control");
    return call(caller, method, parameters);
  }
  void write_unproven() {
    const json body = {{"format", "odomcalib-calibration/1"},
                       {"verdict", "accepted"},
                       {"parameters", {{"track_width", {{"value", 0.4033}, {"std", 1e-5}, {"unit", "m"}}}}}};
    const auto reply =
        call(*prover_, "Apply", {{"calibration", body}, {"prove", true}, {"of_this_robot", true}});
    ASSERT_EQ(reply.error, "") << reply.parameters;
    EXPECT_EQ(json::parse(reply.parameters)["result"]["outcome"], "proving");
    EXPECT_TRUE(holds_new_unstored());
  }
  [[nodiscard]] bool holds_new_unstored() {
    return robot_->node().geometry_in_ram() == kNewRaw && robot_->node().geometry_stored() == kOldRaw;
  }
  [[nodiscard]] bool holds_old() {
    return robot_->node().geometry_in_ram() == kOldRaw && robot_->node().geometry_stored() == kOldRaw &&
           robot_->node().store_count() == 0;
  }
  /// Whatever it was, it ends with the old values, never stored, and the robot may be used again.
  void expect_taken_back() {
    EXPECT_TRUE(run_until([this] { return holds_old() && ready(); }, 20.0)) << service_->status_json();
    EXPECT_NEAR(track_in_force(), 0.4, 1e-9);
    ASSERT_EQ(history().size(), 1U);
    EXPECT_EQ(history()[0].outcome, "rolled_back");
    EXPECT_EQ(status()["calibrated"], false);
  }
  /// Digest of a calibration as the history has it, whatever its layout.
  [[nodiscard]] static std::string digest_of(const std::string& text) {
    return sha256_hex(text_in_force(calibration_from_json(text, "history").value()));
  }
  [[nodiscard]] double track_in_force() const { return status()["robot"]["track_width"].get<double>(); }
  [[nodiscard]] std::vector<HistoryEntry> history() const {
    return History(folder_ / "state" / "history").entries();
  }

  std::unique_ptr<TestClient> prover_;
};

TEST_F(ServiceProof, new_values_are_driven_with_and_then_stored) {
  drive();
  write_unproven();
  EXPECT_NEAR(track_in_force(), 0.4033, 1e-9);
  EXPECT_TRUE(history().empty());
  EXPECT_EQ(status()["calibrated"], false);
  EXPECT_NE(service_->status_line().find("wait for their proof"), std::string::npos);
  drive();
  EXPECT_TRUE(holds_new_unstored());
  const auto stored = call("Store");
  EXPECT_EQ(stored.error, "") << stored.parameters;
  EXPECT_EQ(robot_->node().geometry_stored(), kNewRaw);
  EXPECT_EQ(robot_->node().store_count(), 1U);
  ASSERT_EQ(history().size(), 1U);
  const Provenance origin = history()[0].origin;
  EXPECT_TRUE(origin.trial.before && origin.trial.after) << "both drives";
  ASSERT_TRUE(history()[0].calibration);
  EXPECT_EQ(origin.calibration_sha256, digest_of(*history()[0].calibration));
  EXPECT_EQ(status()["calibrated"], true);
}

TEST_F(ServiceProof, what_is_discarded_leaves_the_old_values) {
  for (const char* method : {"Discard", "Rollback"}) {
    write_unproven();
    const auto reply = call(method);
    ASSERT_EQ(reply.error, "") << reply.parameters;
    const json result = json::parse(reply.parameters)["result"];
    EXPECT_EQ(result["outcome"], "committed");
    EXPECT_NEAR(result["after"]["track_width"].get<double>(), 0.4, 1e-9);
    EXPECT_TRUE(holds_old()) << method;
  }
  EXPECT_EQ(history().size(), 2U);
}

TEST_F(ServiceProof, what_was_driven_before_they_went_back_is_kept) {
  drive();
  write_unproven();
  drive();
  ASSERT_EQ(call("Discard").error, "");
  ASSERT_EQ(history().size(), 1U);
  EXPECT_TRUE(history()[0].origin.trial.before && history()[0].origin.trial.after);
  const json entries = json::parse(call("History").parameters)["entries"];
  EXPECT_GE(entries[0]["trial"]["after"]["full_turn_heading"].get<double>(), 0.0);
}

TEST_F(ServiceProof, the_values_go_with_the_connection_that_wrote_them) {
  write_unproven();
  prover_->hang_up();
  expect_taken_back();
}

TEST_F(ServiceProof, they_go_when_it_leaves_in_motion_but_not_under_the_robot) {
  write_unproven();
  Mover mover(*this);
  prover_->hang_up();
  run(0.1);
  EXPECT_TRUE(holds_new_unstored());
  mover.hang_up();
  expect_taken_back();
}

// A motion would reset the fault, with the values that were to go.
TEST_F(ServiceProof, nothing_moves_while_they_cannot_go) {
  write_unproven();
  robot_->emergency(0x2310);
  ASSERT_TRUE(run_until([this] { return status()["controller"]["state"] == "fault"; }, 2.0));
  EXPECT_EQ(call("Discard").error, "org.odomcalib.Calibration.Device");
  const auto refused = call("Spin", {{"turns", 0.25}});
  EXPECT_EQ(refused.error, "org.odomcalib.Calibration.Busy") << refused.parameters;
  EXPECT_NE(refused.parameters.find("taken back first"), std::string::npos) << refused.parameters;
  robot_->reset_drive();
  expect_taken_back();
}

TEST_F(ServiceProof, a_controller_that_was_away_is_not_driven_with_them) {
  write_unproven();
  robot_->reset_drive();
  run(1.0);
  expect_taken_back();
}

TEST_F(ServiceProof, they_do_not_outlive_the_daemon) {
  write_unproven();
  service_->stop_all("the daemon ends");
  EXPECT_TRUE(service_->writing());
  EXPECT_TRUE(run_until([this] { return !service_->writing(); }, 5.0));
  EXPECT_TRUE(holds_old());
}

TEST_F(ServiceProof, nor_a_daemon_that_was_killed) {
  JournalRecord record;
  record.state = JournalState::readback_ok;
  record.label = "apply";
  record.before = {{"track_width", 0.4}};
  record.after = {{"track_width", 0.4033}};
  record.unproven = true;
  prover_.reset();
  end_service();
  ASSERT_TRUE(Journal::open(folder_ / "state" / "journal").value().append(record).ok());
  robot_->node().dictionary().set({0x2100, 3}, 403300);
  start_service();
  expect_taken_back();
}

TEST_F(ServiceProof, they_do_not_wait_for_ever) {
  write_unproven();
  run(890.0);
  EXPECT_TRUE(holds_new_unstored());
  run(20.0);
  expect_taken_back();
}

TEST_F(ServiceProof, nothing_else_is_written_meanwhile) {
  write_unproven();
  const auto refused = call("SetParameters", {{"values", {{"track_width", 0.401}}}});
  EXPECT_EQ(refused.error, "org.odomcalib.Calibration.Busy") << refused.parameters;
  EXPECT_NE(refused.parameters.find("wait for their proof"), std::string::npos);
  EXPECT_TRUE(holds_new_unstored());
  EXPECT_EQ(call("Discard").error, "");
}

TEST_F(ServiceProof, nothing_is_stored_where_nothing_waits) {
  for (const char* method : {"Store", "Discard"})
    EXPECT_EQ(call(method).error, "org.odomcalib.Calibration.Refused") << method;
  EXPECT_TRUE(holds_old());
}

}  // namespace
}  // namespace odomcalib::proof_test
