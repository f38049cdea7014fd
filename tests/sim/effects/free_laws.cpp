// Laws of no mechanism: whatever the robot does at the moment changes whatever it moves by, in a shape that
// is drawn. Nobody has named them, so nobody can have prepared for one.
#include <array>
#include <cmath>

#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim {

namespace {

/// A variable that a law may depend on, about one where the robot does its utmost.
struct Cause {
  const char* name;
  std::vector<std::string> depends_on;
  double (*value)(const StepView& view, const StepMotion& motion, std::size_t side);
};

double rim_speed(const StepView& view, const StepMotion& motion, std::size_t side) {
  return motion.travel[side] / view.dt / 0.5;
}
double forward(const StepMotion& motion) { return 0.5 * (motion.travel[kLeft] + motion.travel[kRight]); }
double forward_speed(const StepView& view, const StepMotion& motion, std::size_t /*side*/) {
  return forward(motion) / view.dt / 0.5;
}
double turn_rate(const StepView& view, const StepMotion& /*motion*/, std::size_t /*side*/) {
  return view.yaw_rate / 1.2;
}
double sideways_force(const StepView& view, const StepMotion& /*motion*/, std::size_t /*side*/) {
  return view.speed * view.yaw_rate / 0.2;
}
double shaft_acceleration(const StepView& view, const StepMotion& /*motion*/, std::size_t side) {
  return view.acceleration[side] / 8.0;
}
double push(const StepView& view, const StepMotion& /*motion*/, std::size_t /*side*/) {
  return 0.5 * (view.acceleration[kLeft] + view.acceleration[kRight]) / 8.0;
}

const std::array<Cause, 6>& causes() {
  static const std::array<Cause, 6> kCauses = {{{"wheel_speed", {"wheel_speed"}, rim_speed},
                                                {"speed", {"speed"}, forward_speed},
                                                {"yaw_rate", {"yaw_rate"}, turn_rate},
                                                {"sideways_force", {"speed*yaw_rate"}, sideways_force},
                                                {"shaft_acceleration", {"acceleration"}, shaft_acceleration},
                                                {"push", {"acceleration"}, push}}};
  return kCauses;
}

enum class Shape { straight, square, step, magnitude, hump };

/// The quantity that a law changes: relative, m for each m, or (yaw) a third of a rad for each m.
enum class Result { one_wheel, both_wheels, track, one_wheel_ahead, both_ahead, aside, aside_always, yaw };

class FreeLaw : public Effect {
 public:
  FreeLaw(const Cause& cause, double size, Random& random)
      : Effect(std::string("law_of_") + cause.name, size),
        cause_(cause),
        result_(static_cast<Result>(random() % 8)),
        shape_(static_cast<Shape>(random() % 5)),
        side_(any_side(random)),
        caused_by_(any_side(random)),
        edge_(uniform(random, 0.3, 0.6)),
        sign_(any_sign(random)) {}

  void on_step(const StepView& view, StepMotion& motion) override {
    const double f = sign_ * size_ * shaped(cause_.value(view, motion, caused_by_));
    const double way = forward(motion);
    switch (result_) {
      case Result::one_wheel:
        motion.travel[side_] *= 1.0 + f;
        break;
      case Result::both_wheels:
        for (double& travel : motion.travel) travel *= 1.0 + f;
        break;
      case Result::track:
        motion.track_width *= 1.0 + f;
        break;
      case Result::one_wheel_ahead:
        motion.travel[side_] += f * std::abs(motion.travel[side_]);
        break;
      case Result::both_ahead:
        for (double& travel : motion.travel) travel += f * std::abs(way);
        break;
      case Result::aside:
        motion.side += f * way;
        break;
      case Result::aside_always:
        motion.side += f * std::abs(way);
        break;
      case Result::yaw:
        motion.yaw += 3.0 * f * std::abs(way);
        break;
    }
  }

 private:
  [[nodiscard]] double shaped(double cause) const {
    switch (shape_) {
      case Shape::straight:
        return cause;
      case Shape::square:
        return cause * cause;
      case Shape::step:
        return 0.5 + 0.5 * std::tanh((cause - edge_) / 0.07);
      case Shape::magnitude:
        return std::abs(cause);
      case Shape::hump:
        return std::exp(-std::pow((std::abs(cause) - edge_) / 0.2, 2));
    }
    return 0.0;
  }

  const Cause& cause_;
  Result result_;
  Shape shape_;
  std::size_t side_, caused_by_;
  double edge_, sign_;
};

}  // namespace

const std::vector<EffectKind>& free_laws() {
  static const std::vector<EffectKind> kLaws = [] {
    std::vector<EffectKind> laws;
    for (const Cause& cause : causes())
      laws.push_back({std::string("law_of_") + cause.name, "", cause.depends_on, "1", 0.006, 0.02,
                      [&cause](double size, Random& random) -> std::shared_ptr<Disturbance> {
                        return std::make_shared<FreeLaw>(cause, size, random);
                      }});
    return laws;
  }();
  return kLaws;
}

}  // namespace odomcalib::sim
