#include "tests/sim/world/body.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odomcalib::sim {

Body::Body(const Geometry& truth, const BodyOptions& options, std::uint64_t seed, Disturbances disturbances)
    : truth_(truth),
      options_(options),
      disturbances_(std::move(disturbances)),
      random_(seed ^ 0x626f6479ULL),
      pose_(options.start) {
  // The wheels stand anywhere within a count when the counters start.
  std::uniform_real_distribution<double> within_a_count(0.0, 1.0);
  for (double& phase : phase_) phase = within_a_count(random_);
}

void Body::command(double left, double right) {
  target_ = {left, right};
  torque_ = true;
}

void Body::release() { torque_ = false; }

void Body::set_ramps(double acceleration, double deceleration) {
  options_.motor.acceleration = acceleration;
  options_.motor.deceleration = deceleration;
}

double Body::next_rate(std::size_t side) {
  const MotorOptions& motor = options_.motor;
  const double dt = options_.step, rate = rate_[side];
  if (!torque_) {
    set_point_[side] = rate;
    return std::abs(rate) <= motor.coasting * dt ? 0.0 : rate - std::copysign(motor.coasting * dt, rate);
  }
  const double missing = target_[side] - set_point_[side];
  const bool slowing = missing * set_point_[side] < 0.0;
  const double ramp = (slowing ? motor.deceleration : motor.acceleration) * dt;
  set_point_[side] += std::clamp(missing, -ramp, ramp);
  const double pull = (set_point_[side] - rate) * (1.0 - std::exp(-dt / motor.lag));
  return rate + std::clamp(pull, -motor.torque_limit * dt, motor.torque_limit * dt);
}

void Body::drive_motors(StepView& view) {
  for (const std::size_t side : {kLeft, kRight}) {
    const double before = rate_[side], after = next_rate(side);
    view.rate[side] = before;
    view.acceleration[side] = (after - before) / view.dt;
    view.turned[side] = 0.5 * (before + after) * view.dt;
    rate_[side] = after;
    angle_[side] += view.turned[side];
  }
}

StepMotion Body::ideal_rolling(const StepView& view) {
  StepMotion motion;
  motion.travel = {0.5 * truth_.left_diameter * view.turned[kLeft],
                   0.5 * truth_.right_diameter * view.turned[kRight]};
  motion.track_width = truth_.track_width;
  if (options_.slip_noise > 0.0)
    for (double& travel : motion.travel)
      travel += options_.slip_noise * std::sqrt(std::abs(travel)) * normal_(random_);
  return motion;
}

// The two contact points move along the heading that the axle has half-way through the step.
void Body::roll(const StepMotion& motion, double dt) {
  const double turn = (motion.travel[kRight] - motion.travel[kLeft]) / motion.track_width + motion.yaw;
  const double forward = 0.5 * (motion.travel[kRight] + motion.travel[kLeft]);
  const double halfway = pose_.yaw + 0.5 * turn;
  pose_.x += forward * std::cos(halfway) - motion.side * std::sin(halfway) + motion.drift.x;
  pose_.y += forward * std::sin(halfway) + motion.side * std::cos(halfway) + motion.drift.y;
  pose_.yaw += turn;
  speed_ = forward / dt;
  yaw_rate_ = turn / dt;
}

void Body::advance() {
  StepView view;
  view.t = time_;
  view.dt = options_.step;
  view.pose = pose_;
  view.angle = angle_;
  view.speed = speed_;
  view.yaw_rate = yaw_rate_;
  drive_motors(view);
  StepMotion motion = ideal_rolling(view);
  encoder_ = angle_;
  for (const auto& effect : disturbances_) effect->on_step(view, motion);
  for (const auto& effect : disturbances_) effect->on_encoder(view, encoder_);
  roll(motion, view.dt);
  time_ = static_cast<double>(++steps_) * options_.step;  // no accumulated rounding
}

std::array<std::int64_t, 2> Body::counts() const {
  std::array<std::int64_t, 2> out{};
  for (const std::size_t side : {kLeft, kRight}) {
    const double turns = encoder_[side] / (2.0 * std::numbers::pi);
    out[side] = static_cast<std::int64_t>(std::floor(turns * truth_.ticks_per_rev + phase_[side]));
  }
  return out;
}

}  // namespace odomcalib::sim
