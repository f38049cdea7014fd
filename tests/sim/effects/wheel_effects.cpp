// Wheels that are not round, not constant, or not the same all the time.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim {

namespace {

/// A circle that turns about a point beside its centre: the floor is met at the distance of the rim in that
/// direction.
class OffCentreWheel : public Effect {
 public:
  OffCentreWheel(double offset_over_radius, Random& random)
      : Effect("off_centre_wheel", offset_over_radius), side_(any_side(random)), phase_(any_angle(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double direction = view.angle[side_] + phase_, across = size_ * std::sin(direction);
    motion.travel[side_] *= size_ * std::cos(direction) + std::sqrt(1.0 - across * across);
  }

 private:
  std::size_t side_;
  double phase_;
};

/// A flat worn or pressed into the tread, once a turn. Size: half the angle that it spans.
class FlatSpot : public Effect {
 public:
  FlatSpot(double half_angle, Random& random)
      : Effect("flat_spot", half_angle), side_(any_side(random)), phase_(any_angle(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double from_middle = std::remainder(view.angle[side_] + phase_, 2.0 * std::numbers::pi);
    if (std::abs(from_middle) < size_) motion.travel[side_] *= std::cos(size_) / std::cos(from_middle);
  }
  /// Mean of the above over the turn.
  [[nodiscard]] double roundness(std::size_t side) const override {
    const double flat = std::cos(size_) * std::asinh(std::tan(size_));
    return side == side_ ? 1.0 - (size_ - flat) / std::numbers::pi : 1.0;
  }

 private:
  std::size_t side_;
  double phase_;
};

/// A tyre that stiffens and grows as it turns faster, and saturates.
class RimGrowth : public Effect {
 public:
  RimGrowth(double growth, Random& /*random*/) : Effect("rim_growth", growth) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    for (const std::size_t side : {kLeft, kRight}) {
      const double pace = motion.travel[side] / view.dt / kHalfWay;
      motion.travel[side] *= 1.0 + size_ * (1.0 - std::exp(-pace * pace));
    }
  }

 private:
  static constexpr double kHalfWay = 0.3;  // m/s
};

/// At one wheel speed the suspension swings and the wheel loses grip; faster and slower it is fine.
class Resonance : public Effect {
 public:
  Resonance(double loss, Random& random)
      : Effect("resonance", loss), side_(any_side(random)), speed_(uniform(random, 0.18, 0.32)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double away = (std::abs(motion.travel[side_]) / view.dt - speed_) / kWidth;
    motion.travel[side_] *= 1.0 - size_ / (1.0 + away * away * away * away);
  }

 private:
  static constexpr double kWidth = 0.05;  // m/s
  std::size_t side_;
  double speed_;
};

/// Tread blocks lean one way; after a reversal they take a few centimetres to lean over.
class TreadLay : public Effect {
 public:
  TreadLay(double difference, Random& /*random*/) : Effect("tread_lay", difference) {}
  void on_step(const StepView& /*view*/, StepMotion& motion) override {
    for (const std::size_t side : {kLeft, kRight}) {
      const double travel = motion.travel[side];
      lean_[side] = std::clamp(lean_[side] + 2.0 * travel / kLeanOver, -1.0, 1.0);
      motion.travel[side] *= 1.0 + 0.5 * size_ * (1.0 - lean_[side]);
    }
  }

 private:
  static constexpr double kLeanOver = 0.025;  // m
  PerSide lean_{1.0, 1.0};
};

/// Rolling heats a tyre, air cools it; a warm tyre is larger. One wheel warms more, being nearer to the
/// motor.
class TyreWarming : public Effect {
 public:
  TyreWarming(double growth, Random& random)
      : Effect("tyre_warming", growth),
        warm_side_(any_side(random)),
        cooling_(uniform(random, 60.0, 180.0)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    for (const std::size_t side : {kLeft, kRight}) {
      const double heating = std::abs(motion.travel[side]) / (kTypicalSpeed * cooling_);
      heat_[side] += heating - heat_[side] * view.dt / cooling_;
      motion.travel[side] *= 1.0 + size_ * heat_[side] * (side == warm_side_ ? 1.0 : 0.3);
    }
  }

 private:
  static constexpr double kTypicalSpeed = 0.2;  // m/s
  std::size_t warm_side_;
  double cooling_;
  PerSide heat_{};
};

/// An air conditioner that goes on and off: the diameters follow.
class AirConditioner : public Effect {
 public:
  AirConditioner(double swing, Random& random)
      : Effect("air_conditioner", swing), period_(uniform(random, 45.0, 100.0)), phase_(any_angle(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double cycle = std::remainder(view.t / period_ + phase_ / (2.0 * std::numbers::pi), 1.0);
    const double swing = 1.0 - 4.0 * std::abs(cycle);  // triangle between -1 and 1
    for (double& travel : motion.travel) travel *= 1.0 + size_ * swing;
  }

 private:
  double period_, phase_;
};

/// The load slips at some moment: one tyre is pressed flatter from then on, the other one recovers.
class PayloadShift : public Effect {
 public:
  PayloadShift(double change, Random& random)
      : Effect("payload_shift", change), side_(any_side(random)), moment_(uniform(random, 80.0, 160.0)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    if (view.t < moment_) return;
    motion.travel[side_] *= 1.0 - size_;
    motion.travel[1 - side_] *= 1.0 + 0.6 * size_;
  }

 private:
  std::size_t side_;
  double moment_;
};

/// After standing still the rubber sticks to itself: the first centimetres roll short.
class StickyStart : public Effect {
 public:
  StickyStart(double loss, Random& /*random*/) : Effect("sticky_start", loss) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double rolled = 0.5 * (std::abs(motion.travel[kLeft]) + std::abs(motion.travel[kRight]));
    const bool standing = std::abs(view.rate[kLeft]) + std::abs(view.rate[kRight]) < 0.02;
    stood_ = standing ? stood_ + view.dt : 0.0;
    if (stood_ > 0.15) since_ = 0.0;
    since_ += rolled;
    for (double& travel : motion.travel) travel *= 1.0 - size_ * std::exp(-since_ / kReach);
  }

 private:
  static constexpr double kReach = 0.04;  // m
  double stood_ = 0.0, since_ = 1.0;
};

template <typename Kind>
auto wheel_maker() {
  return [](double size, Random& random) -> std::shared_ptr<Disturbance> {
    return std::make_shared<Kind>(size, random);
  };
}

}  // namespace

std::vector<EffectKind> wheel_effects() {
  return {
      {"off_centre_wheel",
       "wheel_eccentricity",
       {"wheel_phase"},
       "1",
       0.005,
       0.02,
       wheel_maker<OffCentreWheel>()},
      {"flat_spot", "", {"wheel_phase"}, "rad", 0.3, 0.55, wheel_maker<FlatSpot>()},
      {"rim_growth", "speed_dependent_radius", {"wheel_speed"}, "1", 0.004, 0.02, wheel_maker<RimGrowth>()},
      {"resonance", "", {"wheel_speed"}, "1", 0.01, 0.04, wheel_maker<Resonance>()},
      {"tread_lay", "direction_dependent_diameter", {"direction"}, "1", 0.003, 0.01, wheel_maker<TreadLay>()},
      {"tyre_warming", "drift_with_time", {"time"}, "1", 0.004, 0.015, wheel_maker<TyreWarming>()},
      {"air_conditioner", "", {"time"}, "1", 0.003, 0.012, wheel_maker<AirConditioner>()},
      {"payload_shift", "", {"time"}, "1", 0.003, 0.012, wheel_maker<PayloadShift>()},
      {"sticky_start", "", {"distance_since_stop"}, "1", 0.05, 0.3, wheel_maker<StickyStart>()},
  };
}

}  // namespace odomcalib::sim
