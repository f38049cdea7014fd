// Outcome of the moves of a motion, beside its recording.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/service/calibrator.hpp"
#include "daemon/service/json_text.hpp"
#include "daemon/service/motion_run.hpp"

namespace odomcalib {

using nlohmann::ordered_json;

/// Turns of the left and the right wheel during a move, rad.
std::array<double, 2> wheel_turns(const Leg& leg, double ticks_per_rev);

/// Where the lidar sits, m and rad in the frame of the base: as calibrated, else as configured.
std::array<double, 3> lidar_pose(const std::optional<Calibration>& applied, const Config& config);

/// Odometry and lidar from rest to rest, of each move or of rounds of several. Comparing scans takes time:
/// the loop does it pair by pair, a turn each.
class MovesReport {
 public:
  /// @param calibrator outlives this
  /// @param moves_in_round after so many the robot is back at its start: rounds are compared then, and nobody
  /// needs the lidar's view of their moves; 0: each move is compared
  MovesReport(const Calibrator& calibrator, std::vector<Leg> legs, std::size_t moves_in_round);

  /// Compares one more pair of scans. @return false where all have been
  bool compare_next(const std::array<double, 3>& lidar_pose);
  /// {"moves": [...], "robot": {...}, "driven": {...}} and with rounds "rounds": wheels, odometry and lidar,
  /// the values that odometry goes by and whose they are, and when the moves were driven.
  /// @param robot with these values
  /// @param since_1970 s, what the date is ahead of the times of the legs; "driven" is left out where it
  /// tells no date
  [[nodiscard]] ordered_json body(const RobotDescription& robot, double since_1970) const;

 private:
  /// Base motion between two moments at rest, in the frame of the first.
  struct Comparison {
    std::size_t from, to;  ///< legs
    routines::Pose by_odometry;
    std::size_t pairs, tried = 0;  ///< of scans
    routines::Pose sum = {};       ///< over the pairs that match, by the lidar
    std::size_t matched = 0;
  };
  static void add(const Comparison& comparison, ordered_json& body);

  const Calibrator& calibrator_;
  std::vector<Leg> legs_;
  bool in_rounds_;
  std::vector<Comparison> comparisons_;  // in the order of the legs
  std::size_t next_ = 0;
};

/// Report of a nudge: {"checks": these rows of `check` with one or more about the wiring, "wiring": what
/// was measured}
ordered_json nudge_report(ordered_json checks, const Calibrator& calibrator, const RobotDescription& robot,
                          const std::vector<Leg>& legs);

}  // namespace odomcalib
