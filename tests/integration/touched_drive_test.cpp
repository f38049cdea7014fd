// Another program changes the drive while the robot stands: on a bus that shows it, and on one that does not.
// It is read again before it moves and before anything is written to it, and what differs is refused by name.
#include "tests/integration/service_loop.hpp"

namespace odomcalib::touched_drive_service_test {
namespace {

using Raw = std::array<std::uint32_t, 3>;
constexpr sim::ObjectKey kWatchdog{0x1016, 1}, kLeftDiameter{0x2100, 1};

class Touched : public ServiceLoop {
 protected:
  void SetUp() override {
    ServiceLoop::SetUp();
    acquire();
  }
  control::Reply call(const std::string& method, json parameters) {
    parameters["lease"] = lease_;
    return ask(method, parameters, 20.0);
  }
  control::Reply straight() { return call("Straight", {{"distance", 0.3}}); }
  control::Reply set(const json& values) { return call("SetParameters", {{"values", values}}); }
  /// Nobody sees how: another bus, or a moment in which nobody looked.
  void change(const sim::ObjectKey& object, std::uint32_t value) {
    robot_->node().dictionary().set(object, value);
  }
  /// By an SDO download of four bytes that everybody on the bus sees.
  void download(const sim::ObjectKey& object, std::uint32_t value) {
    const auto byte = [&](unsigned i) { return static_cast<int>(value >> (8U * i) & 0xFFU); };
    robot_->inject(sim::make_frame(0x601, {0x23, object.index & 0xFF, object.index >> 8, object.sub, byte(0),
                                           byte(1), byte(2), byte(3)}));
  }
  [[nodiscard]] std::uint32_t held(const sim::ObjectKey& object) {
    return robot_->node().dictionary().value(object);
  }
  void expect_refused(const control::Reply& reply, const std::vector<std::string>& named) {
    EXPECT_NE(reply.error, "") << reply.parameters;
    for (const std::string& text : named)
      EXPECT_NE(reply.parameters.find(text), std::string::npos) << text << ": " << reply.parameters;
    EXPECT_LT(farthest_, 1e-4) << "it moved";
    EXPECT_EQ(robot_->node().store_count(), 0U);
  }
  control::Reply ask_and_watch(const std::string& method, const json& parameters) {
    const sim::Pose begin = robot_->pose();
    auto reply = call(method, parameters);
    farthest_ = std::hypot(robot_->pose().x - begin.x, robot_->pose().y - begin.y);
    return reply;
  }
  bool set_up_again() {
    return run_until([this] { return ready() && held(kWatchdog) == watchdog_; }, 15.0);
  }
  json geometry_check() {
    const json all = json::parse(ask("Check", json::object(), 2.0).parameters)["checks"];
    for (const json& check : all)
      if (check["name"] == "geometry") return check;
    return {};
  }

  double farthest_ = 0.0;
  const std::uint32_t watchdog_ = 0x7F0000U + 200U;
};

TEST_F(Touched, a_drive_without_its_watchdog_is_not_driven_but_set_up_again) {
  ASSERT_EQ(held(kWatchdog), watchdog_);
  change(kWatchdog, 0);
  expect_refused(ask_and_watch("Straight", {{"distance", 0.3}}), {"1016:01", "reads 0", "another program"});
  ASSERT_TRUE(set_up_again()) << service_->status_json();
  EXPECT_EQ(straight().error, "");
}

TEST_F(Touched, nothing_is_written_to_it_before_that) {
  change(kWatchdog, 0);
  expect_refused(set({{"track_width", 0.4033}}), {"1016:01"});
  EXPECT_EQ(robot_->node().geometry_in_ram(), (Raw{150000, 150000, 400000}));
  ASSERT_TRUE(set_up_again());
  EXPECT_EQ(set({{"track_width", 0.4033}}).error, "");
}

TEST_F(Touched, whoever_has_just_changed_it_is_waited_for) {
  download(kWatchdog, 0);
  run(0.1);
  expect_refused(ask_and_watch("Straight", {{"distance", 0.3}}), {"another program"});
}

TEST_F(Touched, whoever_is_seen_to_change_it_is_followed_by_a_reading_that_nobody_asked_for) {
  download(kWatchdog, 0);
  run(0.1);
  EXPECT_EQ(geometry_check()["outcome"], "fail");
  EXPECT_NE(geometry_check().dump().find("another program"), std::string::npos) << geometry_check();
  ASSERT_TRUE(set_up_again()) << service_->status_json();
  EXPECT_EQ(geometry_check()["outcome"], "ok");
  EXPECT_EQ(straight().error, "");
}

TEST_F(Touched, its_mapping_is_compared_too) {
  change({0x1A00, 2}, 0x60640120);  // both counts of the left wheel
  expect_refused(ask_and_watch("Straight", {{"distance", 0.3}}), {"1A00:02"});
  ASSERT_TRUE(set_up_again());
  EXPECT_EQ(straight().error, "");
}

TEST_F(Touched, another_diameter_forbids_motion_and_any_write_that_would_keep_it) {
  for (const bool seen : {false, true}) {
    run(1.0);  // the drive takes nothing while it has torque
    seen ? download(kLeftDiameter, 300000) : change(kLeftDiameter, 300000);
    if (seen) run(3.0);
    const std::vector<std::string> named{"left_wheel_diameter", "0.3 m", "0.15 m", "2100:01"};
    expect_refused(ask_and_watch("Straight", {{"distance", 0.3}}), named);
    expect_refused(set({{"track_width", 0.4033}}), named);
    EXPECT_EQ(robot_->node().geometry_in_ram(), (Raw{300000, 150000, 400000}));
    EXPECT_EQ(geometry_check()["outcome"], "fail");
    // It is back by itself when the other one puts it back.
    seen ? download(kLeftDiameter, 150000) : change(kLeftDiameter, 150000);
    if (seen) run(3.0);
    EXPECT_EQ(straight().error, "");
    EXPECT_EQ(geometry_check()["outcome"], "ok");
  }
}

// A few per cent are a robot that nobody would miss, and odometry that is wrong by them.
TEST_F(Touched, a_little_is_no_less_and_is_put_back_or_kept_by_name) {
  for (const double chosen : {0.150, 0.152}) {
    change(kLeftDiameter, 152000);
    expect_refused(ask_and_watch("Straight", {{"distance", 0.3}}), {"left_wheel_diameter", "0.152 m"});
    EXPECT_EQ(set({{"left_wheel_diameter", chosen}}).error, "");
    EXPECT_EQ(robot_->node().geometry_stored()[0], static_cast<std::uint32_t>(std::lround(1e6 * chosen)));
    EXPECT_EQ(straight().error, "");
    EXPECT_EQ(robot_->node().store_count(), 1U);
    end_service();
    TearDown();  // the next one has a robot of its own
    SetUp();
  }
}

class Unproven : public Touched {
 protected:
  void SetUp() override {
    Touched::SetUp();
    ASSERT_EQ(set({{"left_wheel_diameter", 0.151}}).error, "");
    prover_ = std::make_unique<TestClient>(folder_ / "control");
    const json body = {{"format", "odomcalib-calibration/1"},
                       {"verdict", "accepted"},
                       {"parameters", {{"track_width", {{"value", 0.4033}, {"std", 1e-5}, {"unit", "m"}}}}}};
    ASSERT_EQ(prove("Apply", {{"calibration", body}, {"prove", true}, {"of_this_robot", true}}).error, "");
  }
  control::Reply prove(const std::string& method, json parameters) {
    parameters["lease"] = lease_;
    prover_->call(method, parameters);
    return wait_reply(*prover_, 20.0);
  }
  void TearDown() override {
    prover_.reset();
    Touched::TearDown();
  }
  std::unique_ptr<TestClient> prover_;
};

TEST_F(Unproven, a_part_of_the_values_leaves_the_others_known) {
  EXPECT_NEAR(status()["robot"]["track_width"].get<double>(), 0.4033, 1e-9);
  EXPECT_NEAR(status()["robot"]["left_wheel_diameter"].get<double>(), 0.151, 1e-9);
  EXPECT_EQ(prove("Straight", {{"distance", 0.3}}).error, "");
}

TEST_F(Unproven, values_are_not_stored_beside_what_another_program_wrote) {
  change(kLeftDiameter, 152000);
  EXPECT_NE(prove("Straight", {{"distance", 0.3}}).parameters.find("left_wheel_diameter"), std::string::npos);
  const auto refused = prove("Store", json::object());
  EXPECT_NE(refused.parameters.find("0.152 m"), std::string::npos) << refused.parameters;
  EXPECT_EQ(robot_->node().geometry_stored(), (Raw{151000, 150000, 400000}));
}

TEST_F(Touched, a_stop_while_it_is_read_ends_what_was_to_follow) {
  TestClient mover(folder_ / "control");
  mover.call("Straight", {{"distance", 0.3}, {"lease", lease_}});
  ASSERT_TRUE(run_until([this] { return status()["state"] == "reading the controller"; }, 1.0));
  EXPECT_EQ(ask("Stop", json::object(), 1.0).error, "");
  EXPECT_EQ(wait_reply(mover, 2.0).error, "org.odomcalib.Calibration.Cancelled");
  run(2.0);
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
  EXPECT_EQ(straight().error, "");
}

TEST_F(Touched, a_drive_that_does_not_answer_is_not_driven) {
  robot_->node().sdo_faults().silent = true;
  expect_refused(ask_and_watch("Straight", {{"distance", 0.3}}), {"no answer"});
}

}  // namespace
}  // namespace odomcalib::touched_drive_service_test
