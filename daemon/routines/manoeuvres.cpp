#include "daemon/routines/manoeuvres.hpp"
#include "daemon/routines/settings.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace odomcalib::routines {
namespace {

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

}  // namespace

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

void vary_rests(std::span<Move> moves) {
  constexpr std::array<double, 7> kRests = {0.5, 0.15, 0.8, 0.3, 0.6, 0.2, 0.4};  // s
  for (std::size_t k = 0; k < moves.size(); ++k) moves[k].settle = kRests[k % kRests.size()];
}

void vary_pushes(std::span<Move> moves) {
  constexpr std::array<double, 5> kHastes = {1.0, 0.35, 0.7, 0.25, 0.5};
  for (std::size_t k = 0; k < moves.size(); ++k) moves[k].haste = kHastes[k % kHastes.size()];
}

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

}  // namespace odomcalib::routines
