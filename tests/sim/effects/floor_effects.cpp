// Effects of the place on the robot.
#include <algorithm>
#include <cmath>

#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim {

namespace {

double path(const StepMotion& motion) { return 0.5 * std::abs(motion.travel[kLeft] + motion.travel[kRight]); }

/// Downhill every metre becomes longer, uphill shorter; across the slope the tyres creep a little.
class TiltedFloor : public Effect {
 public:
  TiltedFloor(double creep, Random& random) : Effect("tilted_floor", creep), downhill_(any_angle(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double creep = size_ * path(motion), bearing = downhill_ - view.pose.yaw;
    for (double& travel : motion.travel) travel += creep * std::cos(bearing);
    motion.side += 0.25 * creep * std::sin(bearing);
  }

 private:
  double downhill_;
};

/// Carpet fibres lean one way and carry the robot with them; fast wheels leave them less time.
class CarpetNap : public Effect {
 public:
  CarpetNap(double drift, Random& random) : Effect("carpet_nap", drift), lean_(any_angle(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double carried = size_ * path(motion) / (1.0 + std::abs(view.speed) / 0.8);
    motion.drift.x += carried * std::cos(lean_);
    motion.drift.y += carried * std::sin(lean_);
  }

 private:
  double lean_;
};

/// Tiles of a third of a metre, raised towards their middle in both directions.
class FloorTiles : public Effect {
 public:
  FloorTiles(double change, Random& random)
      : Effect("floor_tiles", change), corner_{uniform(random, 0.0, kTile), uniform(random, 0.0, kTile)} {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double swell = bulge(view.pose.x - corner_.x) * std::cos(view.pose.yaw) +
                         bulge(view.pose.y - corner_.y) * std::sin(view.pose.yaw);
    for (double& travel : motion.travel) travel *= 1.0 + size_ * swell;
  }

 private:
  static constexpr double kTile = 0.333;
  /// Slope of a tile: 1 at one joint, -1 at the next.
  static double bulge(double along) { return -2.0 * std::remainder(along / kTile, 1.0); }
  Vec2 corner_;
};

/// A rug on one half of the floor, in which the wheels sink.
class Rug : public Effect {
 public:
  Rug(double loss, Random& random)
      : Effect("rug", loss), normal_(any_angle(random)), edge_(uniform(random, -0.2, 0.3)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double beyond = view.pose.x * std::cos(normal_) + view.pose.y * std::sin(normal_) - edge_;
    const double sunk = std::clamp(0.5 + beyond / 0.06, 0.0, 1.0);
    for (double& travel : motion.travel) travel *= 1.0 - size_ * sunk;
  }

 private:
  double normal_, edge_;
};

/// A cable to the wall comes under tension at some headings and turns the robot back. Size: rad for each
/// metre.
class CablePull : public Effect {
 public:
  CablePull(double pull, Random& random)
      : Effect("cable_pull", pull), taut_(any_angle(random)), hand_(any_sign(random)) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double tension = std::max(0.0, std::cos(view.pose.yaw - taut_) - 0.3) / 0.7;
    motion.yaw += hand_ * size_ * tension * path(motion);
  }

 private:
  double taut_, hand_;
};

template <typename Kind>
auto floor_maker() {
  return [](double size, Random& random) -> std::shared_ptr<Disturbance> {
    return std::make_shared<Kind>(size, random);
  };
}

}  // namespace

std::vector<EffectKind> floor_effects() {
  return {
      {"tilted_floor", "floor_slope", {"heading"}, "1", 0.004, 0.015, floor_maker<TiltedFloor>()},
      {"carpet_nap", "carpet", {"heading"}, "1", 0.005, 0.03, floor_maker<CarpetNap>()},
      {"floor_tiles", "", {"position"}, "1", 0.02, 0.06, floor_maker<FloorTiles>()},
      {"rug", "", {"position"}, "1", 0.005, 0.02, floor_maker<Rug>()},
      {"cable_pull", "", {"heading"}, "rad/m", 0.02, 0.08, floor_maker<CablePull>()},
  };
}

}  // namespace odomcalib::sim
