#include "calib/classical/motion_kinds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/classical/settings.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::classical {
namespace {

void count(MotionKind& kind, double amount) {
  ++kind.stretches;
  kind.amount += amount;
}

/// Straight, on the spot or in a bend.
void count_stretch(double way, double distance, double turn, double track_width, MotionKinds& kinds) {
  const bool straight = std::abs(turn) <= settings::kStraightYaw_rad;
  if (!straight && distance <= settings::kSpinLever * track_width * std::abs(turn))
    return count(turn > 0.0 ? kinds.spin_left : kinds.spin_right, std::abs(turn));
  (way < 0.0 ? kinds.way_backward : kinds.way_forward) += distance;
  if (straight)
    count(way < 0.0 ? kinds.backward : kinds.forward, distance);
  else
    count(turn > 0.0 ? kinds.arc_left : kinds.arc_right, std::abs(turn));
}

/// Time without any motion, until something moves.
class StopCount {
 public:
  void add(double duration, bool moved, MotionKinds& kinds) {
    if (!moved) standing_ += duration;
    if (moved) end(kinds);
  }
  void end(MotionKinds& kinds) {
    kinds.stops += standing_ >= settings::kStop_s ? 1 : 0;
    standing_ = 0.0;
  }

 private:
  double standing_ = 0.0;
};

struct Need {
  const char *parameters, *shown_by;
  bool of_turns;
  double each_way;  ///< m or rad
};

constexpr std::array kNeeds = {
    Need{"left_wheel_diameter, right_wheel_diameter", "lines, forward and backward", false,
         settings::kEnoughStraight_m},
    Need{"track_width", "turns, left and right", true, settings::kEnoughTurn_rad},
    Need{"lidar_x, lidar_y", "turns, left and right", true, settings::kEnoughTurnForLidar_rad},
    Need{"lidar_yaw", "lines, forward and backward", false, settings::kEnoughStraight_m}};

Supply supply_of(const ParameterSupply& one) {
  const double least = one.of_turns ? settings::kLeastTurn_rad : settings::kLeastTravel_m;
  if (one.first_way + one.other_way < least) return Supply::missing;
  return std::min(one.first_way, one.other_way) < one.each_way ? Supply::little : Supply::enough;
}

}  // namespace

MotionKinds motion_kinds(const wheels::WheelTrack& track, const wheels::BaseParameters& base) {
  using measurement::settings::kPairDistance_m;
  using measurement::settings::kPairRotation_rad;
  MotionKinds kinds;
  StopCount stops;
  double way = 0.0, distance = 0.0, turn = 0.0;  // of the stretch that goes on
  for (std::size_t k = 1; k < track.t.size(); ++k) {
    if (track.segment[k] != track.segment[k - 1]) continue;
    const double left = base.left_radius * (track.left[k] - track.left[k - 1]),
                 right = base.right_radius * (track.right[k] - track.right[k - 1]);
    const double dt = track.t[k] - track.t[k - 1];
    stops.add(dt, std::max(std::abs(left), std::abs(right)) > settings::kStanding_m_s * dt, kinds);
    way += 0.5 * (left + right);
    distance += 0.5 * std::abs(left + right);
    turn += (right - left) / base.track_width;
    if (distance < kPairDistance_m && std::abs(turn) < kPairRotation_rad) continue;
    count_stretch(way, distance, turn, base.track_width, kinds);
    way = distance = turn = 0.0;
  }
  stops.end(kinds);
  return kinds;
}

std::vector<ParameterSupply> parameter_supply(const MotionKinds& kinds) {
  std::vector<ParameterSupply> all;
  for (const Need& need : kNeeds) {
    ParameterSupply one{need.parameters, need.shown_by, kinds.way_forward, kinds.way_backward,
                        need.each_way,   need.of_turns, Supply::missing};
    if (need.of_turns) {
      one.first_way = kinds.left();
      one.other_way = kinds.right();
    }
    one.supply = supply_of(one);
    all.push_back(std::move(one));
  }
  return all;
}

std::optional<std::string> missing_motion(std::span<const wheels::WheelMotion> motions) {
  double straight = 0.0, turning = 0.0, both = 0.0;  // second moments
  for (const wheels::WheelMotion& motion : motions) {
    const double sum = motion.right + motion.left, difference = motion.right - motion.left;
    straight += sum * sum;
    turning += difference * difference;
    both += sum * difference;
  }
  constexpr double kShare = settings::kHardlyAny * settings::kHardlyAny;
  if (straight <= 0.0 && turning <= 0.0) return "straight lines, arcs and turns on the spot, both ways";
  if (turning < kShare * straight) return "turns on the spot, both ways";
  if (straight < kShare * turning) return "straight lines, forward and backward";
  if (straight * turning - both * both < kShare * straight * turning)
    return "straight lines and turns on the spot in one drive";
  return std::nullopt;
}

std::string record_more(std::span<const wheels::WheelMotion> motions) {
  return "record " +
         missing_motion(motions).value_or("more of each motion: straight lines, arcs and turns on the spot");
}

}  // namespace odomcalib::calib::classical
