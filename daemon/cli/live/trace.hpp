// A path that grows while it is looked at, with a bounded number of points.
#pragma once

#include <optional>
#include <vector>

#include "calib/math/se2.hpp"
#include "daemon/cli/settings.hpp"

namespace odomcalib::cli {

using calib::math::Pose;

/// Shows poses of a source whose own frame begins anywhere: the first pose after a restart continues where
/// the path ends, in the direction that it has there.
class Trace {
 public:
  static constexpr std::size_t kMostPoints = settings::kMostPoints;
  static constexpr double kSpacing =
      settings::kSpacing_m;  ///< between points, doubled when there are too many

  /// @param points m, rad; what is shown from now on. Empty: nothing, until poses arrive at the origin.
  void restart(const std::vector<Pose>& points);
  /// The robot rests here, in the source's frame: the frame continues from this pose, not from the next one.
  void continue_from(const Pose& source);
  void add(const Pose& source);

  [[nodiscard]] const std::vector<Pose>& points() const { return points_; }
  /// Where the source is now, in the frame that is shown; nullopt before its first pose.
  [[nodiscard]] const std::optional<Pose>& now() const { return now_; }

 private:
  void append(const Pose& shown);

  std::vector<Pose> points_;
  std::optional<Pose> now_;
  std::optional<Pose> from_source_;  ///< to what is shown
  double spacing_ = kSpacing;
};

}  // namespace odomcalib::cli
