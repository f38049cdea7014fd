// One motion, step by step, with a controller that takes note: each reason that ends it, alone, and the stop
// that follows however it ends.
#include "daemon/service/motion_run.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "daemon/routines/plans.hpp"

namespace odomcalib::motion_run_test {
namespace {

using drivers::ControllerState;

/// Follows every order at once; the call with a given number throws.
class NotingController : public drivers::Controller {
 public:
  mutable std::vector<std::string> calls;
  mutable int throws_at = -1;
  ControllerState now = ControllerState::disabled;

  void on_time(double) override {}
  std::vector<TickSample> take_ticks() override { return {}; }
  std::vector<drivers::ControllerEvent> take_events() override { return {}; }
  ControllerState state() const override {
    note("state");
    return now;
  }
  void enable(double) override {
    note("enable");
    now = ControllerState::enabled;
  }
  void disable(double) override {
    note("disable");
    now = ControllerState::disabled;
  }
  Result<void> command(double left, double right, double) override {
    note(left == 0.0 && right == 0.0 ? "zero" : "speed");
    return {};
  }
  void quick_stop(double) override { note("quick stop"); }
  double watchdog_time() const override { return 0.2; }
  bool at_rest() const override { return true; }
  Result<void> start_read_parameters(double) override { return {}; }
  Result<void> start_write_parameters(const std::vector<drivers::ParameterValue>&, double) override {
    return {};
  }
  Result<void> start_store(double) override { return {}; }
  std::optional<drivers::ParameterJobResult> take_job_result() override { return std::nullopt; }
  std::optional<drivers::Identity> identity() const override { return std::nullopt; }
  RobotDescription description() const override { return {}; }
  std::vector<drivers::Capability> capabilities() const override { return {}; }
  drivers::Counters counters() const override { return {}; }

  [[nodiscard]] bool stopped_last() const {
    const std::vector<std::string> wanted{"zero", "quick stop", "disable", "flush"};
    return calls.size() >= 4 && std::equal(wanted.begin(), wanted.end(), calls.end() - 4);
  }
  void note(const std::string& call) const {
    calls.push_back(call);
    if (throws_at-- == 0) throw std::runtime_error(call);
  }
};

class Motion : public testing::Test {
 protected:
  void begin(double countdown = 0.0) {
    run_.emplace(MotionRun::Options{.plan = routines::straight_plan({}),
                                    .geometry = {0.15, 0.15, 0.4},
                                    .countdown = countdown,
                                    .now = now_,
                                    .flush = [this] { controller_.calls.emplace_back("flush"); }},
                 controller_);
  }
  Situation good() const {
    Situation situation;
    situation.now = now_;
    situation.odometry = pose_;
    situation.lapsed.reset();
    return situation;
  }
  void step(const Situation& situation) {
    run_->step(situation);
    pose_.x += 0.01 * run_->twist().v;
    now_ += 0.01;
  }
  void go_on(double seconds) {
    for (const double end = now_ + seconds; now_ < end && !run_->ended();) step(good());
  }
  void drive() {
    begin();
    go_on(2.0);
    ASSERT_TRUE(run_->driving());
    ASSERT_GT(run_->twist().v, 0.1);
  }
  void expect_stop(const Situation& situation, ErrorCode code, const std::string& said) {
    step(situation);
    ASSERT_TRUE(run_->error()) << "it drives on";
    EXPECT_EQ(run_->error()->code, code);
    EXPECT_NE(run_->error()->what.find(said), std::string::npos) << run_->error()->what;
    EXPECT_EQ(run_->twist().v, 0.0);
    EXPECT_TRUE(controller_.stopped_last());
  }

  /// Drives, then this is so.
  template <typename Change>
  void expect_end(const Change& change, ErrorCode code, const std::string& said) {
    drive();
    Situation situation = good();
    change(situation);
    expect_stop(situation, code, said);
  }

  NotingController controller_;
  routines::Pose pose_;
  double now_ = 10.0;
  std::optional<MotionRun> run_;
};

TEST_F(Motion, that_nothing_disturbs_comes_to_its_end) {
  drive();
  go_on(60.0);
  EXPECT_EQ(run_->phase(), MotionRun::Phase::done);
  EXPECT_FALSE(run_->error());
  EXPECT_TRUE(controller_.stopped_last());
}

TEST_F(Motion, tells_how_far_it_is_while_it_drives_its_first_move) {
  begin();
  EXPECT_EQ(run_->fraction(), 0.0);
  const double whole = run_->remaining();
  EXPECT_GT(whole, 1.0);
  go_on(2.0);
  const std::string first = run_->activity();
  const double early = run_->fraction();
  EXPECT_GT(early, 0.0);
  go_on(0.5);
  EXPECT_EQ(run_->activity(), first);
  EXPECT_GT(run_->fraction(), early);
  EXPECT_NEAR(run_->remaining(), whole * (1.0 - run_->fraction()), 1e-9);
  go_on(60.0);
  EXPECT_EQ(run_->fraction(), 1.0);
  EXPECT_EQ(run_->remaining(), 0.0);
}

TEST_F(Motion, begins_when_the_countdown_is_over_and_not_before) {
  begin(3.0);
  go_on(2.95);
  EXPECT_TRUE(controller_.calls.empty());
  go_on(0.1);
  ASSERT_FALSE(controller_.calls.empty());
  EXPECT_EQ(controller_.calls.front(), "enable");
}

TEST_F(Motion, ends_when_the_client_no_longer_counts_as_present) {
  expect_end([](Situation& s) { s.lapsed = "no longer renews"; }, ErrorCode::cancelled, "no longer renews");
}

TEST_F(Motion, ends_when_the_wheels_are_faster_than_they_may_be) {
  expect_end([](Situation& s) { s.too_fast = "0.41 m/s"; }, ErrorCode::protective_stop, "0.41 m/s");
}

TEST_F(Motion, of_which_nobody_knows_whether_there_is_a_client_does_not_begin) {
  begin();
  Situation situation = good();
  situation.lapsed = Situation{}.lapsed;
  expect_stop(situation, ErrorCode::cancelled, "no lease");
  EXPECT_EQ(std::count(controller_.calls.begin(), controller_.calls.end(), "enable"), 0);
}

TEST_F(Motion, ends_when_a_sensor_is_stale_and_does_not_begin_with_one) {
  drive();
  Situation situation = good();
  situation.stale = "no scan";
  expect_stop(situation, ErrorCode::protective_stop, "no scan");
  controller_.calls.clear();
  begin(1.0);
  situation.now = now_;
  expect_stop(situation, ErrorCode::protective_stop, "no scan");
}

TEST_F(Motion, ends_when_something_is_in_the_way) {
  expect_end([](Situation& s) { s.obstacle = "something is in the way"; }, ErrorCode::protective_stop,
             "in the way");
}

TEST_F(Motion, ends_when_odometry_and_lidar_disagree) {
  expect_end([](Situation& s) { s.disagreement = "0.3 m apart"; }, ErrorCode::protective_stop, "0.3 m apart");
}

TEST_F(Motion, ends_when_it_leaves_its_envelope) {
  expect_end([](Situation& s) { s.odometry.x = 1.4; }, ErrorCode::protective_stop, "m allowed");
}

TEST_F(Motion, ends_when_it_leaves_its_envelope_by_the_lidar_alone) {
  drive();
  Situation situation = good();
  situation.by_lidar.x = 1.2;
  run_->step(situation);
  EXPECT_FALSE(run_->ended());
  situation.by_lidar.x = 1.4;
  expect_stop(situation, ErrorCode::protective_stop, "m allowed");
}

// The wheels are told to turn and the odometry stands: no distance, no turn, only the time tells.
TEST_F(Motion, ends_when_it_takes_half_as_long_again_as_expected) {
  drive();
  for (int i = 0; i < 20'000 && !run_->ended(); ++i) {
    run_->step(good());
    now_ += 0.01;
  }
  ASSERT_TRUE(run_->error());
  EXPECT_NE(run_->error()->what.find("s allowed"), std::string::npos) << run_->error()->what;
  EXPECT_TRUE(controller_.stopped_last());
}

TEST_F(Motion, ends_when_the_controller_is_no_longer_enabled) {
  drive();
  controller_.now = ControllerState::fault;
  expect_stop(good(), ErrorCode::device, "left the enabled state");
}

TEST_F(Motion, ends_when_the_axes_are_not_enabled_in_time) {
  begin();
  step(good());
  controller_.now = ControllerState::enabling;
  go_on(5.0);
  ASSERT_TRUE(run_->error());
  EXPECT_NE(run_->error()->what.find("not enabled"), std::string::npos) << run_->error()->what;
}

TEST_F(Motion, that_is_forgotten_stops) {
  drive();
  run_.reset();
  EXPECT_TRUE(controller_.stopped_last());
}

TEST_F(Motion, that_was_stopped_commands_nothing_any_more) {
  drive();
  run_->fault("emcy");
  ASSERT_TRUE(controller_.stopped_last());
  const auto calls = controller_.calls.size();
  for (int i = 0; i < 100; ++i) step(good());
  EXPECT_EQ(controller_.calls.size(), calls);
}

// Whichever call to the controller throws, from the first one on: the stop comes last.
TEST_F(Motion, from_which_any_call_throws_ends_with_the_stop) {
  begin();
  go_on(60.0);
  const auto all = static_cast<int>(controller_.calls.size()) - 4;  // the stop itself
  ASSERT_GT(all, 1000);
  // The first ones are all different, the rest are cycles of the same two.
  for (int at = 0; at < all; at = at < 200 ? at + 1 : at + 97) {
    controller_ = {};
    pose_ = {};
    now_ = 10.0;
    begin();
    controller_.throws_at = at;
    EXPECT_THROW(go_on(60.0), std::runtime_error) << at;
    run_.reset();
    ASSERT_TRUE(controller_.stopped_last()) << at;
  }
}

}  // namespace
}  // namespace odomcalib::motion_run_test
