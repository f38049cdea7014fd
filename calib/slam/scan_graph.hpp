// From scans and odometry to a pose graph: consecutive keyframes are matched, places seen again are found,
// questioned and tied together, and the graph is settled after each of them. A false loop ruins a map and a
// missed one only leaves it as good as it was: a loop that is not certain is refused, and every refusal is
// recorded.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "calib/math/se2.hpp"
#include "calib/slam/loop_check.hpp"
#include "calib/slam/settings.hpp"
#include "proto/recording/pose_graph.hpp"

namespace odomcalib::calib::slam {

/// Step measured = step by odometry + B (step by odometry), B a 3 x 3 matrix about zero: the linear method of
/// estimators/linear.hpp, recursive and with a prior.
class OdometryCorrection {
 public:
  /// @param sigma m and rad, of a step by odometry before anything is learnt; never stated larger afterwards
  explicit OdometryCorrection(double sigma);

  /// A step as odometry has it, and as scans measured it.
  void learn(const math::Pose& odometry, const math::Pose& measured);
  [[nodiscard]] math::Pose corrected(const math::Pose& odometry) const;
  /// Standard deviation of a corrected step: m, m, rad.
  [[nodiscard]] const Eigen::Vector3d& sigma() const { return sigma_; }

 private:
  double first_sigma_;
  Eigen::Matrix3d information_, products_;  ///< of the steps, in units of the error's variance
  Eigen::Matrix3d systematic_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sigma_, squares_;
  double count_;
};

/// Spacing of the scans of a drive that become vertices of its graph.
struct KeyframeSpacing {
  double distance = settings::kKeyframeDistance_m;    ///< m of travel, or ...
  double rotation = settings::kKeyframeRotation_rad;  ///< rad turned either way
};

/// The first pose, and each after which one of the two is reached since the last one chosen. Travel and turn
/// are those of the path, so that a robot that comes back in between is noticed.
std::vector<std::size_t> choose_keyframes(std::span<const math::Pose> odometry,
                                          const KeyframeSpacing& spacing);

struct ScanGraphOptions {
  KeyframeSpacing spacing;
  LoopCheckOptions loop;  ///< window: of the least search; it grows with the way since the last loop
  /// m of path, turns counted, before a place counts as seen again.
  double min_way_round = settings::kLeastWayRound_m;
  /// m and rad of error that matches and odometry gather per root of a metre.
  double drift = settings::kDrift;
  /// m and rad per step, where a match fails and odometry stands in.
  double odometry_sigma = settings::kOdometrySigma;
};

/// How an edge came about.
enum class EdgeSource { match, odometry, loop };

struct ScanGraph {
  PoseGraph graph;                             ///< vertices are keyframes, poses those of the sensor, settled
  std::vector<std::size_t> scans;              ///< of each vertex
  std::vector<EdgeSource> sources;             ///< of each edge
  std::vector<double> overlaps;                ///< of each edge, as in MatchResult; 0 for odometry
  std::map<std::string, std::size_t> refused;  ///< reason -> candidates for loops
  [[nodiscard]] std::size_t count(EdgeSource source) const;
};

/// @param surfaces of all scans in time order, in the sensor's frame
/// @param odometry poses of the sensor at those scans
ScanGraph build_scan_graph(std::span<const matching::Surface> surfaces, std::span<const math::Pose> odometry,
                           const ScanGraphOptions& options);

}  // namespace odomcalib::calib::slam
