// The guided motions that people ask for by name.
#pragma once

#include "daemon/routines/motion.hpp"

namespace odomcalib::routines {

struct StraightOptions {
  double distance = 1.0;  ///< m; negative: backwards first
  double speed = 0.20;    ///< m/s
  int repeat = 1;         ///< times out and back
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

}  // namespace odomcalib::routines
