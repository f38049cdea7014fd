#include "calib/lidar/heading_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "calib/matching/point_to_line.hpp"

namespace odomcalib::calib {
namespace {

constexpr double kNear = 0.8;                             // m between the two sensors
constexpr double kLongest = 40.0;                         // s apart: odometry must still be a guess
constexpr double kGate = 0.08;                            // m
constexpr double kMinAgreement = 0.97;                    // cosine of the normals (14 degrees)
constexpr double kMinIncidence = 0.3;                     // cosine
constexpr double kMargin = 0.25;                          // m, the reach of a local line
constexpr std::array kTurns = {2.4, 1.2, 3.0, 0.7, 1.8};  // rad, wanted between the scans of a pair
constexpr double kTurnTolerance = 0.3;                    // rad

double turn_between(const Pose& a, const Pose& b) { return std::abs(wrap_angle(b.yaw - a.yaw)); }

/// Which scan to compare with `from`.
std::optional<std::size_t> partner_of(const ScanSurfaces& scans, std::size_t from, double turn,
                                      const std::vector<bool>& used) {
  const auto& poses = scans.odometry();
  for (std::size_t k = from + 1; k < poses.size() && scans.times()[k] - scans.times()[from] < kLongest; ++k) {
    const Pose step = between(poses[from], poses[k]);
    if (used[k] || std::hypot(step.x, step.y) > kNear) continue;
    if (std::abs(turn_between(poses[from], poses[k]) - turn) < kTurnTolerance) return k;
  }
  return std::nullopt;
}

/// Pairs of scans, spread over the recording.
std::vector<HeadingPair> choose(const ScanSurfaces& scans, std::size_t most) {
  std::vector<HeadingPair> chosen;
  const std::size_t count = scans.times().size();
  std::vector<bool> used(count, false);
  const std::size_t stride = std::max<std::size_t>(1, count / (2 * most));
  for (std::size_t k = 0; k < count && chosen.size() < most; k += stride) {
    if (used[k]) continue;
    const auto partner = partner_of(scans, k, kTurns[chosen.size() % kTurns.size()], used);
    if (!partner || scans.gap_between(k, *partner) != nullptr) continue;
    used[k] = used[*partner] = true;
    chosen.push_back({k, *partner, {}});
  }
  return chosen;
}

Eigen::Vector2d rotated(double yaw, const Eigen::Vector2d& v) {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

/// A straight surface that the first scan knows from all its readings, seen from one of the sensors.
/// Regressors made from single readings would carry those readings' noise, which is the residual's.
struct Plane {
  Eigen::Vector2d centre, normal;  ///< in the first scan's frame; the normal towards the sensors

  /// How the surface is seen along a beam; the range is where the beam meets it.
  [[nodiscard]] Sighting seen(const Eigen::Vector2d& sensor, const Eigen::Vector2d& beam,
                              double bearing) const {
    const Eigen::Vector2d back = -beam;
    return {bearing, normal.dot(centre - sensor) / normal.dot(beam),
            std::atan2(normal.x() * back.y() - normal.y() * back.x(), normal.dot(back))};
  }
};

/// The wall that a point of the first scan lies on, if the position is away from its ends: there
/// neighbourhoods are cut off.
std::optional<Plane> plane_at(const Walls& walls, std::size_t point, const SurfacePoint& seen,
                              const Eigen::Vector2d& position) {
  const std::size_t w = walls.of_point[point];
  if (w == Walls::kNone) return std::nullopt;
  const Wall& wall = walls.walls[w];
  const double s = wall.line.direction().dot(position - wall.line.centre);
  if (s < wall.low + kMargin || s > wall.high - kMargin) return std::nullopt;
  const bool turned = wall.line.normal.dot(seen.beam) > 0.0;
  return Plane{wall.line.centre, turned ? Eigen::Vector2d(-wall.line.normal) : wall.line.normal};
}

std::optional<DoubleSighting> compare(const MatchReference& reference, const SurfacePoint& point,
                                      const Pose& motion, double range_noise) {
  if (!point.has_line) return std::nullopt;
  const Eigen::Vector2d sensor(motion.x, motion.y);
  const Eigen::Vector2d arm = rotated(motion.yaw, point.position), beam = rotated(motion.yaw, point.beam);
  const Eigen::Vector2d moved = sensor + arm;
  const Neighbour nearest = reference.tree().nearest(moved);
  const SurfacePoint& partner = reference.surface().points[nearest.index];
  if (nearest.squared_distance > kGate * kGate || !partner.has_line) return std::nullopt;
  const auto plane = plane_at(reference.walls(), nearest.index, partner, moved);
  if (!plane || -plane->normal.dot(beam) < kMinIncidence || -plane->normal.dot(partner.beam) < kMinIncidence)
    return std::nullopt;
  if (rotated(motion.yaw, point.normal).dot(plane->normal) < kMinAgreement) return std::nullopt;
  const double distance = plane->normal.dot(moved - partner.anchor);
  if (std::abs(distance) > kGate) return std::nullopt;
  const double variance = 2.0 * distance_variance(beam.dot(plane->normal), range_noise);
  return DoubleSighting{plane->seen(Eigen::Vector2d::Zero(), partner.beam, partner.bearing),
                        plane->seen(sensor, beam, point.bearing),
                        partner.beam,
                        beam,
                        plane->normal,
                        arm,
                        distance,
                        std::sqrt(variance)};
}

/// Matches the pair and collects its points; none when the match does not hold.
void fill(const ScanSurfaces& scans, HeadingPair& pair) {
  const MatchReference reference(scans.surface(pair.from), scans.range_noise());
  const Surface second = scans.surface(pair.to);
  MatchOptions options;
  options.range_noise = scans.range_noise();
  const MatchResult match = match_point_to_line(reference, second, scans.guess(pair.from, pair.to), options);
  if (!match.is_usable()) return;
  for (const SurfacePoint& point : second.points)
    if (const auto sighting = compare(reference, point, match.motion, scans.range_noise()))
      pair.points.push_back(*sighting);
}

}  // namespace

std::vector<HeadingPair> heading_pairs(const ScanSurfaces& scans, std::size_t most) {
  constexpr std::size_t kFewest = 40;  // points
  std::vector<HeadingPair> pairs = choose(scans, most);
  for (HeadingPair& pair : pairs) fill(scans, pair);
  std::erase_if(pairs, [](const HeadingPair& pair) { return pair.points.size() < kFewest; });
  return pairs;
}

}  // namespace odomcalib::calib
