// Ticks of a robot at constant speed, from its wheels through the simulated wires to TickSample: a sample's
// date must be the instant at which the wheels had these counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "drivers/base/controller.hpp"
#include "tests/sim/wires/sim_robot.hpp"
#include "tests/unit/drivers/ready_can.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::drivers::tick_dates_test {
namespace {

constexpr double kSpeed_rad_s = 8.0;
constexpr double kFrame_s = 111.0 / 500'000.0;  // 8 data bytes at 500 kbit/s
constexpr double kTolerance_s = 60e-6;          // of one count at this speed: 48 us

struct Wire {
  double poll_s;  ///< how often the program looks at the port
};

class TickDates : public testing::TestWithParam<Wire> {
 protected:
  void SetUp() override {
    sim::SimRobotOptions options;
    options.truth = options.nominal;
    robot_ = value_of(sim::SimRobot::create(options));
    robot_->serve_during([&] { bus_ = test::open_ready_can(robot_->can_device()).value(); });
    controller_ = make_controller("drivers/base/profiles/sim-dual.toml").value();
  }

  void turn() {
    robot_->step(GetParam().poll_s);
    const auto frames = value_of(bus_->receive(robot_->now()));
    for (const CanFrame& frame : frames) controller_->on_frame(frame);
    controller_->on_time(robot_->now());
    for (const CanFrame& frame : controller_->take_frames()) ASSERT_TRUE(bus_->send(frame).ok());
  }

  bool turn_until(ControllerState wanted) {
    for (int i = 0; i < 10'000 && controller_->state() != wanted; ++i) turn();
    return controller_->state() == wanted;
  }

  void drive_for(double duration) {
    const double end = robot_->now() + duration;
    while (robot_->now() < end) {
      ASSERT_TRUE(controller_->command(kSpeed_rad_s, kSpeed_rad_s, robot_->now()).ok());
      turn();
      note_dates();
    }
  }

  /// Difference between each sample's date and the instant at which the left wheel had its count.
  void note_dates() {
    const double ticks_per_s = robot_->wheel_rate()[sim::kLeft] * 16384.0 / (2.0 * M_PI);
    const auto count = static_cast<double>(robot_->body().counts()[sim::kLeft]);
    for (const TickSample& sample : controller_->take_ticks())
      errors_.push_back(sample.t - robot_->now() + (count - static_cast<double>(sample.left)) / ticks_per_s);
  }

  std::unique_ptr<sim::SimRobot> robot_;
  std::unique_ptr<CanTransport> bus_;
  std::unique_ptr<Controller> controller_;
  std::vector<double> errors_;  ///< s, positive: dated too late
};

TEST_P(TickDates, are_those_of_the_counts) {
  ASSERT_TRUE(turn_until(ControllerState::disabled));
  controller_->enable(robot_->now());
  ASSERT_TRUE(turn_until(ControllerState::enabled));
  drive_for(2.0);  // until the speed is constant
  errors_.clear();
  drive_for(4.0);
  ASSERT_GT(errors_.size(), 150U);
  const double mean =
      std::accumulate(errors_.begin(), errors_.end(), 0.0) / static_cast<double>(errors_.size());
  std::sort(errors_.begin(), errors_.end());
  const double least = errors_.front();
  // A busy machine hands a few bytes of a pseudo-terminal over one look later.
  const double most = errors_[errors_.size() * 97 / 100];
  RecordProperty("mean_us", static_cast<int>(1e6 * mean));
  // The simulated bus takes no time, the driver subtracts the 0.22 ms of a real frame. A program that looks
  // at the port only now and then dates by when it looks, never earlier.
  EXPECT_GT(least, -kFrame_s - kTolerance_s);
  EXPECT_LT(most, GetParam().poll_s - kFrame_s + kTolerance_s);
  EXPECT_LT(most - least, GetParam().poll_s + kTolerance_s);
}

INSTANTIATE_TEST_SUITE_P(Wires, TickDates,
                         testing::Values(Wire{0.001}, Wire{0.002}, Wire{0.005}, Wire{0.01}));

}  // namespace
}  // namespace odomcalib::drivers::tick_dates_test
