#include "calib/terms/effects/step_effect.hpp"
#include "proto/angles.hpp"

namespace odomcalib::calib::terms {
namespace {

// Trailing casters swing through half a turn after a reversal and push the chassis aside: the yaw added after
// the distance s since the reversal falls off as exp(-s / length), with a length of two to four caster
// trails. The side it swings to follows the direction of travel, the turn before (kappa_turn), or is always
// the same (kappa_side). One that stands nearly straight has to fall over first: the push then grows with s
// before it fades (order 2). After turns too, the push may follow the angle by which the caster points past
// the way of its pivot, the length being its trail and the lean what is left of that angle when it has
// settled (order 0).
class CasterKick final : public StepEffect<CasterKick> {
 public:
  CasterKick(double length, double order, double lean = 0.0) : StepEffect(row(length, order, lean)) {}

  static vehicle::EffectRow row(double length, double order, double lean) {
    return {
        .name = "caster_kick",
        .parameters =
            {{.name = "kappa",
              .unit = "rad",
              .scale = 0.01,
              .lower = -0.2,
              .upper = 0.2,
              .meaning = {.label = "by direction of travel",
                          .factor = kDegrees,
                          .unit = "deg",
                          .is =
                              "turn after a reversal, to the side that changes with the direction of travel",
                          .said =
                              "the caster turns the robot by {} after a reversal, by direction of travel"}},
             {.name = "kappa_turn",
              .unit = "rad",
              .scale = 0.01,
              .lower = -0.2,
              .upper = 0.2,
              .meaning = {.label = "by the turn before",
                          .factor = kDegrees,
                          .unit = "deg",
                          .is = "turn after a reversal, to the side that the turn before gives",
                          .said = "the caster turns the robot by {} after a reversal, by the turn before"}},
             {.name = "kappa_side",
              .unit = "rad",
              .scale = 0.01,
              .lower = -0.2,
              .upper = 0.2,
              .meaning = {.label = "to one side",
                          .factor = kDegrees,
                          .unit = "deg",
                          .is = "turn after a reversal, always to the same side",
                          .said = "the caster turns the robot {} to the [left|right] after a reversal"}},
             {.name = "length",
              .unit = "m",
              .scale = 1e9,
              .lower = 0.005,
              .upper = 1.0,
              .start = length,
              .fixed = order == 0.0,
              .meaning = {.label = "fades over",
                          .factor = 1e3,
                          .unit = "mm",
                          .is = "way over which it fades to a third"}},
             {.name = "order",
              .unit = "1",
              .scale = 1e9,
              .lower = 0.0,
              .upper = 2.0,
              .start = order,
              .fixed = true,
              .meaning = {.label = "form (0, 1 or 2)",
                          .is = "2: it rises before it fades; 1: it fades from the reversal on; 0: it "
                                "follows the caster's angle"}},
             {.name = "lean",
              .unit = "rad",
              .scale = 1e9,
              .lower = -0.1,
              .upper = 0.1,
              .start = lean,
              .fixed = true,
              .meaning = {.label = "angle at rest",
                          .factor = kDegrees,
                          .unit = "deg",
                          .is = "angle that the caster keeps when it has settled"}}},
        .aliases = {"backlash", "time_offset"},
        .separating_motion =
            "reversals straight after a left and after a right arc, and long straights after a reversal",
        .manoeuvre = "reversals",
        .dependences = {{vehicle::Covariate::since_reversal, vehicle::Channel::yaw_path}},
        .covariates = {vehicle::CovariateGroup::caster, vehicle::CovariateGroup::previous_turn}};
  }

  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const double length : {0.04, 0.08, 0.15}) all.push_back(std::make_shared<CasterKick>(length, 1.0));
    for (const double length : {0.04, 0.08}) all.push_back(std::make_shared<CasterKick>(length, 2.0));
    for (const double length : vehicle::kCasterTrails)
      for (const double lean : vehicle::kCasterLeans)
        all.push_back(std::make_shared<CasterKick>(length, 0.0, lean));
    return all;
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    using std::exp;
    if (plain(p[4]) < 0.5) {
      step.yaw += p[0] * c.caster()[nearest_caster(plain(p[3]), plain(p[5]))] * c.way / p[3];
      return;
    }
    const T side = p[0] * c.direction + p[1] * c.previous_turn[vehicle::kUsualMemory] + p[2];
    const T distance = c.since_reversal / p[3];
    const T rise = p[4] > 1.5 ? distance : T(1.0);
    step.yaw += side * (c.way / p[3]) * rise * exp(-distance);
  }

 private:
  static std::size_t nearest_caster(double trail, double lean) {
    return vehicle::nearest_of(vehicle::kCasterTrails, trail) * vehicle::kCasterLeans.size() +
           vehicle::nearest_of(vehicle::kCasterLeans, lean);
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_caster_kick() { return std::make_shared<CasterKick>(0.08, 1.0); }

}  // namespace odomcalib::calib::terms
