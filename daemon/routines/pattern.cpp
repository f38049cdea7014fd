#include "daemon/routines/pattern.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

namespace odomcalib::routines {
namespace {

constexpr double kPi = std::numbers::pi;
// Short rests: a rest costs time, but each one is a chance to match scans of a standing robot.
constexpr double kRest = 0.5;

struct Builder {
  std::vector<Move> moves;
  double half;   // m, of the shorter side of the area
  double scale;  // of all lengths; 1 for an area of 2 m

  void out_and_back(double distance, double speed, double late = 0.0) {
    moves.push_back(straight(distance, speed, kRest));
    moves.back().late_pace = late;
    moves.push_back(straight(-distance, speed, kRest));
  }
  void both_spins(double angle, double rate) {
    moves.push_back(spin(angle, rate, kRest));
    moves.push_back(spin(-angle, rate, kRest));
  }
  /// All four combinations of signs of speed and turn rate, back at the start after each pair.
  void four_arcs(double radius, double angle, double rate) {
    for (const double side : {1.0, -1.0}) {
      moves.push_back(arc(radius, side * angle, rate, true, kRest));
      moves.push_back(arc(radius, -side * angle, rate, false, kRest));
    }
  }
  void face(double heading) { moves.push_back(turn_to(heading, 0.5)); }
};

void straights_on_four_headings(Builder& build) {
  const double d = 0.8 * build.half;
  build.face(0.5 * kPi);
  build.out_and_back(d, 0.3);
  build.out_and_back(-0.5 * d, 0.1);
  build.face(kPi);
  build.out_and_back(d, 0.2);
  build.out_and_back(-d, 0.3);
  build.face(-0.5 * kPi);
  build.out_and_back(d, 0.1, 0.3);
  build.face(0.0);
}

void slow_and_fast_straights(Builder& build) {
  build.out_and_back(0.5 * build.half, 0.1);
  build.out_and_back(0.8 * build.half, 0.3);
  build.out_and_back(-0.6 * build.half, 0.2);
}

void all_spins(Builder& build) {
  build.both_spins(2.0 * kPi, 0.6);
  build.both_spins(kPi, 0.3);
  build.both_spins(0.4 * kPi, 0.15);
}

void all_arcs(Builder& build) {
  const double tight = 0.3 * build.scale;
  const double wide = 0.7 * build.scale;
  build.four_arcs(tight, 0.6 * kPi, 0.12 / tight);
  build.four_arcs(tight, 0.6 * kPi, 0.6);
  build.four_arcs(wide, 0.45 * kPi, 0.15 / wide);
  build.four_arcs(wide, 0.45 * kPi, 0.3 / wide);
}

void single_wheel_turns(Builder& build, double track_width) {
  const double radius = 0.5 * track_width;
  build.four_arcs(radius, 0.75 * kPi, 0.5);
}

void full_pattern(Builder& build, double track_width) {
  slow_and_fast_straights(build);
  straights_on_four_headings(build);
  all_spins(build);
  build.face(0.0);
  all_arcs(build);
  build.face(0.0);
  single_wheel_turns(build, track_width);
  build.face(0.0);
}

void quick_pattern(Builder& build, double track_width) {
  build.out_and_back(-0.6 * build.half, 0.3);
  build.face(0.5 * kPi);
  build.out_and_back(0.6 * build.half, 0.15);
  build.face(0.0);
  build.both_spins(kPi, 0.5);
  build.four_arcs(0.4 * build.scale, 0.4 * kPi, 0.5);
  build.four_arcs(0.5 * track_width, 0.4 * kPi, 0.5);
  build.face(0.0);
}

}  // namespace

Plan pattern_plan(const PatternOptions& options) {
  const double side = std::min(options.area_length, options.area_width);
  const double half = std::clamp(0.5 * side, 0.3, 1.25);
  Builder build{.moves = {}, .half = half, .scale = std::min(1.0, half)};
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
