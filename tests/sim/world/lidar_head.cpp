#include "tests/sim/world/lidar_head.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odomcalib::sim {

namespace {

Pose between(const Pose& from, const Pose& to, double share) {
  return {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y),
          from.yaw + share * (to.yaw - from.yaw)};
}

double brightness(const Hit& hit) {
  return std::clamp(230.0 * std::sqrt(hit.incidence_cosine) / (1.0 + 0.05 * hit.range), 5.0, 255.0);
}

}  // namespace

LidarHead::LidarHead(const Room& room, const Pose& mount, const LidarOptions& options, std::uint64_t seed,
                     Disturbances disturbances)
    : room_(room),
      mount_(mount),
      options_(options),
      disturbances_(std::move(disturbances)),
      random_(seed ^ 0x6c69646172ULL),
      beam_interval_(1.0 / (options.turns_per_second * options.beams_per_turn)) {}

double LidarHead::measured(const Hit& hit) {
  const double noise = options_.range_noise * normal_(random_);
  const bool grazing = chance_(random_) * options_.grazing_cosine > hit.incidence_cosine;
  const bool dropped = chance_(random_) < options_.random_drops;
  const double range = hit.range + noise;
  if (grazing || dropped || range < options_.range_min || range > options_.range_max) return 0.0;
  return range;
}

Beam LidarHead::shoot(const Pose& base) {
  Beam beam;
  beam.turn = next_ / options_.beams_per_turn;
  beam.index = static_cast<int>(next_ % options_.beams_per_turn);
  beam.t = options_.first_turn_starts + static_cast<double>(next_) * beam_interval_;
  beam.clockwise = 2.0 * std::numbers::pi * beam.index / options_.beams_per_turn;
  const Pose eye = compose(base, mount_);
  double direction = -beam.clockwise;
  for (const auto& effect : disturbances_) direction = effect->beam_direction(beam.t, direction);
  const auto hit = room_.cast({eye.x, eye.y}, eye.yaw + direction);
  BeamReading reading{beam.t, direction, 0.0, 0.0, 1.0};
  if (hit) reading = {beam.t, direction, measured(*hit), hit->range, hit->incidence_cosine};
  for (const auto& effect : disturbances_) effect->on_beam(reading);
  beam.range = options_.resolution > 0.0
                   ? std::round(reading.range / options_.resolution) * options_.resolution
                   : reading.range;
  beam.intensity = hit && beam.range > 0.0 ? brightness(*hit) : 0.0;
  return beam;
}

void LidarHead::advance(double from_time, const Pose& from, double to_time, const Pose& to,
                        std::vector<Beam>& out) {
  for (;; ++next_) {
    const double t = options_.first_turn_starts + static_cast<double>(next_) * beam_interval_;
    if (t >= to_time) return;
    if (t < from_time) continue;  // the head was running before anybody looked
    out.push_back(shoot(between(from, to, (t - from_time) / (to_time - from_time))));
  }
}

}  // namespace odomcalib::sim
