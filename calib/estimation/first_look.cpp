#include "calib/estimation/first_look.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "calib/classical/closed_form.hpp"
#include "calib/classical/length_factor.hpp"
#include "calib/classical/sign_check.hpp"
#include "calib/estimation/explained_rotation.hpp"
#include "calib/estimation/settings.hpp"
#include "calib/ingest/frames.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/number_text.hpp"
#include "calib/measurement/reference_motion.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::estimation {
namespace {

using classical::Cause;
using measurement::ReferenceMotion;
using wheels::WheelMotion;

std::string number(double value) { return math::significant(value, 3); }

/// The longest way that a count goes in one direction from sample to sample.
/// @param to 1: up, -1: down
std::int64_t way_of(const std::vector<TickSample>& ticks, std::int64_t TickSample::*side, std::int64_t to) {
  std::int64_t way = 0;
  for (std::size_t k = 1; k < ticks.size(); ++k)
    if (ticks[k].segment == ticks[k - 1].segment)
      way = std::max(way, to * (ticks[k].*side - ticks[k - 1].*side));
  return way;
}

/// The ways in which a wheel counts.
struct Ways {
  bool up = false, down = false;
  [[nodiscard]] bool both() const { return up && down; }
  [[nodiscard]] bool only_down() const { return down && !up; }
  [[nodiscard]] const char* one_way() const { return only_down() ? "fall" : "grow"; }
};

struct Direction {
  Ways left, right;
};

Ways ways_of(const Recording& recording, std::int64_t TickSample::*side) {
  return {way_of(recording.ticks, side, 1) > settings::kEdge,
          way_of(recording.ticks, side, -1) > settings::kEdge};
}

Direction directions(const Recording& recording) {
  return {ways_of(recording, &TickSample::left), ways_of(recording, &TickSample::right)};
}

/// Wheels that only count down as if they counted up: which way that is, is another question.
std::vector<WheelMotion> counted_up(std::vector<WheelMotion> motions, const Direction& counted) {
  for (WheelMotion& m : motions) {
    if (counted.left.only_down()) m.left = -m.left;
    if (counted.right.only_down()) m.right = -m.right;
  }
  return motions;
}

/// Rotation of the base that nominal lengths make of wheel rotations.
double nominal_rotation(const RobotDescription& robot, double left, double right) {
  return 0.5 * (robot.right_wheel_diameter * right - robot.left_wheel_diameter * left) / robot.track_width;
}

/// Each motion with the signs, of wheels that have none, that suit its rotation best.
std::vector<WheelMotion> with_direction(std::vector<WheelMotion> motions, const Direction& counted,
                                        const RobotDescription& robot) {
  for (WheelMotion& m : motions) {
    WheelMotion best = m;
    for (const double left : {1.0, -1.0})
      for (const double right : {1.0, -1.0}) {
        if ((left < 0.0 && counted.left.both()) || (right < 0.0 && counted.right.both())) continue;
        const auto misfit = [&](double l, double r) {
          return std::abs(m.sensor_motion.yaw - nominal_rotation(robot, l, r));
        };
        if (misfit(left * m.left, right * m.right) < misfit(best.left, best.right))
          best = {left * m.left, right * m.right, m.sensor_motion};
      }
    m = best;
  }
  return motions;
}

std::size_t changed(const std::vector<WheelMotion>& before, const std::vector<WheelMotion>& after,
                    const RobotDescription& robot) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const double given = nominal_rotation(robot, before[k].left, before[k].right);
    const double mended = nominal_rotation(robot, after[k].left, after[k].right);
    const double yaw = before[k].sensor_motion.yaw;
    if (std::abs(yaw - given) > settings::kContradicting_rad &&
        std::abs(yaw - mended) < settings::kLeftWithDirection * std::abs(yaw - given))
      ++count;
  }
  return count;
}

/// Direction in the frame of the reference, rad, in which it mostly goes, ahead or back: the mean of axial
/// directions (Mardia and Jupp, Directional Statistics, 2000, 9.2.1).
double main_direction(const std::vector<ReferenceMotion>& motions) {
  std::complex<double> sum = 0.0;
  for (const ReferenceMotion& m : motions) {
    const std::complex<double> way(m.motion.x, m.motion.y);
    if (std::abs(m.motion.yaw) < settings::kContradicting_rad && std::abs(way) > 0.0)
      sum += way * way / std::abs(way);
  }
  return 0.5 * std::arg(sum);
}

/// Share of the way that goes across that direction and that neither a reference that sits elsewhere nor one
/// that looks elsewhere explains.
double sideways_share(const std::vector<ReferenceMotion>& motions) {
  const double main = main_direction(motions);
  Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() * 1e-9;
  Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
  std::vector<std::pair<Eigen::Vector2d, double>> steps;  // ahead and turn; aside
  double way = 0.0, left = 0.0;
  for (const ReferenceMotion& m : motions) {
    const double length = std::hypot(m.motion.x, m.motion.y);
    if (length < settings::kPlainWay_m) continue;
    // The middle of an arc has the direction of its chord.
    const double angle = std::atan2(m.motion.y, m.motion.x) - main - 0.5 * m.motion.yaw;
    const Eigen::Vector2d terms(length * std::cos(angle), m.motion.yaw);
    normal += terms * terms.transpose();
    right_side += length * std::sin(angle) * terms;
    steps.emplace_back(terms, length * std::sin(angle));
    way += length;
  }
  if (steps.size() < settings::kFewestMotions) return 0.0;
  const Eigen::Vector2d fit = math::solve_symmetric(normal, right_side);
  for (const auto& [terms, aside] : steps) left += std::abs(aside - fit.dot(terms));
  return left / way;
}

/// A trial of one mistake: what would be seen without it.
class Look {
 public:
  explicit Look(const Recording& recording)
      : recording_(recording),
        seen_(measurement::reference_motions(recording, settings::kMostLookedAt)),
        track_(wheels::wheel_track_from_ticks(recording)),
        motions_(beside_wheels(seen_.motions, track_)),
        explained_(explained_rotation(motions_)) {}

  [[nodiscard]] std::optional<Cause> cause() const {
    if (seen_.motions.size() < settings::kFewestMotions) return std::nullopt;
    if (auto found = without_direction()) return found;
    if (auto found = same_counts()) return found;
    if (explained_ < settings::kContradicts) {
      if (auto found = counts_per_sample()) return found;
      if (auto found = clock_rate()) return found;
      if (auto found = delay()) return found;
    }
    if (auto found = stretched_angles()) return found;
    if (auto found = length_factor(motions_)) return found;
    if (auto found = length_of_odometry()) return found;
    if (auto found = signs()) return found;
    return strafing();
  }

  /// The lidar confirms what turns on the spot show of the frame of the odometry.
  [[nodiscard]] std::optional<Cause> frame_beside_axle() const {
    const auto left = ingest::beside_axle(recording_);
    if (!left || !recording_.poses.empty() || !recording_.robot.lidar_pose) return std::nullopt;
    const auto fit = classical::solve_closed_form(motions_);
    if (!fit) return std::nullopt;
    const double beside = fit.value().parameters.mount.y - (*recording_.robot.lidar_pose)[1];
    if (std::abs(beside + *left) > settings::kSameBeside * std::abs(*left)) return std::nullopt;
    const std::string distance = math::fixed(std::abs(*left), 3);
    const std::string side = *left > 0.0 ? "left" : "right";
    return Cause{
        "the odometry is that of a frame " + distance + " m to the " + side +
            " of the middle of the axle: where the robot turns on the spot it goes ahead and back by "
            "so much for each radian, and the lidar comes out " +
            math::fixed(std::abs(beside), 3) + " m beside where lidar_pose has it",
        "record the frame in the middle of the axle (base_link), or, if it is, correct y of lidar_pose"};
  }

  [[nodiscard]] std::optional<Cause> without_direction() const {
    const Direction counted = directions(recording_);
    if (counted.left.both() && counted.right.both()) return std::nullopt;
    const auto against_of = [&](const std::vector<WheelMotion>& given) {
      return changed(given, with_direction(given, counted, recording_.robot), recording_.robot);
    };
    // A robot that only turned on the spot one way counts up on one side and down on the other.
    const std::size_t against = std::min(against_of(motions_), against_of(counted_up(motions_, counted)));
    const auto share = static_cast<double>(against) / std::max(static_cast<double>(motions_.size()), 1.0);
    if (share < settings::kAgainstCounting || against < settings::kFewestAgainstCounting) return std::nullopt;
    return Cause{one_way(counted) + ", although the " + reference() +
                     " shows that the robot also turned the other way: the encoders count edges without "
                     "their direction",
                 "read both channels of each encoder (quadrature), or give the counts the sign of the speed "
                 "that was commanded, and record again"};
  }

 private:
  [[nodiscard]] std::string reference() const { return recording_.poses.empty() ? "lidar" : "reference"; }

  [[nodiscard]] std::optional<Cause> same_counts() const {
    const auto& ticks = recording_.ticks;
    for (const TickSample& tick : ticks)
      if (std::abs((tick.left - ticks.front().left) - (tick.right - ticks.front().right)) > settings::kEdge)
        return std::nullopt;
    double turned = 0.0;
    for (const ReferenceMotion& m : seen_.motions) turned += std::abs(m.motion.yaw);
    if (turned < settings::kTurned_rad) return std::nullopt;
    return Cause{"left and right counts are always the same, although the robot turned by " +
                     std::to_string(std::lround(turned * 180.0 / math::kPi)) + " degrees in all",
                 "check that each count comes from its own encoder"};
  }

  static std::string one_way(const Direction& counted) {
    const auto of = [](const std::string& whose, const Ways& ways) {
      return "the counts of " + whose + " only ever " + ways.one_way();
    };
    if (counted.left.both()) return of("the right wheel", counted.right);
    if (counted.right.both()) return of("the left wheel", counted.left);
    if (counted.left.only_down() == counted.right.only_down()) return of("both wheels", counted.left);
    return of("the left wheel", counted.left) + ", those of the right only ever " + counted.right.one_way();
  }

  /// Two wheels move no point of the robot across its heading but by the turn.
  [[nodiscard]] std::optional<Cause> strafing() const {
    const double share = sideways_share(seen_.motions);
    if (share < settings::kStrafes) return std::nullopt;
    return Cause{
        "the " + reference() + " sees the robot go sideways over " + math::significant(100.0 * share, 2) +
            " % of its way, which two wheels cannot: wheels that roll sideways, too (mecanum, omni), "
            "or a robot that slides",
        "record a drive without sideways motion: straight lines, arcs and turns on the spot"};
  }

  /// Where wheels lead matching astray, the reference alone still shows which way the robot turned.
  [[nodiscard]] std::optional<Cause> signs() const {
    const auto error =
        classical::wrong_signs(motions_, recording_.robot, !recording_.poses.empty(), recording_.motion);
    return error ? std::optional(Cause{error->what, error->remedy}) : std::nullopt;
  }

  /// Values that are the counts since the sample before, as some controllers send them.
  [[nodiscard]] std::optional<Cause> counts_per_sample() const {
    Recording mended;
    mended.robot = recording_.robot;
    mended.ticks = recording_.ticks;
    for (std::size_t k = 1; k < mended.ticks.size(); ++k) {
      mended.ticks[k].left += mended.ticks[k - 1].left;
      mended.ticks[k].right += mended.ticks[k - 1].right;
      mended.ticks[k].segment = 0;
    }
    const auto track = wheels::wheel_track_from_ticks(mended);
    if (!mends(explained_, explained_rotation(beside_wheels(seen_.motions, track)))) return std::nullopt;
    return Cause{"\"left\" and \"right\" are the counts since the sample before, not those since the start",
                 "add them up before they are recorded: ticks are cumulative"};
  }

  [[nodiscard]] double explained_with(const ClockMap& clock) const {
    return explained_rotation(beside_wheels(seen_.motions, track_, clock));
  }

  [[nodiscard]] std::pair<double, double> span_of_reference() const {
    if (!recording_.poses.empty()) return {recording_.poses.front().t, recording_.poses.back().t};
    return {recording_.scans.front().t, recording_.scans.back().t};
  }

  [[nodiscard]] std::optional<Cause> clock_rate() const {
    const auto [begin, end] = span_of_reference();
    const double ticks = track_.t.back() - track_.t.front();
    const double rate = ticks / (end - begin);
    if (!(std::abs(rate - 1.0) > settings::kSpansApart)) return std::nullopt;
    if (!mends(explained_, explained_with({begin, track_.t.front(), rate}))) return std::nullopt;
    return Cause{"the clock of the " + reference() + " runs at " + number(1.0 / rate) +
                     " times the rate of the counts' clock: " + number(end - begin) + " s against " +
                     number(ticks) + " s of the same drive",
                 "stamp both with the same clock, in seconds"};
  }

  [[nodiscard]] std::optional<Cause> delay() const {
    double best = explained_, late = 0.0;
    for (double d = -settings::kClockReach_s; d <= settings::kClockReach_s; d += settings::kClockStep_s)
      if (const double explained = explained_with({d, 0.0, 1.0}); explained > best)
        best = explained, late = d;
    if (!mends(explained_, best)) return std::nullopt;
    return Cause{"stamps of the " + reference() + " are " + number(std::abs(late)) + " s " +
                     (late > 0.0 ? "late" : "early") +
                     " against those of the counts: two clocks, or one of "
                     "them was set while recording",
                 "stamp both with the same clock, or subtract the difference"};
  }

  struct Lengths {
    classical::LengthRatios ratios;
    double left_m;  ///< RMS of the places that they leave unexplained
  };

  [[nodiscard]] std::optional<Lengths> lengths(const std::vector<WheelMotion>& motions) const {
    if (motions.size() < settings::kFewestMotions) return std::nullopt;
    const auto fit = classical::solve_closed_form(motions);
    const RobotDescription& robot = recording_.robot;
    if (!fit || !(robot.left_wheel_diameter > 0.0) || !(robot.track_width > 0.0)) return std::nullopt;
    const wheels::BaseParameters& p = fit.value().parameters;
    return Lengths{{2.0 * p.left_radius / robot.left_wheel_diameter,
                    2.0 * p.right_radius / robot.right_wheel_diameter, p.track_width / robot.track_width},
                   fit.value().rms.head<2>().norm()};
  }

  static bool are_nominal(const classical::LengthRatios& r) {
    const auto is_near = [](double ratio) { return std::abs(ratio - 1.0) < settings::kNearNominal; };
    return is_near(r.left) && is_near(r.right) && is_near(r.track);
  }

  /// Beams spread wider, or less wide, than they were sent. Lengths that are wrong by the same factor are
  /// mended by that as well, but the places of scans with beams that were spread wrongly fit them worse.
  [[nodiscard]] std::optional<Cause> stretched_angles() const {
    if (!recording_.poses.empty()) return std::nullopt;
    const auto given = lengths(motions_);
    if (given && are_nominal(given->ratios)) return std::nullopt;
    for (const double factor : settings::kAngleFactors) {
      Recording mended = recording_;
      mended.scans.resize(std::min(mended.scans.size(), settings::kMostTried));
      for (Scan& scan : mended.scans) {
        scan.angle_min *= factor;
        scan.angle_increment *= factor;
        for (float& angle : scan.angles) angle = static_cast<float>(angle * factor);
      }
      const auto seen = measurement::reference_motions(mended, settings::kMostTried);
      const auto found = lengths(beside_wheels(seen.motions, track_));
      if (seen.unmatched > seen.matched || !found || !are_nominal(found->ratios)) continue;
      if (given && given->left_m < found->left_m) continue;
      return Cause{"angles of the scans are " + number(1.0 / factor) + " times as wide as they are: with " +
                       number(factor) +
                       " times angle_increment all lengths come out near their nominal values",
                   "check angle_increment, or the number of beams in a turn, for the mode the lidar runs in"};
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Cause> length_factor(const std::vector<WheelMotion>& motions) const {
    const auto found = lengths(motions);
    if (!found || explained_ < settings::kContradicts) return std::nullopt;
    return cause_of_ratios(found->ratios, {recording_.robot, recording_.motion, !recording_.poses.empty()});
  }

  /// Odometry in another unit of length has the right turns, beside which its ways are too long or too short
  /// for the closed form.
  [[nodiscard]] std::optional<Cause> length_of_odometry() const {
    if (recording_.motion != MotionSource::odometry) return std::nullopt;
    const RobotDescription& robot = recording_.robot;
    double seen = 0.0, rolled = 0.0;  // m, nearly straight on
    for (const WheelMotion& m : motions_) {
      if (std::abs(m.sensor_motion.yaw) > settings::kContradicting_rad) continue;
      seen += std::hypot(m.sensor_motion.x, m.sensor_motion.y);
      rolled += 0.25 * std::abs(robot.left_wheel_diameter * m.left + robot.right_wheel_diameter * m.right);
    }
    if (seen < settings::kStraightOn_m || !(rolled > 0.0)) return std::nullopt;
    const double ratio = seen / rolled;
    return classical::cause_of_ratios({ratio, ratio, ratio},
                                      {robot, recording_.motion, !recording_.poses.empty()});
  }

  const Recording& recording_;
  measurement::ReferenceMotions seen_;
  wheels::WheelTrack track_;
  std::vector<WheelMotion> motions_;
  double explained_;
};

bool can_be_looked_at(const Recording& recording) {
  return recording.increments.empty() && recording.ticks.size() > 1 &&
         (recording.poses.size() > 1 || recording.scans.size() > 1);
}

Error refusal(const Cause& cause, const Recording& recording) {
  return {ErrorCode::refused, cause.what, recording.name, cause.remedy};
}

}  // namespace

bool counts_one_way(const Recording& recording) {
  const Direction counted = directions(recording);
  return !counted.left.both() || !counted.right.both();
}

std::optional<Error> counts_without_direction(const Recording& recording) {
  if (!can_be_looked_at(recording) || !counts_one_way(recording)) return std::nullopt;
  const auto found = Look(recording).without_direction();
  return found ? std::optional(refusal(*found, recording)) : std::nullopt;
}

std::optional<Error> odometry_beside_axle(const Recording& recording) {
  if (!can_be_looked_at(recording) || !ingest::beside_axle(recording)) return std::nullopt;
  const auto found = Look(recording).frame_beside_axle();
  return found ? std::optional(refusal(*found, recording)) : std::nullopt;
}

std::optional<Error> first_look(const Recording& recording) {
  if (!can_be_looked_at(recording)) return std::nullopt;
  const auto found = Look(recording).cause();
  return found ? std::optional(refusal(*found, recording)) : std::nullopt;
}

}  // namespace odomcalib::calib::estimation
