#include "calib/matching/walls.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/matching/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/vector2.hpp"

namespace odomcalib::calib::matching {
namespace {

struct Piece {
  std::size_t first, last;  ///< points of the surface, both included
};

/// Largest chi-square that a straight wall is allowed: four standard deviations above its mean, and a fifth
/// for noise that is a little more than assumed.
double straightness_limit(std::size_t count) {
  const double freedom = static_cast<double>(count) - 2.0;
  return 1.2 * freedom + 4.0 * std::sqrt(2.0 * freedom);
}

double median_step(const Surface& surface) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < surface.points.size(); ++i) {
    const Eigen::Vector2d& a = surface.points[i - 1].beam;
    const Eigen::Vector2d& b = surface.points[i].beam;
    steps.push_back(std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b))));
  }
  return math::median_of(std::move(steps));
}

std::vector<Piece> split_at_gaps(const Surface& surface, double range_noise) {
  const double step = median_step(surface);
  std::vector<Piece> runs{{0, 0}};
  for (std::size_t i = 1; i < surface.points.size(); ++i) {
    const SurfacePoint& a = surface.points[i - 1];
    const SurfacePoint& b = surface.points[i];
    const double across = settings::kGapOfWall * std::min(a.range, b.range) * step;
    const double limit = std::max({settings::kLeastGap_m, across, gap_by_noise(range_noise)});
    if ((b.position - a.position).norm() > limit)
      runs.push_back({i, i});
    else
      runs.back().last = i;
  }
  return runs;
}

LineSums sums_of(const Surface& surface, const Piece& piece, const Eigen::Vector2d& normal,
                 double range_noise) {
  LineSums sums;
  for (std::size_t i = piece.first; i <= piece.last; ++i) {
    const SurfacePoint& point = surface.points[i];
    sums.add(point.position, 1.0 / distance_variance(point.beam.dot(normal), range_noise),
             range_noise * point.beam);
  }
  return sums;
}

/// Unweighted first: the weights depend on the direction of the wall.
Wall wall_through(const Surface& surface, const Piece& piece, double range_noise) {
  LineSums equal;
  for (std::size_t i = piece.first; i <= piece.last; ++i) equal.add(surface.points[i].position, 1.0);
  Wall wall;
  wall.sums = sums_of(surface, piece, fit_line(equal).normal, range_noise);
  wall.line = fit_line(wall.sums);
  return wall;
}

bool is_straight(const Wall& wall) {
  return wall.line.squares < straightness_limit(wall.sums.count) &&
         wall.line.angle_variance < settings::kWallDirection_rad * settings::kWallDirection_rad;
}

/// A slight arc hides in the noise of all readings, and shows in a fit of its own: by the coefficient of
/// s^2 beside offset and slope.
bool is_bent(const Surface& surface, const Piece& piece, const FittedLine& line, double range_noise) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (std::size_t i = piece.first; i <= piece.last; ++i) {
    const SurfacePoint& point = surface.points[i];
    const Eigen::Vector2d offset = point.position - line.centre;
    const double s = line.direction().dot(offset);
    const double weight = 1.0 / distance_variance(point.beam.dot(line.normal), range_noise);
    const Eigen::Vector3d powers(1.0, s, s * s);
    gram += weight * powers * powers.transpose();
    gradient += weight * line.normal.dot(offset) * powers;
  }
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(gram);
  const double bend = ldlt.solve(gradient)(2);
  return bend * bend > settings::kPlainArc * settings::kPlainArc * ldlt.solve(Eigen::Vector3d::UnitZ())(2);
}

/// The point farthest from the chord between the ends; an end itself when the piece is too short to cut.
std::size_t farthest_from_chord(const Surface& surface, const Piece& piece) {
  const Eigen::Vector2d a = surface.points[piece.first].position;
  const Eigen::Vector2d chord = surface.points[piece.last].position - a;
  std::size_t farthest = piece.first + (piece.last - piece.first) / 2;
  double largest = 0.0;
  for (std::size_t i = piece.first + 1; i < piece.last; ++i) {
    const Eigen::Vector2d d = surface.points[i].position - a;
    const double distance = std::abs(chord.x() * d.y() - chord.y() * d.x());
    if (distance > largest) {
      largest = distance;
      farthest = i;
    }
  }
  return farthest;
}

struct PieceOfWall {
  Piece piece;
  Wall wall;
};

struct JoinedPieces {
  PieceOfWall whole;
  std::vector<Piece> members;
};

void split(const Surface& surface, const Piece& piece, double range_noise, std::vector<PieceOfWall>& out) {
  if (piece.last - piece.first + 1 < settings::kFewestWallPoints) return;
  const Wall wall = wall_through(surface, piece, range_noise);
  if (is_straight(wall) && !is_bent(surface, piece, wall.line, range_noise)) {
    out.push_back({piece, wall});
    return;
  }
  const std::size_t cut = farthest_from_chord(surface, piece);
  split(surface, {piece.first, cut - 1}, range_noise, out);
  split(surface, {cut, piece.last}, range_noise, out);
}

/// Takes in the next piece if both are one line; each may be far below its own limit, so that what joining
/// adds must be noise, too.
bool join(PieceOfWall& into, const PieceOfWall& next, const Surface& surface) {
  const double gap =
      (surface.points[next.piece.first].position - surface.points[into.piece.last].position).norm();
  if (gap > settings::kJoinGap_m ||
      std::abs(into.wall.line.normal.dot(next.wall.line.normal)) < settings::kJoinCosine)
    return false;
  Wall joined;
  joined.sums = into.wall.sums;
  joined.sums += next.wall.sums;
  joined.line = fit_line(joined.sums);
  if (!is_straight(joined)) return false;
  const double added = joined.line.squares - into.wall.line.squares - next.wall.line.squares;
  if (added > settings::kJoinSquares) return false;
  into.wall = joined;
  into.piece.last = next.piece.last;
  return true;
}

std::vector<JoinedPieces> group(const std::vector<PieceOfWall>& pieces, const Surface& surface) {
  std::vector<JoinedPieces> groups;
  for (const PieceOfWall& next : pieces) {
    if (groups.empty() || !join(groups.back().whole, next, surface)) groups.push_back({next, {}});
    groups.back().members.push_back(next.piece);
  }
  return groups;
}

/// Near a corner a reading of one wall lies within the noise of the other, always on the same side of it. The
/// two scans would not be misled alike, so neither uses the ends of a wall.
double end_margin(double range_noise) {
  return std::max(settings::kEndMarginSigmas * range_noise, settings::kEndMargin_m);
}

/// Indices of the points of all pieces, with their place along the line.
std::vector<std::pair<std::size_t, double>> places_along(const JoinedPieces& pieces, const Surface& surface) {
  const FittedLine& line = pieces.whole.wall.line;
  std::vector<std::pair<std::size_t, double>> places;
  for (const Piece& member : pieces.members)
    for (std::size_t i = member.first; i <= member.last; ++i)
      places.emplace_back(i, place_of_beam(line, surface.points[i].position, surface.points[i].beam));
  return places;
}

void take(const JoinedPieces& pieces, const Surface& surface, double range_noise, Walls& out) {
  const FittedLine& line = pieces.whole.wall.line;
  const auto places = places_along(pieces, surface);
  const auto [lowest, highest] =
      std::minmax_element(places.begin(), places.end(), [](auto& a, auto& b) { return a.second < b.second; });
  Wall wall;
  wall.low = lowest->second + end_margin(range_noise);
  wall.high = highest->second - end_margin(range_noise);
  for (const auto& [i, s] : places) {
    if (s < wall.low || s > wall.high) continue;
    const SurfacePoint& point = surface.points[i];
    const double cosine = point.beam.dot(line.normal);
    if (range_to_line(point, line.normal.dot(point.position - line.centre), cosine) > surface.far_limit)
      continue;
    wall.sums.add(point.position, 1.0 / distance_variance(cosine, range_noise), range_noise * point.beam);
  }
  if (wall.sums.count < settings::kFewestWallPoints) return;
  wall.line = fit_line(wall.sums);
  // The ends are measured from the line's centre, which has moved with the readings left out.
  const double moved = line.direction().dot(wall.line.centre - line.centre);
  const bool turned = line.direction().dot(wall.line.direction()) < 0.0;
  const double low = wall.low - moved, high = wall.high - moved;
  wall.low = turned ? -high : low;
  wall.high = turned ? -low : high;
  for (const auto& [i, s] : places) out.of_point[i] = out.walls.size();
  out.walls.push_back(wall);
}

}  // namespace

void LineSums::add(const Eigen::Vector2d& point, double point_weight, const Eigen::Vector2d& spread) {
  weight += point_weight;
  first += point_weight * point;
  second += point_weight * point * point.transpose();
  noise += point_weight * spread * spread.transpose();
  ++count;
}

LineSums& LineSums::operator+=(const LineSums& other) {
  weight += other.weight;
  first += other.first;
  second += other.second;
  noise += other.noise;
  count += other.count;
  return *this;
}

FittedLine fit_line(const LineSums& sums) {
  FittedLine line;
  line.centre = sums.centre();
  const Eigen::Matrix2d scatter = sums.second - sums.weight * line.centre * line.centre.transpose();
  const Eigen::Matrix2d true_scatter = scatter - sums.noise;
  line.normal = math::quarter_turn(
      math::direction_of_spread(true_scatter(0, 0), true_scatter(0, 1), true_scatter(1, 1)));
  const double half_spread = 0.5 * std::hypot(scatter(0, 0) - scatter(1, 1), 2.0 * scatter(0, 1));
  line.squares = std::max(line.normal.dot(scatter * line.normal), 0.0);
  line.angle_variance = 1.0 / std::max(0.5 * scatter.trace() + half_spread, 1e-30);
  return line;
}

double place_of_beam(const FittedLine& line, const Eigen::Vector2d& end, const Eigen::Vector2d& beam) {
  const Eigen::Vector2d offset = end - line.centre;
  const double place = line.direction().dot(offset), cosine = line.normal.dot(beam);
  if (std::abs(cosine) < settings::kFlatCosine) return place;
  return place - line.normal.dot(offset) / cosine * line.direction().dot(beam);
}

double range_to_line(const SurfacePoint& point, double distance, double cosine_of_incidence) {
  return point.range - distance / cosine_of_incidence;
}

double distance_variance(double cosine_of_incidence, double range_noise) {
  const double across = range_noise * cosine_of_incidence;
  return across * across + settings::kSurfaceFloor_m * settings::kSurfaceFloor_m;
}

Walls find_walls(const Surface& surface, double range_noise) {
  Walls found;
  found.of_point.assign(surface.points.size(), Walls::kNone);
  if (surface.points.size() < settings::kFewestWallPoints) return found;
  std::vector<PieceOfWall> pieces;
  for (const Piece& run : split_at_gaps(surface, range_noise)) split(surface, run, range_noise, pieces);
  for (const JoinedPieces& joined : group(pieces, surface)) take(joined, surface, range_noise, found);
  return found;
}

}  // namespace odomcalib::calib::matching
