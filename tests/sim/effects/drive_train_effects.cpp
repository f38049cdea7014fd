// Between the motor shaft, the encoder and the wheel.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim {

namespace {

/// Gear teeth with play: the wheel moves only while a flank of the motor's tooth pushes it.
class GearPlay : public Effect {
 public:
  GearPlay(double play, Random& random) : Effect("gear_play", play), gap_{uniform(random, 0.0, play), 0.0} {
    gap_[kRight] = uniform(random, 0.0, play);
  }
  void on_step(const StepView& view, StepMotion& motion) override {
    for (const std::size_t side : {kLeft, kRight}) {
      if (view.turned[side] == 0.0) continue;
      // gap_: how far the tooth is from the flank that drives backwards; size_ - gap_ from the other one.
      const double moved = gap_[side] + view.turned[side];
      const double pushed = moved > size_ ? moved - size_ : std::min(moved, 0.0);
      gap_[side] = moved - pushed;
      motion.travel[side] *= pushed / view.turned[side];
    }
  }

 private:
  PerSide gap_;
};

/// The code disc sits beside the shaft: it reads the angle seen from the wrong point.
class EncoderDiscOffCentre : public Effect {
 public:
  EncoderDiscOffCentre(double offset_over_radius, Random& random)
      : Effect("encoder_disc_off_centre", offset_over_radius),
        side_(any_side(random)),
        phase_(any_angle(random)) {}
  void on_encoder(const StepView& /*view*/, PerSide& angle) override {
    const double from_axis = angle[side_] + phase_;
    angle[side_] += std::atan2(size_ * std::sin(from_axis), 1.0 + size_ * std::cos(from_axis));
  }

 private:
  std::size_t side_;
  double phase_;
};

/// Interpolation between the poles of a magnet goes wrong the same way in every quarter turn.
class EncoderInterpolation : public Effect {
 public:
  EncoderInterpolation(double error, Random& random)
      : Effect("encoder_interpolation", error), side_(any_side(random)), phase_(any_angle(random)) {}
  void on_encoder(const StepView& /*view*/, PerSide& angle) override {
    const double quarter = std::sin(4.0 * angle[side_] + phase_);
    angle[side_] += size_ * quarter * (1.0 + 0.3 * quarter);
  }

 private:
  std::size_t side_;
  double phase_;
};

/// An interrupt-driven counter that misses edges when they come too fast; worse the faster.
class MissedCounts : public Effect {
 public:
  MissedCounts(double share, Random& random)
      : Effect("missed_counts", share), side_(any_side(random)), limit_(uniform(random, 3.0, 4.5)) {}
  void on_encoder(const StepView& view, PerSide& angle) override {
    const double too_fast = (std::abs(view.rate[side_]) - limit_) / 0.25;
    missed_ += view.turned[side_] * size_ / (1.0 + std::exp(-too_fast));
    angle[side_] -= missed_;
  }

 private:
  std::size_t side_;
  double limit_;  // rad/s
  double missed_ = 0.0;
};

/// The drive counts a velocity that it has smoothed twice.
class EncoderFilter : public Effect {
 public:
  EncoderFilter(double lag, Random& /*random*/) : Effect("encoder_filter", lag) {}
  void on_encoder(const StepView& view, PerSide& angle) override {
    if (size_ <= 0.0) return;
    const double gain = 1.0 - std::exp(-view.dt / (0.5 * size_));
    for (const std::size_t side : {kLeft, kRight}) {
      first_[side] += gain * (angle[side] - first_[side]);
      second_[side] += gain * (first_[side] - second_[side]);
      angle[side] = second_[side];
    }
  }

 private:
  PerSide first_{}, second_{};
};

/// A wheel that sits loosely on its shaft: hard acceleration pushes it out, hard braking in, and there it
/// stays.
class LooseWheel : public Effect {
 public:
  LooseWheel(double change, Random& /*random*/) : Effect("loose_wheel", change) {}
  void on_step(const StepView& view, StepMotion& motion) override {
    const double push = 0.5 * (view.acceleration[kLeft] + view.acceleration[kRight]);
    if (push > kThreshold) seat_ = 1.0;
    if (push < -kThreshold) seat_ = -1.0;
    motion.track_width *= 1.0 + size_ * seat_;
  }

 private:
  static constexpr double kThreshold = 3.0;  // rad/s^2
  double seat_ = 1.0;
};

template <typename Kind>
auto drive_train_maker() {
  return [](double size, Random& random) -> std::shared_ptr<Disturbance> {
    return std::make_shared<Kind>(size, random);
  };
}

}  // namespace

std::vector<EffectKind> drive_train_effects() {
  return {
      {"gear_play", "backlash", {"reversal"}, "rad", 0.015, 0.06, drive_train_maker<GearPlay>()},
      {"encoder_disc_off_centre",
       "wheel_eccentricity",
       {"wheel_phase"},
       "1",
       0.01,
       0.03,
       drive_train_maker<EncoderDiscOffCentre>()},
      {"encoder_interpolation",
       "",
       {"wheel_phase"},
       "rad",
       0.01,
       0.03,
       drive_train_maker<EncoderInterpolation>()},
      {"missed_counts", "tick_loss", {"wheel_speed"}, "1", 0.005, 0.03, drive_train_maker<MissedCounts>()},
      {"encoder_filter",
       "encoder_lag",
       {"acceleration"},
       "s",
       0.015,
       0.08,
       drive_train_maker<EncoderFilter>()},
      {"loose_wheel", "", {"acceleration", "history"}, "1", 0.005, 0.02, drive_train_maker<LooseWheel>()},
  };
}

}  // namespace odomcalib::sim
