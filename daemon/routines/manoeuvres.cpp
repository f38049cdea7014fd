#include "daemon/routines/manoeuvres.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <span>
#include <vector>

#include "daemon/routines/settings.hpp"

namespace odomcalib::routines {
namespace {

/// Moves that are undone by their opposite, so that the robot is near its start after each block.
struct Builder {
  std::vector<Move> moves;
  double half;   // m, of the shorter side of the area
  double scale;  // of all lengths; 1 for an area of 2 m

  void out_and_back(double distance, double speed, double late = 0.0) {
    moves.push_back(straight(distance, speed, settings::kShortRest_s));
    moves.back().late_pace = late;
    moves.push_back(straight(-distance, speed, settings::kShortRest_s));
  }
  void both_spins(double angle, double rate) {
    moves.push_back(spin(angle, rate, settings::kShortRest_s));
    moves.push_back(spin(-angle, rate, settings::kShortRest_s));
  }
  /// All four combinations of signs of speed and turn rate, back at the start after each pair.
  void four_arcs(double radius, double angle, double rate) {
    for (const double side : {1.0, -1.0}) {
      moves.push_back(arc(radius, side * angle, rate, true, settings::kShortRest_s));
      moves.push_back(arc(radius, -side * angle, rate, false, settings::kShortRest_s));
    }
  }
  void face(double heading) { moves.push_back(turn_to(heading, settings::kFacing_rad_s)); }
};

/// For the free area of the options.
Builder builder_for(const PatternOptions& options) {
  const double side = std::min(options.area_length, options.area_width);
  const double half = std::clamp(0.5 * side, settings::kLeastHalf_m, settings::kMostHalf_m);
  return {.moves = {}, .half = half, .scale = std::min(1.0, half)};
}

void straights_on_four_headings(Builder& build) {
  const double d = 0.8 * build.half;
  build.face(0.5 * std::numbers::pi);
  build.out_and_back(d, 0.28);
  build.out_and_back(-0.5 * d, 0.13);
  build.face(std::numbers::pi);
  build.out_and_back(d, 0.17);
  build.out_and_back(-d, 0.25);
  build.face(-0.5 * std::numbers::pi);
  build.out_and_back(d, 0.1, 0.3);
  build.face(0.0);
}

/// How long a robot has to stand until something sticks only stops of different lengths can tell.
void vary_rests(std::span<Move> moves) {
  constexpr std::array<double, 7> kRests = {0.5, 0.15, 0.8, 0.3, 0.6, 0.2, 0.4};  // s
  for (std::size_t k = 0; k < moves.size(); ++k) moves[k].settle = kRests[k % kRests.size()];
}

/// How hard a push has to be until something gives way only pushes of different strengths can tell.
void vary_pushes(std::span<Move> moves) {
  constexpr std::array<double, 5> kHastes = {1.0, 0.35, 0.7, 0.25, 0.5};
  for (std::size_t k = 0; k < moves.size(); ++k) moves[k].haste = kHastes[k % kHastes.size()];
}

/// Three speeds over 1:3, forward and backward.
void straights(Builder& build) {
  for (const double speed : {0.3, 0.1, 0.2}) {
    build.out_and_back(0.8 * build.half, speed);
    build.out_and_back(-0.6 * build.half, speed);
  }
}

/// Many wheel turns at a pace at which matches lie close together.
void slow_straights(Builder& build) {
  for (int i = 0; i < 2; ++i) {
    build.out_and_back(0.8 * build.half, 0.08);
    build.out_and_back(-0.8 * build.half, 0.08);
  }
}

void turns(Builder& build, double track_width) {
  build.both_spins(2.0 * std::numbers::pi, 0.6);
  build.both_spins(std::numbers::pi, 0.3);
  build.both_spins(0.5 * std::numbers::pi, 0.15);
  build.four_arcs(0.5 * track_width, 0.5 * std::numbers::pi, 0.5);
}

/// Equal wheel speeds in turns of different radius, and one radius at two speeds.
void arcs(Builder& build) {
  const double tight = 0.3 * build.scale;
  const double wide = 0.6 * build.scale;
  build.four_arcs(tight, 0.4 * std::numbers::pi, 0.12 / tight);
  build.four_arcs(tight, 0.4 * std::numbers::pi, 0.6);
  build.four_arcs(wide, 0.35 * std::numbers::pi, 0.3 / wide);
}

/// Starts and stops at low and at high speed, forward and backward, and in turns.
void accelerations(Builder& build) {
  for (const double speed : {0.3, 0.1, 0.3}) {
    build.out_and_back(0.4 * build.half, speed);
    build.out_and_back(-0.4 * build.half, speed);
  }
  build.both_spins(0.5 * std::numbers::pi, 0.6);
  build.both_spins(0.3 * std::numbers::pi, 0.2);
  vary_rests(build.moves);
  vary_pushes(build.moves);
}

/// Every wheel reverses often, slowly and fast, with and without the robot's direction of travel.
void reversals(Builder& build) {
  for (const double speed : {0.1, 0.3}) {
    build.out_and_back(0.25 * build.half, speed);
    build.out_and_back(-0.25 * build.half, speed);
    build.both_spins(0.25 * std::numbers::pi, 2.0 * speed);
    build.out_and_back(0.25 * build.half, speed);
    build.both_spins(0.25 * std::numbers::pi, 2.0 * speed);
  }
  build.four_arcs(0.3 * build.scale, 0.3 * std::numbers::pi, 0.5);
}

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

std::optional<Plan> manoeuvre_plan(const std::string& name, const PatternOptions& options) {
  Builder build = builder_for(options);
  if (name == "straights") straights(build);
  if (name == "slow_straights") slow_straights(build);
  if (name == "turns") turns(build, options.track_width);
  if (name == "arcs") arcs(build);
  if (name == "accelerations") accelerations(build);
  if (name == "reversals") reversals(build);
  if (name == "headings") straights_on_four_headings(build);
  if (build.moves.empty()) return std::nullopt;
  return Plan{.name = name, .moves = build.moves, .limits = options.limits};
}

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
