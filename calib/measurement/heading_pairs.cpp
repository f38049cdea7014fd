#include "calib/measurement/heading_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/matching/both_ways.hpp"
#include "calib/math/vector2.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

double turn_between(const math::Pose& a, const math::Pose& b) {
  return std::abs(math::wrap_angle(b.yaw - a.yaw));
}

/// The scan to compare with `from`.
std::optional<std::size_t> partner_of(const ScanSurfaces& scans, std::size_t from, double turn,
                                      const std::vector<bool>& used) {
  const auto& poses = scans.odometry();
  for (std::size_t k = from + 1;
       k < poses.size() && scans.times()[k] - scans.times()[from] < settings::kHeadingPair_s; ++k) {
    const math::Pose step = between(poses[from], poses[k]);
    if (used[k] || std::hypot(step.x, step.y) > settings::kNearSensors_m) continue;
    if (std::abs(turn_between(poses[from], poses[k]) - turn) < settings::kTurnTolerance_rad) return k;
  }
  return std::nullopt;
}

/// Pairs of scans, spread over the recording.
class Choice {
 public:
  Choice(const ScanSurfaces& scans, std::size_t most)
      : scans_(scans), most_(most), used_(scans.times().size(), false) {}

  /// All turns in equal numbers; a drive that has too few of some gives any of them.
  std::vector<HeadingPair> run() {
    go_through([&](std::size_t from) {
      add(from, settings::kWantedTurns_rad[chosen_.size() % settings::kWantedTurns_rad.size()]);
    });
    go_through([&](std::size_t from) {
      for (const double turn : settings::kWantedTurns_rad)
        if (!used_[from]) add(from, turn);
    });
    return std::move(chosen_);
  }

 private:
  template <typename Visit>
  void go_through(const Visit& visit) {
    const std::size_t stride = std::max<std::size_t>(1, used_.size() / (2 * most_));
    for (std::size_t k = 0; k < used_.size() && chosen_.size() < most_; k += stride)
      if (!used_[k]) visit(k);
  }

  void add(std::size_t from, double turn) {
    const auto partner = partner_of(scans_, from, turn, used_);
    if (!partner || scans_.gap_between(from, *partner) != nullptr) return;
    used_[from] = used_[*partner] = true;
    chosen_.push_back({from, *partner, {}});
  }

  const ScanSurfaces& scans_;
  std::size_t most_;
  std::vector<bool> used_;
  std::vector<HeadingPair> chosen_;
};

/// A straight surface that the first scan knows from all its readings, seen from one of the sensors.
/// Regressors made from single readings would carry those readings' noise, which is the residual's.
struct Plane {
  Eigen::Vector2d centre, normal;  ///< in the first scan's frame; the normal towards the sensors

  /// How the surface is seen along a beam; the range is where the beam meets it.
  [[nodiscard]] terms::Sighting seen(const Eigen::Vector2d& sensor, const Eigen::Vector2d& beam,
                                     double bearing) const {
    const Eigen::Vector2d back = -beam;
    return {bearing, normal.dot(centre - sensor) / normal.dot(beam),
            std::atan2(normal.x() * back.y() - normal.y() * back.x(), normal.dot(back))};
  }
};

/// A beam of the second scan on a wall of the first. Everything but the distance follows from where beams
/// meet the wall: single readings' noise would choose the partner, and the product of both would look like an
/// error of the lidar.
class Meeting {
 public:
  Meeting(const matching::MatchReference& reference, const Eigen::Vector2d& end, const Eigen::Vector2d& beam)
      : surface_(reference.surface()), walls_(reference.walls()) {
    const auto nearest = reference.order().nearest(end, settings::kHeadingGate_m);
    if (!nearest) return;
    wall_ = walls_.of_point[nearest->index];
    if (wall_ == matching::Walls::kNone) return;
    const matching::Wall& wall = walls_.walls[wall_];
    const double place = place_of_beam(wall.line, end, beam);
    if (place < wall.low + settings::kHeadingMargin_m || place > wall.high - settings::kHeadingMargin_m)
      return;
    partner_ = nearest_beam(nearest->index, place);
    place_ = wall.line.centre + place * wall.line.direction();
  }

  /// Null when the beam does not meet a wall away from its ends: there neighbourhoods are cut off.
  [[nodiscard]] const matching::SurfacePoint* partner() const { return partner_; }
  [[nodiscard]] const Eigen::Vector2d& place() const { return place_; }
  [[nodiscard]] Plane plane() const {
    const matching::FittedLine& line = walls_.walls[wall_].line;
    const bool turned = line.normal.dot(partner_->beam) > 0.0;
    return {line.centre, turned ? Eigen::Vector2d(-line.normal) : line.normal};
  }

 private:
  /// The reading near an index, on this wall, whose beam meets it nearest to a place.
  [[nodiscard]] const matching::SurfacePoint* nearest_beam(std::size_t index, double place) const {
    const matching::SurfacePoint* best = nullptr;
    double least = settings::kHeadingGate_m;
    const std::size_t end = std::min(index + settings::kBeamsBeside + 1, surface_.points.size());
    for (std::size_t k = index > settings::kBeamsBeside ? index - settings::kBeamsBeside : 0; k < end; ++k) {
      const matching::SurfacePoint& point = surface_.points[k];
      if (walls_.of_point[k] != wall_ || !point.has_line) continue;
      const double off =
          std::abs(place_of_beam(walls_.walls[wall_].line, point.position, point.beam) - place);
      if (off < least) least = off, best = &point;
    }
    return best;
  }

  const matching::Surface& surface_;
  const matching::Walls& walls_;
  std::size_t wall_ = matching::Walls::kNone;
  const matching::SurfacePoint* partner_ = nullptr;
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero();
};

std::optional<DoubleSighting> compare(const matching::MatchReference& reference,
                                      const matching::SurfacePoint& point, const math::Frame& frame,
                                      double range_noise) {
  if (!point.has_line) return std::nullopt;
  const Eigen::Vector2d& sensor = frame.origin();
  const Eigen::Vector2d beam = frame.rotate(point.beam);
  const Eigen::Vector2d end = sensor + frame.rotate(point.position);
  const Meeting meeting(reference, end, beam);
  if (meeting.partner() == nullptr) return std::nullopt;
  const matching::SurfacePoint& partner = *meeting.partner();
  const Plane plane = meeting.plane();
  if (-plane.normal.dot(beam) < settings::kHeadingIncidence ||
      -plane.normal.dot(partner.beam) < settings::kHeadingIncidence)
    return std::nullopt;
  if (frame.rotate(point.normal).dot(plane.normal) < settings::kHeadingNormals) return std::nullopt;
  const double distance = plane.normal.dot(end - partner.anchor);
  if (std::abs(distance) > settings::kHeadingGate_m) return std::nullopt;
  return DoubleSighting{plane.seen(Eigen::Vector2d::Zero(), partner.beam, partner.bearing),
                        plane.seen(sensor, beam, point.bearing),
                        partner.beam,
                        beam,
                        plane.normal,
                        meeting.place() - sensor,
                        distance,
                        std::sqrt(2.0 * matching::distance_variance(beam.dot(plane.normal), range_noise))};
}

/// Matches the pair and collects its points; none when the match does not hold.
void fill(const ScanSurfaces& scans, HeadingPair& pair) {
  const matching::MatchReference reference(scans.surface(pair.from), scans.range_noise());
  const matching::MatchReference second(scans.surface(pair.to), scans.range_noise());
  matching::MatchOptions options;
  options.range_noise = scans.range_noise();
  const matching::MatchResult match =
      match_both_ways(reference, second, scans.guess(pair.from, pair.to), options);
  if (!match.is_usable()) return;
  const math::Frame frame(match.motion);
  for (const matching::SurfacePoint& point : second.surface().points)
    if (const auto sighting = compare(reference, point, frame, scans.range_noise()))
      pair.points.push_back(*sighting);
}

}  // namespace

std::vector<HeadingPair> heading_pairs(const ScanSurfaces& scans, std::size_t most) {
  std::vector<HeadingPair> pairs = Choice(scans, most).run();
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.from < b.from; });
  for (HeadingPair& pair : pairs) fill(scans, pair);
  std::erase_if(pairs,
                [](const HeadingPair& pair) { return pair.points.size() < settings::kFewestHeadingPoints; });
  return pairs;
}

}  // namespace odomcalib::calib::measurement
