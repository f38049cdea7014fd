#include "calib/classical/sign_check.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/classical/closed_form.hpp"
#include "calib/classical/settings.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/median.hpp"

namespace odomcalib::calib::classical {
namespace {

/// Possible faults between the wheels and the counts, and with the lidar.
struct Wires {
  bool exchanged = false;  ///< before any sign is turned
  bool left_inverted = false, right_inverted = false;
  bool lidar_mirrored = false;
};

/// The motion that would have been recorded with everything in its place.
wheels::WheelMotion put_right(wheels::WheelMotion motion, const Wires& wires) {
  if (wires.exchanged) std::swap(motion.left, motion.right);
  if (wires.left_inverted) motion.left = -motion.left;
  if (wires.right_inverted) motion.right = -motion.right;
  if (wires.lidar_mirrored) {
    motion.sensor_motion.y = -motion.sensor_motion.y;
    motion.sensor_motion.yaw = -motion.sensor_motion.yaw;
  }
  return motion;
}

std::vector<wheels::WheelMotion> put_right(std::span<const wheels::WheelMotion> motions, const Wires& wires) {
  std::vector<wheels::WheelMotion> out;
  out.reserve(motions.size());
  for (const wheels::WheelMotion& motion : motions) out.push_back(put_right(motion, wires));
  return out;
}

std::vector<Wires> all_wires() {
  std::vector<Wires> all;
  for (const bool mirrored : {false, true})
    for (const bool exchanged : {false, true})
      for (const bool left : {false, true})
        for (const bool right : {false, true}) all.push_back({exchanged, left, right, mirrored});
  return all;
}

bool looks_elsewhere(const wheels::BaseParameters& found, const RobotDescription& robot, bool of_base) {
  if (!of_base && !robot.lidar_pose) return false;
  const double nominal = of_base ? 0.0 : (*robot.lidar_pose)[2];
  return std::abs(math::wrap_angle(found.mount.yaw - nominal)) > settings::kFarYaw_rad;
}

bool is_clear(const ClosedFormResult& fit) {
  const wheels::BaseParameters& p = fit.parameters;
  const std::array<double, 3> lengths = {p.left_radius, p.right_radius, p.track_width};
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (!(std::abs(lengths[k]) > settings::kClearOfZero * std::sqrt(fit.covariance(i, i)))) return false;
  }
  return true;
}

bool is_positive(const wheels::BaseParameters& p) {
  return p.left_radius > 0.0 && p.right_radius > 0.0 && p.track_width > 0.0;
}

struct Explanation {
  Wires wires;
  bool elsewhere = false;

  /// Both wheels are inverted by one mistake: about which way is ahead.
  [[nodiscard]] int faults() const {
    return static_cast<int>(wires.exchanged) + static_cast<int>(wires.left_inverted || wires.right_inverted) +
           static_cast<int>(wires.lidar_mirrored) + static_cast<int>(elsewhere);
  }
};

/// Nothing when signs speak against these wires, or the motion does not determine them.
std::optional<Explanation> explanation(std::span<const wheels::WheelMotion> motions, const Wires& wires,
                                       const RobotDescription& robot, bool of_base) {
  const auto fit = solve_closed_form(put_right(motions, wires));
  if (!fit || !is_clear(fit.value()) || !is_positive(fit.value().parameters)) return std::nullopt;
  return Explanation{wires, looks_elsewhere(fit.value().parameters, robot, of_base)};
}

/// All with the fewest faults. Empty when the motion does not determine signs.
std::vector<Explanation> explanations(std::span<const wheels::WheelMotion> motions,
                                      const RobotDescription& robot, bool of_base) {
  std::vector<Explanation> best;
  for (const Wires& wires : all_wires()) {
    const auto one = explanation(motions, wires, robot, of_base);
    if (!one || (!best.empty() && one->faults() > best.front().faults())) continue;
    if (!best.empty() && one->faults() < best.front().faults()) best.clear();
    best.push_back(*one);
  }
  return best;
}

/// Counts that were made of odometry are exchanged where it turns the other way, and both inverted where it
/// goes the other way in turning the same.
std::vector<std::string> frames_of(const Wires& wires) {
  const bool turns = wires.exchanged != wires.left_inverted;
  if (wires.left_inverted && turns) return {"x and yaw of the odometry run the other way"};
  if (wires.left_inverted) return {"the odometry looks backwards: its frame is turned by half a turn"};
  if (!turns) return {};
  return {"y and yaw of the odometry run the other way, as in a frame with z down (north-east-down)"};
}

std::vector<std::string> wires_of(const Wires& wires) {
  std::vector<std::string> parts;
  if (wires.exchanged) parts.emplace_back("the left and right counts are exchanged");
  if (wires.left_inverted && wires.right_inverted)
    parts.emplace_back("both wheels count backwards");
  else if (wires.left_inverted || wires.right_inverted)
    parts.emplace_back("the " + std::string(wires.left_inverted ? "left" : "right") +
                       " wheel counts backwards");
  return parts;
}

std::string text_of(const Explanation& one, bool of_base, MotionSource motion) {
  const bool of_frame =
      motion == MotionSource::odometry && one.wires.left_inverted == one.wires.right_inverted;
  std::vector<std::string> parts = of_frame ? frames_of(one.wires) : wires_of(one.wires);
  if (one.wires.lidar_mirrored)
    parts.emplace_back(of_base ? "y and yaw of the reference poses run the other way, as in a frame with z "
                                 "down (north-east-down)"
                               : "the lidar is upside down or its angles run the other way");
  if (one.elsewhere)
    parts.emplace_back(of_base ? "the reference poses do not look ahead"
                               : "the lidar looks elsewhere than lidar_pose says");
  std::string out;
  for (const std::string& part : parts) out += (out.empty() ? "" : " and ") + part;
  return out;
}

/// Rotation left over by rotation = right gain * right - left gain * left.
double rotation_left(std::span<const wheels::WheelMotion> motions, double left_gain, double right_gain) {
  double sum = 0.0;
  for (const wheels::WheelMotion& m : motions)
    sum += std::abs(m.sensor_motion.yaw - right_gain * m.right + left_gain * m.left);
  return sum;
}

/// Whether gains of any sign leave plainly less of the rotation than those of wheels that count ahead, left
/// and right as they are called.
bool other_signs_explain_more(std::span<const wheels::WheelMotion> motions) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
  for (const wheels::WheelMotion& m : motions) {
    const Eigen::Vector2d turned(-m.left, m.right);
    normal += turned * turned.transpose();
    right_side += m.sensor_motion.yaw * turned;
  }
  const Eigen::Vector2d free = math::solve_symmetric(normal, right_side);
  const double left_alone = std::max(right_side(0) / normal(0, 0), 0.0),
               right_alone = std::max(right_side(1) / normal(1, 1), 0.0);
  double as_they_are =
      std::min(rotation_left(motions, left_alone, 0.0), rotation_left(motions, 0.0, right_alone));
  if (free.minCoeff() >= 0.0) as_they_are = std::min(as_they_are, rotation_left(motions, free(0), free(1)));
  return rotation_left(motions, free(0), free(1)) < settings::kLeftByWires * as_they_are;
}

}  // namespace

std::optional<Error> wrong_signs(std::span<const wheels::WheelMotion> motions, const RobotDescription& robot,
                                 bool of_base, MotionSource motion) {
  if (motions.size() < settings::kFewestForSigns || !other_signs_explain_more(motions)) return std::nullopt;
  // With wires as they should be nothing has to be put right but the heading, which is estimated.
  if (explanation(motions, Wires{}, robot, of_base)) return std::nullopt;
  const auto found = explanations(motions, robot, of_base);
  if (found.empty()) return std::nullopt;
  std::string what =
      "wheels and " + std::string(of_base ? "reference" : "lidar") + " contradict each other: ";
  for (const Explanation& one : found)
    what += (&one == &found.front() ? "" : ", or ") + text_of(one, of_base, motion);
  return Error{ErrorCode::refused, what, "",
               "put it right on the robot or in its description and record again"};
}

namespace {

/// Lengths of the motion by the wheels and by the reference, medians over the motions, m.
struct Movement {
  double rolled = 0.0, seen = 0.0;
};

Movement movement(std::span<const wheels::WheelMotion> motions, const RobotDescription& robot) {
  std::vector<double> rolled{0.0}, seen{0.0};
  for (const wheels::WheelMotion& m : motions) {
    rolled.push_back(0.5 *
                     std::hypot(robot.left_wheel_diameter * m.left, robot.right_wheel_diameter * m.right) /
                     std::numbers::sqrt2);
    const math::Pose& s = m.sensor_motion;
    seen.push_back(std::hypot(s.x, s.y, 0.5 * robot.track_width * s.yaw));
  }
  return {math::median_of(std::move(rolled)), math::median_of(std::move(seen))};
}

/// Wheels in the air, or a lidar that repeats itself: what is left is what de-skewing made of it.
std::optional<Error> standing_reference(std::span<const wheels::WheelMotion> motions,
                                        const RobotDescription& robot) {
  const Movement all = movement(motions, robot);
  if (!(all.seen < settings::kHardlyMoved * all.rolled)) return std::nullopt;
  return Error{ErrorCode::refused, "the wheels turned, but the robot hardly moved", "",
               "check that the wheels are on the floor and that scans or reference poses are new each time"};
}

}  // namespace

std::optional<Error> check_signs(std::span<const wheels::WheelMotion> motions, const RobotDescription& robot,
                                 bool of_base, MotionSource motion) {
  if (auto error = standing_reference(motions, robot)) return error;
  return wrong_signs(motions, robot, of_base, motion);
}

}  // namespace odomcalib::calib::classical
