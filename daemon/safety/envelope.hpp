// Rules M8 and M9: a motion that leaves its expected size, or that odometry and lidar tell differently, ends.
#pragma once

#include <optional>
#include <string>

#include "daemon/routines/motion.hpp"

namespace odomcalib::safety {

/// Limits of one run, from the preview of its plan.
struct Envelope {
  double reach = 0.0;  ///< m from the start
  double turn = 0.0;   ///< rad, largest heading away from the start's, continuous over full turns
  double time = 0.0;   ///< s

  /// 1.3 times the farthest point, 1.25 times the largest turn, 1.5 times the time.
  static Envelope of(const routines::Preview& preview);
  /// @param turned rad since the start, continuous; @param elapsed s
  [[nodiscard]] std::optional<std::string> violated(const routines::Pose& from_start, double turned,
                                                    double elapsed) const;
};

/// Base motion since a common start, by odometry and by the lidar. Judged after 0.1 m or 30 degrees:
/// more than 15 % apart means slipping wheels, a blocked wheel, swapped sides or a wrong encoder.
std::optional<std::string> disagreement(const routines::Pose& odometry, const routines::Pose& lidar);

}  // namespace odomcalib::safety
