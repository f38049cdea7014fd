#include "daemon/routines/pattern.hpp"

#include <algorithm>
#include <numbers>

#include "daemon/routines/builder.hpp"
#include "daemon/routines/manoeuvres.hpp"
#include "daemon/routines/settings.hpp"

namespace odomcalib::routines {
namespace {

/// With the straights on four headings these are seven speeds.
void slow_and_fast_straights(Builder& build) {
  build.out_and_back(0.5 * build.half, 0.1);
  build.out_and_back(0.8 * build.half, 0.3);
  build.out_and_back(-0.6 * build.half, 0.2);
}

void all_spins(Builder& build) {
  build.both_spins(2.0 * std::numbers::pi, 0.6);
  build.both_spins(0.5 * std::numbers::pi, 0.3);
  build.both_spins(0.3 * std::numbers::pi, 0.15);
}

void all_arcs(Builder& build) {
  const double tight = 0.3 * build.scale;
  const double wide = 0.7 * build.scale;
  build.four_arcs(tight, 0.6 * std::numbers::pi, 0.12 / tight);
  build.four_arcs(tight, 0.6 * std::numbers::pi, 0.6);
  build.four_arcs(wide, 0.3 * std::numbers::pi, 0.15 / wide);
  build.four_arcs(wide, 0.45 * std::numbers::pi, 0.3 / wide);
}

void single_wheel_turns(Builder& build, double track_width) {
  const double radius = 0.5 * track_width;
  build.four_arcs(radius, 0.75 * std::numbers::pi, 0.5);
}

/// A law of speed is known where the robot drove: every speed of either wheel is passed, slowly (the
/// quasi-static test of system identification), forward and backward.
void slow_ramps(Builder& build) {
  const double way = 1.4 * build.half;
  build.moves.push_back(straight(-0.5 * way, 0.2, settings::kShortRest_s));
  const std::size_t first = build.moves.size();
  build.out_and_back(way, 0.3);
  build.both_spins(1.5 * std::numbers::pi, 0.6);
  for (std::size_t k = first; k < build.moves.size(); ++k)
    build.moves[k].haste =
        build.moves[k].direction.w == 0.0 ? settings::kStraightHaste : settings::kSpinHaste;
  build.moves.push_back(straight(0.5 * way, 0.2, settings::kShortRest_s));
}

void full_pattern(Builder& build, double track_width) {
  slow_and_fast_straights(build);
  straights_on_four_headings(build);
  all_spins(build);
  build.face(0.0);
  all_arcs(build);
  build.face(0.0);
  single_wheel_turns(build, track_width);
  vary_rests(build.moves);
  vary_pushes(build.moves);
  build.face(0.0);
  slow_ramps(build);
  build.face(0.0);
}

void quick_pattern(Builder& build, double track_width) {
  build.out_and_back(-0.6 * build.half, 0.3);
  build.face(0.5 * std::numbers::pi);
  build.out_and_back(0.6 * build.half, 0.15);
  build.face(0.0);
  build.both_spins(std::numbers::pi, 0.5);
  build.four_arcs(0.4 * build.scale, 0.4 * std::numbers::pi, 0.5);
  build.four_arcs(0.5 * track_width, 0.4 * std::numbers::pi, 0.5);
  build.face(0.0);
}

}  // namespace

Plan pattern_plan(const PatternOptions& options) {
  Builder build = builder_for(options);
  const double half = build.half;
  build.out_and_back(0.8 * half, 0.2);
  if (options.quick)
    quick_pattern(build, options.track_width);
  else
    full_pattern(build, options.track_width);
  build.out_and_back(0.8 * half, 0.2);
  return {
      .name = options.quick ? "quick pattern" : "pattern", .moves = build.moves, .limits = options.limits};
}

}  // namespace odomcalib::routines
