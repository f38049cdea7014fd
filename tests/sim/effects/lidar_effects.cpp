// A lidar that does not look where it says, or does not measure what is there.
#include <algorithm>
#include <cmath>

#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim {

namespace {

/// A soft mast: the head lags behind the base when the base is turned up. Size: rad at 1 rad/s^2.
class MastFlex : public Effect {
 public:
  MastFlex(double give, Random& /*random*/) : Effect("mast_flex", give) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double wheels_apart = view.acceleration[kRight] - view.acceleration[kLeft];
    const double acceleration = kWheelRadius * wheels_apart / motion.track_width;
    bend_ += (acceleration - bend_) * (1.0 - std::exp(-view.dt / kSettling));
  }
  double beam_direction(double /*t*/, double angle) override { return angle - size_ * bend_; }

 private:
  static constexpr double kSettling = 0.06;      // s
  static constexpr double kWheelRadius = 0.075;  // m, near enough for the size of a sway
  double bend_ = 0.0;
};

/// The head's own angle disc is off centre: beams point ahead on one side and behind on the other.
class HeadDiscOffCentre : public Effect {
 public:
  HeadDiscOffCentre(double offset_over_radius, Random& random)
      : Effect("head_disc_off_centre", offset_over_radius), phase_(any_angle(random)) {}
  double beam_direction(double /*t*/, double angle) override {
    const double from_axis = angle + phase_;
    return angle + std::atan2(size_ * std::sin(from_axis), 1.0 + size_ * std::cos(from_axis));
  }

 private:
  double phase_;
};

/// The spot of light is drawn out on a slanted wall and the echo comes from its near end.
class SlantedEcho : public Effect {
 public:
  SlantedEcho(double shortening, Random& /*random*/) : Effect("slanted_echo", shortening) {}
  void on_beam(BeamReading& beam) override {
    if (beam.range <= 0.0) return;
    const double cosine = std::max(beam.incidence_cosine, 0.15);
    const double tangent = std::sqrt(1.0 - cosine * cosine) / cosine;
    beam.range = std::max(0.0, beam.range - size_ * tangent * beam.true_range / 4.0);
  }
};

/// The echo passes a cover of glass that the device does not know of; near walls are spared a little of it.
class CoverGlass : public Effect {
 public:
  CoverGlass(double optical_path, Random& random)
      : Effect("cover_glass", optical_path), way_(any_sign(random)) {}
  void on_beam(BeamReading& beam) override {
    if (beam.range <= 0.0) return;
    beam.range = std::max(0.0, beam.range + way_ * size_ * (1.0 - 0.3 * std::exp(-beam.true_range / 0.3)));
  }

 private:
  double way_;
};

/// The head leans to one side: vertical walls are met higher or lower, and later.
class LeaningHead : public Effect {
 public:
  LeaningHead(double lean, Random& random) : Effect("leaning_head", lean), towards_(any_angle(random)) {}
  void on_beam(BeamReading& beam) override {
    const double rise = std::tan(size_) * std::cos(beam.angle - towards_);
    beam.range *= std::sqrt(1.0 + rise * rise);
  }

 private:
  double towards_;
};

template <typename Kind>
auto lidar_maker() {
  return [](double size, Random& random) -> std::shared_ptr<Disturbance> {
    return std::make_shared<Kind>(size, random);
  };
}

}  // namespace

std::vector<EffectKind> lidar_effects() {
  return {
      {"mast_flex", "", {"yaw_acceleration"}, "rad at 1 rad/s^2", 0.004, 0.02, lidar_maker<MastFlex>()},
      {"head_disc_off_centre", "", {"bearing"}, "1", 0.01, 0.05, lidar_maker<HeadDiscOffCentre>()},
      {"cover_glass", "range_bias", {"range"}, "m", 0.01, 0.04, lidar_maker<CoverGlass>()},
      {"leaning_head", "lidar_tilt", {"bearing"}, "rad", 0.06, 0.12, lidar_maker<LeaningHead>()},
      {"slanted_echo", "", {"incidence"}, "m at 45 deg and 4 m", 0.005, 0.03, lidar_maker<SlantedEcho>()},
  };
}

}  // namespace odomcalib::sim
