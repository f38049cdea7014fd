#include "calib/matching/surface.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "calib/matching/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/settings.hpp"
#include "calib/math/vector2.hpp"

namespace odomcalib::calib::matching {
namespace {

struct Line {
  Eigen::Vector2d centre;
  Eigen::Vector2d normal;
  double rms = 0.0;
  std::size_t count = 0;
};

/// Running sums over the points, so that the line through any run of them costs the same.
class RunSums {
 public:
  explicit RunSums(const std::vector<SurfacePoint>& points) : sums_(points.size() + 1, Sums::Zero()) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d& p = points[i].position;
      sums_[i + 1] = sums_[i];
      sums_[i + 1] += (Sums() << p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y()).finished();
    }
  }

  /// Total least squares line through points [first, last].
  [[nodiscard]] Line line(std::size_t first, std::size_t last) const {
    Line line;
    line.count = last - first + 1;
    const double n = static_cast<double>(line.count);
    const Sums s = (sums_[last + 1] - sums_[first]) / n;
    const double xx = s(2) - s(0) * s(0);
    const double xy = s(3) - s(0) * s(1);
    const double yy = s(4) - s(1) * s(1);
    line.centre = s.head<2>();
    line.normal = math::quarter_turn(math::direction_of_spread(xx, xy, yy));
    const double smallest = 0.5 * (xx + yy - std::hypot(xx - yy, 2.0 * xy));
    line.rms = std::sqrt(std::max(smallest, 0.0) * n / std::max(n - 2.0, 1.0));
    return line;
  }

 private:
  using Sums = Eigen::Matrix<double, 5, 1>;
  std::vector<Sums> sums_;
};

/// Typical distance between neighbouring beam ends at this range, from the angular step.
double expected_step(const SurfacePoint& a, double angular_step) {
  return std::max(a.range * angular_step, 5e-3);
}

/// How far the neighbourhood of i reaches to one side before a gap, the size limit or the count limit.
/// @param farthest m
std::size_t reach(const std::vector<SurfacePoint>& points, std::size_t i, int direction, double angular_step,
                  double farthest, double range_noise) {
  std::size_t k = i;
  for (int n = 0; n < settings::kMostNeighbours; ++n) {
    if ((direction < 0 && k == 0) || (direction > 0 && k + 1 == points.size())) break;
    const std::size_t next = direction < 0 ? k - 1 : k + 1;
    // A surface seen at a grazing angle spreads its points; beyond about 75 degrees it is not used.
    const double gap = (points[next].position - points[k].position).norm();
    const double step = settings::kGapOfSurface * expected_step(points[k], angular_step);
    if (gap > std::max(step, gap_by_noise(range_noise))) break;
    if ((points[next].position - points[i].position).norm() > farthest) break;
    k = next;
  }
  return k;
}

bool acceptable(const Line& line, const SurfacePoint& point, double range_noise) {
  if (line.count < settings::kFewestLinePoints) return false;
  const double incidence = std::abs(line.normal.dot(point.beam));
  if (incidence < settings::kFlattestBeam) return false;
  return line.rms < settings::kLineNoise * std::hypot(range_noise * incidence, settings::kBeamFloor_m);
}

/// Widest neighbourhood that is still one line: both sides, one side (next to a corner), then a narrower one.
std::optional<Line> line_within(const std::vector<SurfacePoint>& points, const RunSums& sums, std::size_t i,
                                double angular_step, double farthest, double range_noise) {
  const std::size_t low = reach(points, i, -1, angular_step, farthest, range_noise);
  const std::size_t high = reach(points, i, +1, angular_step, farthest, range_noise);
  const std::pair<std::size_t, std::size_t> windows[] = {
      {low, high}, {low, i}, {i, high}, {i - (i - low) / 2, i + (high - i) / 2}};
  for (const auto& [first, last] : windows) {
    const Line line = sums.line(first, last);
    if (acceptable(line, points[i], range_noise)) return line;
  }
  return std::nullopt;
}

void set_line(SurfacePoint& point, const Line& line) {
  point.normal = line.normal.dot(point.beam) > 0.0 ? Eigen::Vector2d(-line.normal) : line.normal;
  point.anchor = point.position - line.normal * line.normal.dot(point.position - line.centre);
  point.has_line = true;
}

/// m
double range_to_own_line(const SurfacePoint& point) {
  return point.range - point.normal.dot(point.position - point.anchor) / point.normal.dot(point.beam);
}

/// Lines within the usual neighbourhood; where these are rare because the beams are, wider ones, too.
void attach_lines(std::vector<SurfacePoint>& points, double angular_step, double range_noise) {
  const RunSums sums(points);
  std::size_t found = 0;
  const auto attach = [&](std::size_t i, double farthest) {
    const auto line = line_within(points, sums, i, angular_step, farthest, range_noise);
    if (line) set_line(points[i], *line), ++found;
  };
  for (std::size_t i = 0; i < points.size(); ++i) attach(i, settings::kReachOfLine_m);
  if (static_cast<double>(found) > settings::kFewLines * static_cast<double>(points.size())) return;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double wide = settings::kWideReach * expected_step(points[i], angular_step);
    if (!points[i].has_line && wide > settings::kReachOfLine_m) attach(i, wide);
  }
}

SurfacePoint beam_end(const Scan& scan, std::size_t beam, const BeamMotion& motion) {
  SurfacePoint point;
  point.range = static_cast<double>(scan.ranges[beam]);
  const math::Pose pose = motion(beam_time(scan, beam));
  point.bearing = scan.angle(beam);
  const double angle = pose.yaw + point.bearing;
  point.beam = {std::cos(angle), std::sin(angle)};
  point.position = Eigen::Vector2d(pose.x, pose.y) + point.range * point.beam;
  return point;
}

/// Median step between neighbouring beams; listed angles may wrap anywhere.
double angular_step(const Scan& scan) {
  if (scan.angles.size() < 2) return std::abs(scan.angle_increment);
  std::vector<double> steps;
  for (std::size_t i = 1; i < scan.angles.size(); ++i)
    steps.push_back(std::abs(
        math::wrap_angle(static_cast<double>(scan.angles[i]) - static_cast<double>(scan.angles[i - 1]))));
  return math::median_of(steps);
}

/// How far the reciprocal range of beam k lies off the line through beams k - lag and k + lag, in units of
/// what range noise of 1 m would make of it: on a straight wall 1 / r = A cos(angle) + B sin(angle). Walls
/// met flatter than 45 degrees show how uneven they are instead.
std::optional<double> bend(const Scan& scan, std::size_t k, std::size_t lag) {
  const std::size_t beams[] = {k - lag, k, k + lag};
  double u[3];
  for (int j = 0; j < 3; ++j) {
    if (!is_usable(scan, beams[j])) return std::nullopt;
    u[j] = 1.0 / static_cast<double>(scan.ranges[beams[j]]);
  }
  const double before = math::wrap_angle(scan.angle(k) - scan.angle(k - lag));
  const double after = math::wrap_angle(scan.angle(k + lag) - scan.angle(k));
  const double whole = std::sin(before + after);
  const double slope =
      (u[0] / u[2] - 1.0) * u[1] / u[0] / (before + after);  // of the range, tangent of the incidence
  if (std::abs(whole) < 1e-6 || std::abs(slope) > settings::kSteepestBend) return std::nullopt;
  const double first = std::sin(after) / whole, last = std::sin(before) / whole;
  const double noise = std::hypot(u[1] * u[1], first * u[0] * u[0], last * u[2] * u[2]);
  return (u[1] - first * u[0] - last * u[2]) / noise;
}

/// Corners and edges lie in a part of all bends; over two and a half degrees few.
void collect_bends(const Scan& scan, std::vector<double>& out) {
  const double step = angular_step(scan);
  if (!(step > 0.0)) return;
  const auto lag = static_cast<std::size_t>(std::max(1.0, std::round(settings::kBendReach_rad / step)));
  for (std::size_t k = lag; k + lag < scan.ranges.size(); ++k)
    if (const auto bent = bend(scan, k, lag)) out.push_back(std::abs(*bent));
}

/// Standard deviation of the normal part of a list of sizes: root mean square of what lies within 2.5 of it,
/// over that of a normal distribution cut there.
double normal_part(const std::vector<double>& sizes) {
  double scale = math::kMadToSigma * math::median_of(sizes);
  for (int pass = 0; pass < 20; ++pass) {
    double sum = 0.0, count = 0.0;
    for (const double size : sizes)
      if (size < settings::kNormalCut * scale) sum += size * size, count += 1.0;
    if (!(count > 0.0)) break;
    scale = std::sqrt(sum / count) / settings::kOfCutNormal;
  }
  return scale;
}

}  // namespace

bool is_usable(const Scan& scan, std::size_t beam) {
  const auto range = static_cast<double>(scan.ranges[beam]);
  return range > 0.0 && range >= scan.range_min && (scan.range_max <= 0.0 || range <= scan.range_max);
}

double beam_time(const Scan& scan, std::size_t beam) {
  if (!scan.times.empty()) return static_cast<double>(scan.times[beam]);
  return scan.time_increment.value_or(0.0) * static_cast<double>(beam);
}

double reference_time(const Scan& scan) {
  return scan.ranges.empty() ? 0.0 : beam_time(scan, scan.ranges.size() - 1) / 2.0;
}

double far_limit(double range_max, double range_noise) {
  if (!(range_max > 0.0)) return std::numeric_limits<double>::infinity();
  return range_max - std::max(math::settings::kClearSigmas * range_noise, settings::kNoiseAfar * range_max);
}

Surface make_surface(const Scan& scan, const BeamMotion& motion, double range_noise) {
  Surface surface;
  surface.points.reserve(scan.ranges.size());
  for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam)
    if (is_usable(scan, beam)) surface.points.push_back(beam_end(scan, beam, motion));
  attach_lines(surface.points, angular_step(scan), range_noise);
  surface.far_limit = far_limit(scan.range_max, range_noise);
  for (SurfacePoint& point : surface.points)
    if (point.has_line && range_to_own_line(point) > surface.far_limit) point.has_line = false;
  return surface;
}

double estimate_range_noise(std::span<const Scan> scans) {
  std::vector<double> bends;
  const std::size_t stride = std::max<std::size_t>(scans.size() / 100, 1);
  for (std::size_t k = 0; k < scans.size(); k += stride) collect_bends(scans[k], bends);
  if (bends.empty()) return settings::kUsualRangeNoise_m;
  return std::clamp(normal_part(bends), settings::kLeastRangeNoise_m, settings::kMostRangeNoise_m);
}

}  // namespace odomcalib::calib::matching
