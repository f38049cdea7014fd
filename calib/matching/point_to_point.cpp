#include "calib/matching/point_to_point.hpp"

#include <cmath>
#include <vector>

#include "calib/matching/settings.hpp"
#include "calib/math/vector2.hpp"

namespace odomcalib::calib::matching {
namespace {

constexpr double kStill = 1e-9;  ///< m and rad, a step that only rounding makes

struct Pairs {
  std::vector<Eigen::Vector2d> from, onto;
  double squares = 0.0;  ///< m^2
};

Pairs nearest_pairs(const NearestTree& reference, std::span<const Eigen::Vector2d> scan,
                    const math::Pose& pose, double max_distance) {
  const math::Frame frame(pose);
  Pairs pairs;
  for (const Eigen::Vector2d& p : scan) {
    const Eigen::Vector2d moved = frame.transform(p);
    const Neighbour partner = reference.nearest(moved);
    if (partner.squared_distance > max_distance * max_distance) continue;
    pairs.from.push_back(p);
    pairs.onto.push_back(reference.points()[partner.index]);
    pairs.squares += partner.squared_distance;
  }
  return pairs;
}

bool is_still(const math::Pose& step) {
  return std::hypot(step.x, step.y) < kStill && std::abs(step.yaw) < kStill;
}

}  // namespace

math::Pose align_points(std::span<const Eigen::Vector2d> from, std::span<const Eigen::Vector2d> onto) {
  Eigen::Vector2d from_centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d onto_centre = Eigen::Vector2d::Zero();
  const double n = static_cast<double>(from.size());
  for (const Eigen::Vector2d& p : from) from_centre += p / n;
  for (const Eigen::Vector2d& p : onto) onto_centre += p / n;
  double cosine = 0.0;
  double sine = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector2d a = from[i] - from_centre;
    const Eigen::Vector2d b = onto[i] - onto_centre;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const double yaw = std::atan2(sine, cosine);
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {onto_centre.x() - c * from_centre.x() + s * from_centre.y(),
          onto_centre.y() - s * from_centre.x() - c * from_centre.y(), yaw};
}

IcpResult match_point_to_point(const NearestTree& reference, std::span<const Eigen::Vector2d> scan,
                               const math::Pose& guess, const IcpOptions& options) {
  IcpResult result{guess};
  if (reference.points().size() < settings::kFewestIcpPoints || scan.size() < settings::kFewestIcpPoints)
    return result;
  bool still = false;
  for (int i = 0; i < options.max_iterations && !still; ++i) {
    const Pairs pairs = nearest_pairs(reference, scan, result.motion, options.max_distance);
    result.overlap = static_cast<double>(pairs.from.size()) / static_cast<double>(scan.size());
    if (pairs.from.size() < settings::kFewestIcpPoints) return result;
    result.rms = std::sqrt(pairs.squares / static_cast<double>(pairs.from.size()));
    const math::Pose next = align_points(pairs.from, pairs.onto);
    const math::Pose step = between(result.motion, next);
    still = is_still({step.x, step.y, math::wrap_angle(step.yaw)});
    result.motion = next;
  }
  result.converged = still && result.overlap >= options.min_overlap;
  return result;
}

}  // namespace odomcalib::calib::matching
