#include "calib/measurement/wall_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/matching/settings.hpp"
#include "calib/math/vector2.hpp"
#include "calib/measurement/sector_index.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

matching::LineSums moved_sums(const matching::LineSums& sums, const math::Frame& frame) {
  const Eigen::Matrix2d turn = frame.rotation();
  const Eigen::Vector2d &at = frame.origin(), first = turn * sums.first;
  matching::LineSums out = sums;
  out.first = first + sums.weight * at;
  out.noise = turn * sums.noise * turn.transpose();
  out.second = turn * sums.second * turn.transpose() + first * at.transpose() + at * first.transpose() +
               sums.weight * at * at.transpose();
  return out;
}

MapWall in_map(const matching::Wall& wall, const math::Frame& frame) {
  MapWall out;
  out.centre = frame.origin() + frame.rotate(wall.line.centre);
  out.normal = frame.rotate(wall.line.normal);
  out.low = wall.low;
  out.high = wall.high;
  out.sums = moved_sums(wall.sums, frame);
  if (out.normal.dot(frame.origin() - out.centre) > 0.0) return out;
  out.normal = -out.normal;
  std::swap(out.low, out.high);
  out.low = -out.low;
  out.high = -out.high;
  return out;
}

/// `from`'s ends along `wall`, from its centre.
std::pair<double, double> ends_along(const MapWall& from, const MapWall& wall) {
  const auto along = [&](double s) {
    return wall.direction().dot(from.centre + s * from.direction() - wall.centre);
  };
  return {along(from.low), along(from.high)};
}

bool lies_along(const MapWall& piece, const MapWall& wall, double tolerance) {
  if (piece.normal.dot(wall.normal) < settings::kDoubleNormals) return false;
  const auto [low, high] = ends_along(piece, wall);
  if (low > wall.high + settings::kOverhang_m || high < wall.low - settings::kOverhang_m) return false;
  const auto across = [&](double s) {
    return std::abs(wall.normal.dot(piece.centre + s * piece.direction() - wall.centre));
  };
  return across(piece.low) < tolerance && across(piece.high) < tolerance;
}

void merge(MapWall& into, const MapWall& piece) {
  const MapWall before = into;
  into.sums += piece.sums;
  const matching::FittedLine line = fit_line(into.sums);
  into.centre = line.centre;
  into.normal = line.normal.dot(before.normal) > 0.0 ? line.normal : Eigen::Vector2d(-line.normal);
  const auto [a, b] = ends_along(before, into);
  const auto [c, d] = ends_along(piece, into);
  into.low = std::min(a, c);
  into.high = std::max(b, d);
}

}  // namespace

MapWall* WallMap::find_similar(const MapWall& wall) {
  for (MapWall& known : walls_) {
    if (known.normal.dot(wall.normal) < settings::kWallNormals) continue;
    const auto [low, high] = ends_along(wall, known);
    if (low > known.high + settings::kGapAlong_m || high < known.low - settings::kGapAlong_m) continue;
    const Eigen::Vector2d apart = wall.centre - known.centre;
    if (std::abs(known.normal.dot(apart)) < settings::kWallOffset_m) return &known;
  }
  return nullptr;
}

void WallMap::insert(const matching::Walls& seen, const math::Pose& sensor) {
  const math::Frame frame(sensor);
  for (const matching::Wall& wall : seen.walls) {
    if (wall.high - wall.low < settings::kShortestWall_m) continue;
    const MapWall piece = in_map(wall, frame);
    if (MapWall* known = find_similar(piece))
      merge(*known, piece);
    else
      walls_.push_back(piece);
  }
}

bool WallMap::drop_doubles(double tolerance) {
  const auto length = [](const MapWall& wall) { return wall.high - wall.low; };
  std::stable_sort(walls_.begin(), walls_.end(),
                   [&](const MapWall& a, const MapWall& b) { return length(a) > length(b); });
  std::vector<MapWall> kept;
  for (const MapWall& wall : walls_) {
    const auto whole = std::find_if(kept.begin(), kept.end(),
                                    [&](const MapWall& k) { return lies_along(wall, k, tolerance); });
    if (whole == kept.end()) {
      kept.push_back(wall);
      continue;
    }
    const auto [low, high] = ends_along(wall, *whole);
    whole->low = std::min(whole->low, low);
    whole->high = std::max(whole->high, high);
  }
  std::swap(walls_, kept);
  return walls_.size() < kept.size();
}

/// The nearest wall on the beam's way; none when it would strike near its end or too flat.
std::optional<std::size_t> WallMap::struck_by(const Eigen::Vector2d& from, const Eigen::Vector2d& direction,
                                              std::span<const std::uint32_t> near) const {
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<std::size_t> struck;
  for (const std::uint32_t w : near) {
    const MapWall& wall = walls_[w];
    const double towards = wall.normal.dot(direction);
    if (towards >= 0.0) continue;
    const double range = wall.normal.dot(wall.centre - from) / towards;
    if (range <= 0.0 || range >= nearest) continue;
    const double s = wall.direction().dot(from + range * direction - wall.centre);
    if (s < wall.low - settings::kShade_m || s > wall.high + settings::kShade_m) continue;
    nearest = range;
    const bool inside = s > wall.low && s < wall.high;
    struck = inside && towards < -matching::settings::kFlattestWallBeam ? std::optional<std::size_t>(w)
                                                                        : std::nullopt;
  }
  return struck;
}

std::vector<Strike> WallMap::strikes(const std::vector<Beam>& beams, const math::Pose& sensor) const {
  const math::Frame frame(sensor);
  double reach = 0.0;
  for (const Beam& beam : beams) reach = std::max(reach, beam.origin.norm());
  const SectorIndex index(walls_, frame.origin(), reach, settings::kShade_m);
  std::vector<Strike> found;
  found.reserve(beams.size());
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const Eigen::Vector2d from = frame.origin() + frame.rotate(beams[i].origin);
    const Eigen::Vector2d direction = frame.rotate(beams[i].direction);
    if (const auto wall = struck_by(from, direction, index.towards(direction))) found.push_back({i, *wall});
  }
  return found;
}

RangeTerm WallMap::term(const Beam& beam, std::size_t index, const math::Frame& sensor,
                        double range_noise) const {
  const MapWall& wall = walls_[index];
  const Eigen::Vector2d from = sensor.origin() + sensor.rotate(beam.origin);
  const Eigen::Vector2d direction = sensor.rotate(beam.direction);
  const double towards = wall.normal.dot(direction);
  const double expected = wall.normal.dot(wall.centre - from) / towards;
  const Eigen::Vector2d point = from + expected * direction;
  RangeTerm term;
  term.residual = beam.range - expected;
  term.sighting.range = expected;
  term.sighting.incidence = std::atan2(-wall.direction().dot(direction), -towards);
  term.variance = matching::distance_variance(towards, range_noise) / (towards * towards);
  term.by_pose << wall.normal / towards,
      wall.normal.dot(math::quarter_turn(point - sensor.origin())) / towards;
  term.by_wall << -1.0 / towards, wall.direction().dot(point - wall.centre) / towards;
  return term;
}

std::vector<Beam> make_beams(const Scan& scan, const matching::BeamMotion& motion) {
  std::vector<Beam> beams;
  beams.reserve(scan.ranges.size());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (!matching::is_usable(scan, i)) continue;
    const math::Pose pose = motion(matching::beam_time(scan, i));
    const double angle = pose.yaw + scan.angle(i);
    beams.push_back(
        {{pose.x, pose.y}, {std::cos(angle), std::sin(angle)}, static_cast<double>(scan.ranges[i])});
  }
  return beams;
}

}  // namespace odomcalib::calib::measurement
