#include "daemon/routines/plans.hpp"

#include <numbers>

#include "daemon/routines/settings.hpp"

namespace odomcalib::routines {

Plan straight_plan(const StraightOptions& options) {
  Plan plan{.name = "straight", .moves = {}, .limits = options.limits};
  for (int i = 0; i < options.repeat; ++i) {
    plan.moves.push_back(straight(options.distance, options.speed, settings::kRest_s));
    if (!options.one_way) plan.moves.push_back(straight(-options.distance, options.speed, settings::kRest_s));
  }
  return plan;
}

Plan spin_plan(const SpinOptions& options) {
  Plan plan{.name = "spin", .moves = {}, .limits = options.limits};
  const double angle = 2.0 * std::numbers::pi * options.turns;
  for (int i = 0; i < options.repeat; ++i) {
    if (options.left) plan.moves.push_back(spin(angle, options.rate, settings::kRest_s));
    if (options.right) plan.moves.push_back(spin(-angle, options.rate, settings::kRest_s));
  }
  return plan;
}

Plan square_plan(const SquareOptions& options) {
  Plan plan{.name = "square", .moves = {}, .limits = options.limits};
  for (int i = 0; i < 2 * options.repeat; ++i)
    for (int side = 0; side < 4; ++side) {
      plan.moves.push_back(straight(options.side, options.speed, settings::kRest_s));
      plan.moves.push_back(
          spin((i % 2 == 0 ? 0.5 : -0.5) * std::numbers::pi, options.rate, settings::kRest_s));
    }
  return plan;
}

}  // namespace odomcalib::routines
