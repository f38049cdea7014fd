// Conditions that must hold before the robot moves or values are written, each violated alone: nothing
// happens, and the client is told why.
#include "daemon/routines/plans.hpp"
#include "daemon/service/motion_gate.hpp"
#include "tests/integration/service_loop.hpp"

namespace odomcalib::gate_test {
namespace {

class Gate : public ServiceLoop {
 protected:
  control::Reply call(const std::string& method, json parameters) {
    if (lease_.empty()) acquire();
    if (!parameters.contains("lease")) parameters["lease"] = lease_;
    return ask(method, parameters, 20.0);
  }
  void expect_refused(const control::Reply& reply, const std::string& error, const std::string& said) {
    EXPECT_EQ(reply.error, "org.odomcalib.Calibration." + error) << reply.parameters;
    EXPECT_NE(reply.parameters.find(said), std::string::npos) << reply.parameters;
    run(1.0);
    EXPECT_LT(robot_->fastest_rim(), 1e-6);
    EXPECT_EQ(robot_->node().store_count(), 0U);
    EXPECT_EQ(robot_->node().geometry_in_ram(), (std::array<std::uint32_t, 3>{150000, 150000, 400000}));
  }
  static json straight() { return {{"distance", 0.5}}; }
  static json track(double metres) { return {{"values", {{"track_width", metres}}}}; }
  static json calibration(const std::string& verdict) {
    return {{"calibration",
             {{"format", "odomcalib-calibration/1"},
              {"verdict", verdict},
              {"parameters", {{"track_width", {{"value", 0.4033}, {"std", 1e-5}, {"unit", "m"}}}}}}},
            {"of_this_robot", true}};
  }
};

TEST_F(Gate, lets_pass_what_is_as_it_should_be) {
  EXPECT_EQ(call("Apply", calibration("accepted")).error, "");
  EXPECT_EQ(robot_->node().store_count(), 1U);
  EXPECT_EQ(call("Straight", straight()).error, "");
}

// Rule M18: who asks for more than there is is told, before the motion and after it.
TEST_F(Gate, names_the_limit_that_it_sets) {
  json parameters = straight();
  for (const bool dry_run : {true, false}) {
    parameters["dry_run"] = dry_run;
    parameters["speed"] = 0.5;
    const auto limited = [&] {
      return json::parse(call("Straight", parameters).parameters)["result"].value("limited", json());
    };
    EXPECT_NE(limited().dump().find("0.30 m/s instead of 0.50"), std::string::npos);
    parameters["speed"] = 0.2;
    EXPECT_EQ(limited(), json::array());
  }
}

TEST_F(Gate, says_what_a_motion_would_be_and_learns_how_the_drive_brakes) {
  const auto plan = [this] {
    return json::parse(call("Straight", {{"distance", 1.0}, {"dry_run", true}}).parameters)["result"];
  };
  const json before = plan();
  EXPECT_EQ(before["first_motion"], true);
  EXPECT_NEAR(before["clear_space"]["ahead"]["needed"].get<double>(), 1.55, 0.02);
  EXPECT_GT(before["clear_space"]["ahead"]["nearest"].get<double>(), 1.55);
  ASSERT_EQ(call("Straight", straight()).error, "");
  const json after = plan();
  EXPECT_EQ(after["first_motion"], false);
  // The simulated motors follow their command some 85 ms late: 0.3 m/s times that.
  EXPECT_NEAR(after["stopping_distance"].get<double>() - before["stopping_distance"].get<double>(), 0.025,
              0.015);
}

TEST(TooLong, is_a_plan_of_more_than_half_an_hour) {
  routines::Plan plan = routines::spin_plan({});
  const routines::Move turn = plan.moves.at(0);
  const double one = routines::expected_duration(turn, plan.limits);
  ASSERT_LT(one, 60.0);
  plan.moves.assign(static_cast<std::size_t>(1800.0 / one), turn);
  EXPECT_FALSE(too_long(plan));
  plan.moves.push_back(turn);
  ASSERT_TRUE(too_long(plan));
  EXPECT_EQ(too_long(plan)->code, ErrorCode::usage);
}

/// A length in the configuration, where the controller holds 0.150, 0.150 and 0.400 m: 15 % either way.
struct Nominal {
  const char* name;
  double RobotDescription::*length;
  double value;
  bool moves;
};

class OtherLengths : public ServiceLoop, public testing::WithParamInterface<Nominal> {
 protected:
  void adjust(Config& config) override { config.robot.*GetParam().length = GetParam().value; }
};

TEST_P(OtherLengths, forbid_motion_beyond_15_percent) {
  const auto reply = ask("Straight", {{"distance", 0.5}, {"dry_run", true}}, 2.0);
  EXPECT_EQ(reply.error.empty(), GetParam().moves) << reply.parameters;
  if (!GetParam().moves) {
    EXPECT_NE(reply.parameters.find("the configuration says"), std::string::npos) << reply.parameters;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Config, OtherLengths,
    testing::Values(Nominal{"left_is_shorter", &RobotDescription::left_wheel_diameter, 0.1765, false},
                    Nominal{"left_is_a_little_shorter", &RobotDescription::left_wheel_diameter, 0.1760, true},
                    Nominal{"left_is_longer", &RobotDescription::left_wheel_diameter, 0.1300, false},
                    Nominal{"left_is_a_little_longer", &RobotDescription::left_wheel_diameter, 0.1310, true},
                    Nominal{"right_is_shorter", &RobotDescription::right_wheel_diameter, 0.1765, false},
                    Nominal{"right_is_a_little_longer", &RobotDescription::right_wheel_diameter, 0.1310,
                            true},
                    Nominal{"track_is_shorter", &RobotDescription::track_width, 0.4710, false},
                    Nominal{"track_is_a_little_shorter", &RobotDescription::track_width, 0.4700, true},
                    Nominal{"track_is_longer", &RobotDescription::track_width, 0.3470, false},
                    Nominal{"track_is_a_little_longer", &RobotDescription::track_width, 0.3490, true}),
    [](const auto& one) { return one.param.name; });

TEST_F(Gate, of_a_way_that_is_not_clear) {
  robot_->room().add_pillar({robot_->pose().x + 0.9, robot_->pose().y}, 0.08);
  run(1.0);
  expect_refused(call("Straight", straight()), "Refused", "nearer than");
}

TEST_F(Gate, of_a_lidar_that_says_nothing) {
  robot_->lidar_faults().frozen = true;
  run(1.0);
  expect_refused(call("Straight", straight()), "Device", "repeats the same scan");
}

// The driver refuses to enable its axes too, later: who asks is told at once.
TEST_F(Gate, of_a_controller_that_would_not_stop_by_itself) {
  robot_->node().sdo_faults().abort_on_write[{0x1016, 1}] = 0x06090030;
  robot_->reset_drive();
  run(1.0);
  ASSERT_TRUE(run_until([this] { return ready(); }, 10.0)) << service_->status_json();
  acquire();
  TestClient mover(folder_ / "control");
  mover.call("Straight", {{"lease", lease_}, {"distance", 0.5}});
  const auto reply = wait_reply(mover, 0.1);
  expect_refused(reply, "Device", "would not stop by itself");
  EXPECT_NE(json::parse(reply.parameters).value("remedy", "").find("a profile with a watchdog"),
            std::string::npos);
}

TEST_F(Gate, of_values_without_a_lease) {
  json parameters = track(0.4033);
  parameters["lease"] = "none";
  expect_refused(call("SetParameters", parameters), "NotPermitted", "lease");
  parameters = calibration("accepted");
  parameters["lease"] = "none";
  expect_refused(call("Apply", parameters), "NotPermitted", "lease");
  expect_refused(call("Rollback", {{"lease", "none"}}), "NotPermitted", "lease");
}

TEST_F(Gate, of_values_that_are_more_than_15_percent_away) {
  expect_refused(call("SetParameters", track(0.4 * 1.16)), "Refused", "15 %");
  expect_refused(call("SetParameters", track(0.4 * 0.84)), "Refused", "15 %");
  EXPECT_EQ(call("SetParameters", track(0.4 * 1.14)).error, "");
}

TEST_F(Gate, of_a_calibration_that_was_refused) {
  expect_refused(call("Apply", calibration("refused")), "Refused", "quality gate");
}

class Named : public Gate {
 protected:
  void adjust(Config& config) override { config.robot.robot_id = "robot-A"; }
  static json calibration_of(const char* robot) {
    json made = calibration("accepted");
    if (robot != nullptr) made["calibration"]["robot"] = {{"robot_id", robot}};
    return made;
  }
};

TEST_F(Named, a_calibration_of_another_robot_or_of_none_is_refused) {
  expect_refused(call("Apply", calibration_of("robot-B")), "Refused", "robot-B");
  expect_refused(call("Apply", calibration_of(nullptr)), "Refused", "without a name");
  EXPECT_EQ(call("Apply", calibration_of("robot-A")).error, "");
}

TEST_F(Gate, of_values_for_a_controller_in_fault) {
  robot_->emergency(0x2310);
  ASSERT_TRUE(run_until([this] { return status()["controller"]["state"] == "fault"; }, 2.0));
  expect_refused(call("SetParameters", track(0.4033)), "Device", "fault");
}

// The wheels still turn when the motion has been answered.
TEST_F(Gate, lets_values_pass_right_after_a_motion) {
  acquire();
  Mover mover(*this);
  ASSERT_EQ(call("Stop", json::object()).error, "");
  ASSERT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.Cancelled");
  EXPECT_NE(status()["controller"]["state"], "disabled") << "nothing to wait for: this tests nothing";
  EXPECT_EQ(call("SetParameters", track(0.4033)).error, "");
  EXPECT_EQ(robot_->node().geometry_stored()[2], 403300U);
  EXPECT_EQ(robot_->node().store_count(), 1U);
}

// A request that was allowed is checked again when the axes have come to rest.
TEST_F(Gate, of_values_for_a_controller_that_fails_while_they_wait) {
  acquire();
  Mover mover(*this);
  ASSERT_EQ(call("Stop", json::object()).error, "");
  ASSERT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.Cancelled");
  ASSERT_NE(status()["controller"]["state"], "disabled") << "nothing to wait for: this tests nothing";
  TestClient writer(folder_ / "control");
  json parameters = track(0.4033);
  parameters["lease"] = lease_;
  writer.call("SetParameters", parameters);
  run(0.02);
  robot_->emergency(0x2310);
  expect_refused(wait_reply(writer, 3.0), "Device", "fault");
}

TEST_F(Gate, of_values_while_the_robot_moves) {
  acquire();
  Mover mover(*this);
  TestClient writer(folder_ / "control");
  json parameters = track(0.4033);
  parameters["lease"] = lease_;
  writer.call("SetParameters", parameters);
  EXPECT_EQ(wait_reply(writer, 0.5).error, "org.odomcalib.Calibration.Busy");
  EXPECT_EQ(robot_->node().geometry_in_ram()[2], 400000U);
}

// Somebody pushes the robot: what the wheels have turned belongs to the values with which it was measured.
TEST_F(Gate, of_values_waits_for_wheels_that_turn) {
  acquire();
  TestClient writer(folder_ / "control");
  json parameters = track(0.4033);
  parameters["lease"] = lease_;
  writer.call("SetParameters", parameters);
  std::optional<control::Reply> reply;
  std::int64_t pushed = 0;
  run_until(
      [&] {
        robot_->shift_counts(++pushed % 2 == 0 ? 3 : 2, 2);
        return (reply = writer.reply()).has_value();
      },
      1.5);
  EXPECT_FALSE(reply && reply->error.empty()) << "written while the wheels turned";
  EXPECT_EQ(robot_->node().geometry_in_ram()[2], 400000U);
}

TEST_F(Gate, of_a_robot_whose_values_nobody_knows_lets_nothing_move) {
  robot_->node().faults.store_fails = true;
  EXPECT_EQ(call("SetParameters", track(0.4033)).error, "org.odomcalib.Calibration.WriteUnknown");
  ASSERT_EQ(status()["operator_needed"], true);
  ASSERT_TRUE(run_until([this] { return ready(); }, 10.0)) << service_->status_json();
  const auto reply = call("Straight", straight());
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.WriteUnknown") << reply.parameters;
  run(1.0);
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
}

class CountedDown : public Gate {
 protected:
  void adjust(Config& config) override { config.countdown = 3.0; }
};

TEST_F(CountedDown, a_motion_begins_three_seconds_after_it_was_asked_for) {
  acquire();
  TestClient mover(folder_ / "control");
  mover.call("Straight", {{"lease", lease_}, {"distance", 0.5}});
  EXPECT_FALSE(run_until([this] { return robot_->fastest_rim() > 1e-3; }, 2.9));
  EXPECT_TRUE(run_until([this] { return robot_->fastest_rim() > 0.1; }, 5.0)) << service_->status_json();
}

}  // namespace
}  // namespace odomcalib::gate_test
