#include <algorithm>

#include "calib/terms/effects/step_effect.hpp"
#include "proto/angles.hpp"

namespace odomcalib::calib::terms {
namespace {

/// The motor turns through the play before the wheel follows: after each reversal of a wheel that wheel
/// misses the play g, whatever its speed; after one within the play it misses what it has to go back. What
/// gives way instead of being loose (a belt, a friction wheel) misses as much over a longer way, the more the
/// nearer to the reversal.
class Backlash final : public StepEffect<Backlash> {
 public:
  /// @param spread over which the loss falls off exponentially, rad; 0: play
  explicit Backlash(double spread) : StepEffect(row(spread)) {}

  static vehicle::EffectRow row(double spread) {
    return {
        .name = "backlash",
        .parameters =
            {{.name = "left_play",
              .unit = "rad",
              .scale = 0.02,
              .lower = -0.3,
              .upper = 0.3,
              .meaning = {.label = "left gear",
                          .factor = kDegrees,
                          .unit = "deg",
                          .is = "angle that the left motor turns before the wheel follows, after a reversal",
                          .said = "play of {} in the left gear"}},
             {.name = "right_play",
              .unit = "rad",
              .scale = 0.02,
              .lower = -0.3,
              .upper = 0.3,
              .meaning = {.label = "right gear",
                          .factor = kDegrees,
                          .unit = "deg",
                          .is = "angle that the right motor turns before the wheel follows, after a reversal",
                          .said = "play of {} in the right gear"}},
             {.name = "spread",
              .unit = "rad",
              .scale = 1e9,
              .lower = 0.0,
              .upper = 1.0,
              .start = spread,
              .fixed = true,
              .meaning = {.label = "taken up over",
                          .factor = kDegrees,
                          .unit = "deg",
                          .is = "angle over which it is missed; 0: at once"}}},
        .aliases = {"time_offset", "caster_kick"},
        .separating_motion =
            "reversals at low and high speed; spins left and right, where the wheels reverse and the robot "
            "does not",
        .manoeuvre = "reversals",
        .dependences = {{vehicle::Covariate::left_since_reversal, vehicle::Channel::left_travel},
                        {vehicle::Covariate::right_since_reversal, vehicle::Channel::right_travel}},
        .covariates = {vehicle::CovariateGroup::gear_play}};
  }

  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const double spread : {0.0, 0.05, 0.15}) all.push_back(std::make_shared<Backlash>(spread));
    return all;
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    const double spread = plain(p[2]);
    if (spread > 0.0) {
      fade(c.left_since_reversal, c.left_delta, p[0], spread, step.left);
      fade(c.right_since_reversal, c.right_delta, p[1], spread, step.right);
      return;
    }
    const vehicle::LostByWheels& lost = c.lost_to_play();
    lose(lost.left, c.left_delta, p[0], step.left);
    lose(lost.right, c.right_delta, p[1], step.right);
  }

 private:
  template <typename T>
  static void fade(double since, double delta, const T& play, double spread, T& travel) {
    if (since > 20.0 * spread || std::abs(delta) < 1e-9) return;
    const double share = std::exp(-since / spread) - std::exp(-(since + std::abs(delta)) / spread);
    travel *= 1.0 - play * (share / std::abs(delta));
  }

  /// The loss to a play is known of kPlays; in between it is interpolated, from nothing on.
  template <typename T>
  static void lose(const vehicle::LostToPlay& lost, double delta, const T& play, T& travel) {
    if (std::abs(delta) < 1e-9) return;
    const double size = std::min(std::abs(plain(play)), vehicle::kPlays.back());
    const auto next = static_cast<std::size_t>(
        std::lower_bound(vehicle::kPlays.begin(), vehicle::kPlays.end(), size) - vehicle::kPlays.begin());
    const double play_before = next > 0 ? vehicle::kPlays[next - 1] : 0.0,
                 lost_before = next > 0 ? lost[next - 1] : 0.0;
    const double slope = (lost[next] - lost_before) / (vehicle::kPlays[next] - play_before);
    const T magnitude = plain(play) < 0.0 ? T(-play) : play;
    const T loss = lost_before + slope * (magnitude - play_before);
    travel *= 1.0 - (plain(play) < 0.0 ? T(-loss) : loss) / delta;
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_backlash() { return std::make_shared<Backlash>(0.0); }

}  // namespace odomcalib::calib::terms
