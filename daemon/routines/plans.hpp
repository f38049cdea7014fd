// The guided motions that people ask for by name.
#pragma once

#include "daemon/routines/motion.hpp"
#include "daemon/routines/settings.hpp"

namespace odomcalib::routines {

struct StraightOptions {
  double distance = settings::kUsualWay_m;   ///< m; negative: backwards first
  double speed = settings::kUsualSpeed_m_s;  ///< m/s
  int repeat = 1;                            ///< times out and back
  bool one_way = false;                      ///< no way back: somebody wants to measure where it stands
  Limits limits;
};
/// Out, rest, back, rest.
Plan straight_plan(const StraightOptions& options);

struct SpinOptions {
  double turns = settings::kUsualTurns;      ///< full turns
  double rate = settings::kUsualRate_rad_s;  ///< rad/s
  bool left = true;                          ///< counter-clockwise
  bool right = true;                         ///< clockwise, after the turn to the left
  int repeat = 1;
  Limits limits;
};
Plan spin_plan(const SpinOptions& options);

struct SquareOptions {
  double side = settings::kUsualWay_m;       ///< m
  double speed = settings::kUsualSpeed_m_s;  ///< m/s
  double rate = settings::kUsualRate_rad_s;  ///< rad/s
  int repeat = 1;                            ///< times both ways
  Limits limits;
};
/// Moves of a square in one direction: four sides, each with a turn after it.
inline constexpr std::size_t kMovesOfSquare = 8;
/// Counter-clockwise, then clockwise, each from the start back to it.
Plan square_plan(const SquareOptions& options);

}  // namespace odomcalib::routines
