// The guided motions that people ask for by name.
#pragma once

#include "daemon/routines/motion.hpp"

namespace odomcalib::routines {

struct StraightOptions {
  double distance = 1.0;  ///< m; negative: backwards first
  double speed = 0.20;    ///< m/s
  int repeat = 1;         ///< times out and back
  bool one_way = false;   ///< no way back: somebody wants to measure where it stands
  Limits limits;
};
/// Out, rest, back, rest.
Plan straight_plan(const StraightOptions& options);

struct SpinOptions {
  double turns = 1.0;  ///< full turns
  double rate = 0.4;   ///< rad/s
  bool left = true;    ///< counter-clockwise
  bool right = true;   ///< clockwise, after the turn to the left
  int repeat = 1;
  Limits limits;
};
Plan spin_plan(const SpinOptions& options);

struct SquareOptions {
  double side = 1.0;    ///< m
  double speed = 0.20;  ///< m/s
  double rate = 0.4;    ///< rad/s
  int repeat = 1;       ///< times both ways
  Limits limits;
};
/// Moves of a square in one direction: four sides, each with a turn after it.
inline constexpr std::size_t kMovesOfSquare = 8;
/// Counter-clockwise, then clockwise, each from the start back to it.
Plan square_plan(const SquareOptions& options);

}  // namespace odomcalib::routines
