// The mechanics: two motors, two wheels, a chassis on the floor.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "tests/sim/world/disturbance.hpp"
#include "tests/sim/world/truth.hpp"

namespace odomcalib::sim {

using Disturbances = std::vector<std::shared_ptr<Disturbance>>;

struct MotorOptions {
  double lag = 0.03;           ///< s, first-order lag of the speed loop
  double acceleration = 20.0;  ///< rad/s^2, ramp of the set point when speeding up
  double deceleration = 20.0;  ///< rad/s^2, and when slowing down
  double torque_limit = 80.0;  ///< rad/s^2, more the motor cannot do
  double coasting = 12.0;      ///< rad/s^2, friction without torque
};

struct BodyOptions {
  double step = 0.001;  ///< s
  MotorOptions motor;
  double slip_noise = 0.0;  ///< m per square root of a metre rolled, each wheel
  Pose start;
};

class Body {
 public:
  Body(const Geometry& truth, const BodyOptions& options, std::uint64_t seed, Disturbances disturbances = {});

  /// Wheel speeds in rad/s that the ramps lead to; also switches torque on.
  void command(double left, double right);
  /// Torque off: the wheels coast to rest.
  void release();
  void set_ramps(double acceleration, double deceleration);
  /// One fine step.
  void advance();

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double step_length() const { return options_.step; }
  [[nodiscard]] const Pose& pose() const { return pose_; }
  [[nodiscard]] const PerSide& angle() const { return angle_; }
  [[nodiscard]] const PerSide& rate() const { return rate_; }
  [[nodiscard]] const Geometry& truth() const { return truth_; }
  [[nodiscard]] double speed() const { return speed_; }
  [[nodiscard]] double yaw_rate() const { return yaw_rate_; }
  /// Counter values now, before any effect on the way to the host.
  [[nodiscard]] std::array<std::int64_t, 2> counts() const;

 private:
  void drive_motors(StepView& view);
  [[nodiscard]] double next_rate(std::size_t side);
  void roll(const StepMotion& motion, double dt);
  [[nodiscard]] StepMotion ideal_rolling(const StepView& view);

  Geometry truth_;
  BodyOptions options_;
  Disturbances disturbances_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double time_ = 0.0;
  std::uint64_t steps_ = 0;
  Pose pose_;
  PerSide target_{}, set_point_{}, rate_{}, angle_{}, encoder_{}, phase_{};
  bool torque_ = false;
  double speed_ = 0.0, yaw_rate_ = 0.0;
};

}  // namespace odomcalib::sim
