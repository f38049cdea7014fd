#include "calib/measurement/scan_path.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "calib/matching/point_to_line.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/vector2.hpp"
#include "calib/measurement/scan_surfaces.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

/// Largest range of the recording's only lidar, m.
double range_max(const Recording& recording) {
  return recording.scans.empty() ? 0.0 : recording.scans.front().range_max;
}

template <typename T>
std::vector<T> every_nth(std::vector<T> all, std::size_t n) {
  if (n < 2) return all;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < all.size(); k += n) all[kept++] = all[k];
  all.resize(kept);
  return all;
}

class Mapper {
 public:
  Mapper(const Recording& recording, const vehicle::DriveModel& model, std::span<const double> parameters,
         const vehicle::EffectList& effects, const PathOptions& options)
      : recording_(recording),
        mount_(vehicle::to_base(parameters).mount),
        trajectory_(model.trajectory(parameters, effects)),
        options_{.range_noise = options.range_noise, .range_max = range_max(recording)},
        trace_ranges_(options.trace_ranges) {
    for (std::size_t k = 0; k < recording.scans.size(); ++k) {
      const Scan& scan = recording.scans[k];
      const double end = scan.t + 2.0 * matching::reference_time(scan);
      if (model.track().covers(scan.t, end)) chosen_.push_back(k);
    }
    thin_out();
  }

  ScanPath run(const ScanPath& known) {
    if (chosen_.size() < settings::kFewestScans) return {};
    if (known.scans.empty())
      explore();
    else
      begin_with(known);
    if (path_.map.walls().empty() || path_.map.walls().size() > settings::kMostWalls) return {};
    adjust();
    place_all();
    return std::move(path_);
  }

 private:
  /// More scans and beams than the wheels' own noise lets matter only take longer.
  void thin_out() {
    const std::size_t scan_step = (chosen_.size() + settings::kMostScans - 1) / settings::kMostScans;
    chosen_ = every_nth(std::move(chosen_), scan_step);
    double total = 0.0;
    for (const std::size_t k : chosen_) total += static_cast<double>(recording_.scans[k].ranges.size());
    beam_step_ = static_cast<std::size_t>(std::max(1.0, std::round(total / settings::kMostBeams)));
  }

  [[nodiscard]] std::vector<Beam> beams(std::size_t k) const {
    return every_nth(make_beams(scan(k), motion_of(k)), beam_step_);
  }

  void begin_with(const ScanPath& known) {
    path_.map = known.map;
    auto placed = known.scans.begin();
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
      const bool is_known = placed != known.scans.end() && placed->time == time(k);
      poses_.push_back(is_known ? (placed++)->pose : poses_.empty() ? math::Pose{} : predicted(k));
    }
  }

  [[nodiscard]] const Scan& scan(std::size_t k) const { return recording_.scans[chosen_[k]]; }
  [[nodiscard]] double time(std::size_t k) const { return scan(k).t + matching::reference_time(scan(k)); }
  [[nodiscard]] math::Pose sensor_at(double t) const { return compose(trajectory_.at(t), mount_); }

  [[nodiscard]] matching::BeamMotion motion_of(std::size_t k) const {
    return motion_in_sweep(trajectory_, mount_, scan(k));
  }

  [[nodiscard]] matching::Surface surface(std::size_t k) const {
    return matching::make_surface(scan(k), motion_of(k), options_.range_noise);
  }

  /// From here on new scans are matched with this one where the map does not know the place.
  void make_key(std::size_t k, const math::Pose& pose) {
    key_ = std::make_unique<matching::MatchReference>(surface(k), options_.range_noise);
    key_pose_ = pose;
    path_.map.insert(key_->walls(), pose);
  }

  [[nodiscard]] math::Pose predicted(std::size_t k) const {
    return compose(poses_.back(), between(sensor_at(time(k - 1)), sensor_at(time(k))));
  }

  void explore() {
    poses_ = {math::Pose{}};
    make_key(0, math::Pose{});
    for (std::size_t k = 1; k < chosen_.size(); ++k) {
      const math::Pose guess = predicted(k);
      const auto found = find(k, guess);
      poses_.push_back(found.value_or(guess));
      const math::Pose step = between(key_pose_, poses_.back());
      if (found && (std::hypot(step.x, step.y) > settings::kNewWallsAfter_m ||
                    std::abs(step.yaw) > settings::kNewWallsAfter_rad))
        make_key(k, *found);
    }
  }

  /// In the map, or else by a match with the last key scan: one way, since the map is adjusted afterwards.
  [[nodiscard]] std::optional<math::Pose> find(std::size_t k, const math::Pose& guess) const {
    const Place place = place_scan(path_.map, beams(k), guess, options_);
    if (place.is_usable()) return place.pose;
    matching::MatchOptions match;
    match.range_noise = options_.range_noise;
    const matching::MatchResult result =
        match_point_to_line(*key_, surface(k), between(key_pose_, guess), match);
    if (!result.is_usable()) return std::nullopt;
    return compose(key_pose_, result.motion);
  }

  /// Every few scans show all walls; more would only take longer.
  void adjust() {
    const std::size_t stride = std::max<std::size_t>(2, chosen_.size() / settings::kMostAdjusted + 1);
    PlacedBeams used = sample(0, stride);
    RangeEvidence evidence = adjust_map(used.beams, options_, path_.map, used.places);
    if (path_.map.drop_doubles(settings::kDoubleWall * options_.range_noise))
      evidence = adjust_map(used.beams, options_, path_.map, used.places);
    if (!trace_ranges_ || !(shows_offset(evidence) || shows_slant(evidence))) return;
    RangeTrace trace = trace_ranges_(evidence, used, sample(stride / 2, stride), options_, path_.map);
    path_.map = std::move(trace.map);
    path_.lidar = std::move(trace.findings);
    options_.range_error(0) = trace.offset;
  }

  [[nodiscard]] PlacedBeams sample(std::size_t first, std::size_t stride) const {
    PlacedBeams sample;
    for (std::size_t k = first; k < chosen_.size(); k += stride) {
      sample.beams.push_back(beams(k));
      sample.places.push_back(place_scan(path_.map, sample.beams.back(), poses_[k], options_));
    }
    return sample;
  }

  void place_all() {
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
      const Place place = place_scan(path_.map, beams(k), poses_[k], options_);
      if (!place.is_usable()) {
        ++path_.lost;
        continue;
      }
      const Eigen::Matrix3d covariance = math::inverse_symmetric(place.information);
      path_.scans.push_back({time(k), place.pose, place.scale * place.scale * covariance});
    }
  }

  const Recording& recording_;
  math::Pose mount_;
  vehicle::Trajectory trajectory_;
  PlaceOptions options_;
  RangeTracer trace_ranges_;
  std::vector<std::size_t> chosen_;  ///< scans that the ticks cover, thinned out
  std::size_t beam_step_ = 1;        ///< every so many of their beams one counts
  std::vector<math::Pose> poses_;    ///< of those, while the map grows
  std::unique_ptr<matching::MatchReference> key_;
  math::Pose key_pose_;
  ScanPath path_;
};

void count_from_first(std::vector<vehicle::Fix>& fixes) {
  if (fixes.empty()) return;
  const math::Pose first = fixes.front().pose;
  for (vehicle::Fix& fix : fixes) fix.pose = between(first, fix.pose);
}

constexpr double kSameTime = 1e-6;  // s

}  // namespace

bool ScanPath::is_usable() const {
  return scans.size() >= settings::kFewestScans &&
         static_cast<double>(lost) < settings::kMostLost * static_cast<double>(lost + scans.size());
}

ScanPath place_scans(const Recording& recording, const vehicle::DriveModel& model,
                     std::span<const double> parameters, const vehicle::EffectList& effects,
                     const PathOptions& options, const ScanPath& known) {
  return Mapper(recording, model, parameters, effects, options).run(known);
}

std::vector<vehicle::Fix> fixes_of(const ScanPath& path, const math::Pose& mount) {
  std::vector<vehicle::Fix> fixes;
  for (const PlacedScan& scan : path.scans) fixes.push_back({scan.time, compose(scan.pose, inverse(mount))});
  count_from_first(fixes);
  return fixes;
}

std::vector<vehicle::Fix> fixes_of(const Recording& recording) {
  std::vector<vehicle::Fix> fixes;
  for (const PoseSample& sample : recording.poses)
    fixes.push_back({sample.t, {sample.x, sample.y, sample.yaw}});
  count_from_first(fixes);
  return fixes;
}

double drift_of_matches(const std::vector<SensorPair>& pairs, const ScanPath& path,
                        const PathOfWheels& wheels) {
  Eigen::Vector3d drift = Eigen::Vector3d::Zero(), variance = Eigen::Vector3d::Zero();
  for (const SensorPair& pair : pairs) {
    const auto ends = places_at_ends(path.scans, pair.interval, wheels);
    if (!ends) continue;
    const Eigen::Matrix3d into_map = math::rotation_about_z(ends->begin.pose.yaw);
    drift += into_map * math::difference(pair.motion, between(ends->begin.pose, ends->end.pose));
    variance += (into_map * pair.covariance * into_map.transpose()).diagonal();
  }
  if (!(variance.minCoeff() > 0.0)) return 0.0;
  return drift.cwiseQuotient(variance.cwiseSqrt()).cwiseAbs().maxCoeff();
}

std::vector<SensorPair> pairs_of_places(const std::vector<SensorPair>& pairs, const ScanPath& path,
                                        const PathOfWheels& wheels) {
  std::vector<SensorPair> out;
  double last_end = -1e300;
  for (const SensorPair& pair : pairs) {
    const auto ends = places_at_ends(path.scans, pair.interval, wheels);
    if (!ends) continue;
    const auto [motion, covariance] = motion_between(ends->begin, ends->end);
    const bool follows = std::abs(pair.interval.begin - last_end) < kSameTime;
    out.push_back({pair.interval, motion, covariance, follows});
    last_end = pair.interval.end;
  }
  return out;
}

}  // namespace odomcalib::calib::measurement
