// Rubber on the floor: slip, scrub, casters.
#include <algorithm>
#include <cmath>

#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim {

namespace {

constexpr double kGravity = 9.81;
constexpr double kFriction = 0.7;  // peak of the tyre curve
constexpr double kShape = 1.5;     // shape factor of the tyre curve

double sign(double value) { return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0; }

/// Slip that a tyre needs for an acceleration, from the inverted curve force = peak * sin(shape *
/// atan(stiffness * slip)).
/// @param at_one slip at 1 m/s^2 in the linear part
double tyre_slip(double acceleration, double at_one) {
  if (at_one <= 0.0) return 0.0;
  const double stiffness = 1.0 / (kGravity * kFriction * kShape * at_one);
  const double used = std::min(std::abs(acceleration) / (kGravity * kFriction), 0.98);
  return sign(acceleration) * std::tan(std::asin(used) / kShape) / stiffness;
}

double travel_forward(const StepMotion& motion) {
  return 0.5 * (motion.travel[kLeft] + motion.travel[kRight]);
}

/// Each tyre slips as much as its share of the acceleration asks for.
class TractionSlip : public Effect {
 public:
  TractionSlip(double slip_at_one, Random& /*random*/) : Effect("traction_slip", slip_at_one) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    for (const std::size_t side : {kLeft, kRight}) {
      if (view.turned[side] == 0.0) continue;
      const double radius = motion.travel[side] / view.turned[side];
      const double rim_acceleration = radius * view.acceleration[side];
      motion.travel[side] -= std::abs(motion.travel[side]) * tyre_slip(rim_acceleration, size_);
    }
  }
};

/// Rim acceleration in the direction in which the wheel turns, m/s^2: negative while it is braked.
double speeding_up(const StepView& view, const StepMotion& motion, std::size_t side) {
  const double way = motion.travel[side];
  return view.turned[side] == 0.0 ? 0.0 : view.acceleration[side] * way / view.turned[side] * sign(way);
}

/// The motors are gentle but the brakes are not: tyres slide on while a wheel is slowed down.
class BrakeSkid : public Effect {
 public:
  BrakeSkid(double slip_at_one, Random& /*random*/) : Effect("brake_skid", slip_at_one) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    for (const std::size_t side : {kLeft, kRight})
      motion.travel[side] *= 1.0 + tyre_slip(std::max(0.0, -speeding_up(view, motion, side)), size_);
  }
};

/// One brake grabs: that wheel is locked for short times as it is slowed down, and drags.
class GrabbingBrake : public Effect {
 public:
  GrabbingBrake(double slip_at_one, Random& random)
      : Effect("grabbing_brake", slip_at_one), side_(any_side(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double braking = std::max(0.0, -speeding_up(view, motion, side_));
    motion.travel[side_] *= 1.0 + size_ * braking * braking / (0.3 + braking);
  }

 private:
  std::size_t side_;
};

/// The side walls of the tyres twist in turns on the spot (Dahl's law), untwist as they roll on, and turn the
/// base back when it has come to rest. Size: rad.
class SidewallTwist : public Effect {
 public:
  SidewallTwist(double most, Random& /*random*/) : Effect("sidewall_twist", most) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    if (size_ <= 0.0) return;
    const double path = std::abs(travel_forward(motion));
    if (std::abs(view.rate[kLeft]) < kRest && std::abs(view.rate[kRight]) < kRest) {
      const double back = twist_ * (1.0 - std::exp(-view.dt / kTime));
      motion.yaw -= back;
      twist_ -= back;
      return;
    }
    const double yaw = view.yaw_rate * view.dt;
    twist_ += (yaw - std::abs(yaw) * twist_ / size_) * size_ / kAngle;
    twist_ *= std::exp(-path / kContact);
  }

 private:
  static constexpr double kTime = 0.2;      // s
  static constexpr double kAngle = 0.12;    // rad
  static constexpr double kContact = 0.04;  // m
  static constexpr double kRest = 0.02;     // rad/s of a wheel
  double twist_ = 0.0;
};

/// In a curve the tyres run at a slip angle that builds up over a relaxation length.
class CorneringCreep : public Effect {
 public:
  CorneringCreep(double angle_at_one, Random& /*random*/) : Effect("cornering_creep", angle_at_one) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double path = std::abs(travel_forward(motion));
    const double wanted = std::atan(tyre_slip(view.speed * view.yaw_rate, size_));
    angle_ += (wanted - angle_) * (1.0 - std::exp(-path / kRelaxation));
    motion.side -= std::tan(angle_) * path;
  }

 private:
  static constexpr double kRelaxation = 0.06;  // m
  double angle_ = 0.0;
};

/// A wide contact patch scrubs about its middle in a spin and rolls about its inner edge in a wide curve.
class PatchScrub : public Effect {
 public:
  PatchScrub(double widening, Random& /*random*/) : Effect("patch_scrub", widening) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double scrub = 0.15 * std::abs(view.yaw_rate), roll = std::abs(view.speed) + 0.01;
    motion.track_width *= 1.0 + size_ * std::tanh(scrub / roll);
  }
};

/// A load beside the middle drags one wheel in left turns only.
class TurnDrag : public Effect {
 public:
  TurnDrag(double widening, Random& random) : Effect("turn_drag", widening), hand_(any_sign(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    motion.track_width *= 1.0 + size_ / (1.0 + std::exp(-hand_ * view.yaw_rate / 0.04));
  }

 private:
  double hand_;
};

/// Turning on the spot, the caster drags the robot along, whichever way it turns. Size: m for each rad.
class SpinWalk : public Effect {
 public:
  SpinWalk(double walk, Random& random) : Effect("spin_walk", walk), way_(any_sign(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double walk = way_ * size_ * std::abs(view.yaw_rate) * view.dt;
    for (double& travel : motion.travel) travel += walk;
  }

 private:
  double way_;
};

/// The chassis keeps a twist from the last turn, and one wheel carries more for it.
class TurnMemory : public Effect {
 public:
  TurnMemory(double change, Random& random) : Effect("turn_memory", change), side_(any_side(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double turned = view.yaw_rate * view.dt;
    twist_ += std::abs(turned) * (sign(turned) - twist_) / kAngle;
    motion.travel[side_] *= 1.0 + size_ * twist_;
  }

 private:
  static constexpr double kAngle = 0.4;  // rad of turning that twist it
  std::size_t side_;
  double twist_ = 0.0;
};

/// A trailing caster behind the axle: it swings round by its own kinematics, and pushes the tail sideways as
/// long as it does not roll the way its pivot moves.
class CasterSwing : public Effect {
 public:
  CasterSwing(double push, Random& random) : Effect("caster_swing", push), bias_(0.002 * any_sign(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double along = travel_forward(motion) / view.dt, across = -kBehind * view.yaw_rate;
    // No sideways slip of the caster wheel, which trails from the pivot in direction `angle_`.
    const double swing = (along * std::sin(angle_) - across * std::cos(angle_)) / kTrail - view.yaw_rate;
    angle_ += (swing + bias_ * std::abs(along) / kTrail) * view.dt;
    if (std::abs(along) < 1e-9) return;
    const double rolls_along = std::atan2(-across, -along);
    motion.yaw += size_ * std::sin(angle_ - rolls_along) * std::abs(travel_forward(motion)) / kTrail;
  }

 private:
  static constexpr double kBehind = 0.25, kTrail = 0.03;  // m
  double bias_;
  double angle_ = 3.0;  // rad, trailing behind
};

template <typename Kind>
auto contact_maker() {
  return [](double size, Random& random) -> std::shared_ptr<Disturbance> {
    return std::make_shared<Kind>(size, random);
  };
}

}  // namespace

std::vector<EffectKind> contact_effects() {
  return {
      {"traction_slip",
       "acceleration_slip",
       {"acceleration"},
       "1 at 1 m/s^2",
       0.015,
       0.06,
       contact_maker<TractionSlip>()},
      {"brake_skid",
       "acceleration_slip",
       {"acceleration"},
       "1 at 1 m/s^2",
       0.02,
       0.1,
       contact_maker<BrakeSkid>()},
      {"grabbing_brake", "", {"acceleration"}, "1 at 1 m/s^2", 0.02, 0.1, contact_maker<GrabbingBrake>()},
      {"sidewall_twist", "stop_settling", {"stops"}, "rad", 0.002, 0.01, contact_maker<SidewallTwist>()},
      {"cornering_creep",
       "lateral_slip",
       {"speed*yaw_rate"},
       "rad at 1 m/s^2",
       0.03,
       0.12,
       contact_maker<CorneringCreep>()},
      {"patch_scrub",
       "track_depends_on_motion",
       {"yaw_rate", "speed"},
       "1",
       0.005,
       0.03,
       contact_maker<PatchScrub>()},
      {"turn_drag", "turn_direction_asymmetry", {"yaw_rate"}, "1", 0.004, 0.02, contact_maker<TurnDrag>()},
      {"spin_walk", "", {"yaw_rate"}, "m/rad", 0.001, 0.005, contact_maker<SpinWalk>()},
      {"turn_memory", "", {"previous_turn"}, "1", 0.003, 0.012, contact_maker<TurnMemory>()},
      {"caster_swing",
       "caster_kick",
       {"distance_since_reversal"},
       "rad",
       0.004,
       0.02,
       contact_maker<CasterSwing>()},
  };
}

}  // namespace odomcalib::sim
