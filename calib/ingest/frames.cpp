#include "calib/ingest/frames.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "calib/ingest/settings.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/number_text.hpp"
#include "calib/math/se2.hpp"
#include "proto/recording/wheel_motion.hpp"

namespace odomcalib::calib::ingest {
namespace {

struct Step {
  double ahead = 0.0, aside = 0.0;  ///< m, against the heading in its middle
  double turn = 0.0;                ///< rad
};

/// Long enough that rounded numbers hardly bend it, short enough to be an arc, and none over a reset.
std::vector<Step> steps_of(const std::vector<PoseSample>& poses) {
  std::vector<Step> steps;
  PoseSample from = poses.front(), before = from;
  for (const PoseSample& to : poses) {
    if (is_reset(std::exchange(before, to), to)) from = to;
    const double x = to.x - from.x, y = to.y - from.y, turn = math::wrap_angle(to.yaw - from.yaw);
    if (std::hypot(x, y) < settings::kOdometryStep_m && std::abs(turn) < settings::kOdometryStep_rad)
      continue;
    const double heading = from.yaw + 0.5 * turn;
    steps.push_back(
        {std::cos(heading) * x + std::sin(heading) * y, std::cos(heading) * y - std::sin(heading) * x, turn});
    from = to;
  }
  return steps;
}

struct Sideways {
  double share = 0.0;  ///< of the way, as it is
  double slope = 0.0;  ///< of the way, to the left
  double slope_deviation = 0.0;
  double unexplained = 0.0;  ///< share of the way that no frame explains
};

std::optional<Sideways> sideways_of(const std::vector<Step>& steps) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  const auto terms = [](const Step& step) {
    return Eigen::Vector3d(step.ahead, step.turn, step.ahead * step.turn);
  };
  double way = 0.0, aside = 0.0;
  for (const Step& step : steps) {
    normal += terms(step) * terms(step).transpose();
    right_side += step.aside * terms(step);
    way += std::hypot(step.ahead, step.aside);
    aside += std::abs(step.aside);
  }
  if (!(way > settings::kOdometryStep_m)) return std::nullopt;
  normal += 1e-12 * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d fit = math::solve_symmetric(normal, right_side);
  double left = 0.0, squares = 0.0;
  for (const Step& step : steps) {
    const double misfit = step.aside - fit.dot(terms(step));
    left += std::abs(misfit);
    squares += misfit * misfit;
  }
  const double variance = squares / (static_cast<double>(steps.size()) - 3.0);
  const Eigen::Vector3d column = math::solve_symmetric(normal, Eigen::Vector3d(1.0, 0.0, 0.0));
  return Sideways{aside / way, fit(0), std::sqrt(variance * std::max(column(0), 0.0)), left / way};
}

/// Where the robot turns about, beside the frame of its odometry.
struct TurnedAbout {
  double left = 0.0;   ///< m, to the left of the frame: middle of the shortest interval that holds a part of
                       ///< the turns
  double width = 0.0;  ///< m, of that interval
};

/// As the shorth (Andrews et al., Robust Estimates of Location, 1972), of a smaller part: turns on the spot
/// agree, arcs do not.
/// @param places m, as many as make a part
TurnedAbout where_most_are(std::vector<double> places) {
  std::sort(places.begin(), places.end());
  const auto part = static_cast<std::size_t>(settings::kTurnsTogether * static_cast<double>(places.size()));
  TurnedAbout best{0.0, std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k + part < places.size(); ++k)
    if (const double width = places[k + part] - places[k]; width < best.width)
      best = {0.5 * (places[k] + places[k + part]), width};
  return best;
}

/// Centres of the turns to one side, of those that lie not far from the wheels.
/// @param to 1 to the left, -1 to the right
std::vector<double> centres_of_turns(const std::vector<Step>& steps, double to, double farthest) {
  std::vector<double> centres;
  for (const Step& step : steps)
    if (step.turn * to > settings::kTurnOfStep_rad && std::abs(step.ahead / step.turn) < farthest)
      centres.push_back(step.ahead / step.turn);
  return centres;
}

Error wrong(const Recording& recording, double share, const std::string& what, const std::string& remedy) {
  return {ErrorCode::format,
          "the odometry goes sideways over " + math::significant(100.0 * share, 2) + " % of its way: " + what,
          recording.name, remedy};
}

/// m that every x and y is a multiple of, of those that bend steps plainly; 0 where there is none.
double rounding_of(const std::vector<PoseSample>& poses) {
  const auto is_multiple = [](double value, double unit) {
    return std::abs(value / unit - std::round(value / unit)) < settings::kOfARounding;
  };
  for (const double unit : settings::kRoundings_m)
    if (std::all_of(poses.begin(), poses.end(),
                    [&](const PoseSample& p) { return is_multiple(p.x, unit) && is_multiple(p.y, unit); }))
      return unit;
  return 0.0;
}

using Change = PoseSample (*)(PoseSample);

struct Mistake {
  const char* what;
  const char* remedy;
  Change mend;
};

PoseSample as_given(PoseSample p) { return p; }

PoseSample negated(PoseSample p) { return p.yaw = -p.yaw, p; }

constexpr const char* kNegate = "negate yaw: it is counter-clockwise, x forward, y left";

constexpr std::array kMistakes = {
    Mistake{"yaw looks like degrees", "multiply yaw by pi / 180",
            [](PoseSample p) { return p.yaw *= math::kPi / 180.0, p; }},
    Mistake{"yaw has the opposite sign of the frame that x and y are in (clockwise, or z down)", kNegate,
            negated},
    Mistake{"yaw is a compass heading (clockwise from y) beside x and y of a map, or x and y are exchanged",
            "write pi / 2 - yaw: yaw is counter-clockwise from x",
            [](PoseSample p) { return p.yaw = 0.5 * math::kPi - p.yaw, p; }},
    Mistake{"yaw is a quarter of a turn off: it looks to the side of the robot",
            "let yaw be the heading of the robot's front",
            [](PoseSample p) { return p.yaw += 0.5 * math::kPi, p; }},
    Mistake{"yaw is half of the heading, as the z of a quaternion read as an angle",
            "write 2 atan2(q_z, q_w)", [](PoseSample p) { return p.yaw *= 2.0, p; }}};

double middle_heading(const PoseSample& a, const PoseSample& b) {
  return a.yaw + 0.5 * std::remainder(b.yaw - a.yaw, 2.0 * math::kPi);
}

struct Stride {
  double x = 0.0, y = 0.0;  ///< way from one pose to the next
  double heading = 0.0;     ///< in the middle of it
};

std::vector<Stride> strides_of(const std::vector<PoseSample>& steps, Change mend) {
  std::vector<Stride> strides;
  for (std::size_t k = 1; k < steps.size(); ++k) {
    const PoseSample a = mend(steps[k - 1]), b = mend(steps[k]);
    strides.push_back({b.x - a.x, b.y - a.y, middle_heading(a, b)});
  }
  return strides;
}

/// Share of the way that goes sideways, 0 to 1; about 0.64 when headings are random.
double sideways(const std::vector<PoseSample>& steps, Change mend) {
  double across = 0.0, all = 0.0;
  for (const auto& [dx, dy, heading] : strides_of(steps, mend)) {
    across += std::abs(dy * std::cos(heading) - dx * std::sin(heading));
    all += std::hypot(dx, dy);
  }
  return all > 0.0 ? across / all : 0.0;
}

/// How much the direction of the way, ahead or back, varies against the heading: its circular variance
/// (Mardia and Jupp, Directional Statistics, 2000, 2.3.1). What looks to the side by an angle that stays does
/// not vary.
double scatter(const std::vector<PoseSample>& steps, Change mend) {
  std::complex<double> sum = 0.0;
  double all = 0.0;
  for (const auto& [dx, dy, heading] : strides_of(steps, mend)) {
    const double length = std::hypot(dx, dy);
    sum += std::polar(length, 2.0 * (std::atan2(dy, dx) - heading));
    all += length;
  }
  return all > 0.0 ? 1.0 - std::abs(sum) / all : 0.0;
}

bool turns_the_other_way(const std::vector<PoseSample>& steps) {
  const double given = scatter(steps, as_given);
  return given > settings::kScatterAtLeast && given > settings::kScatterRatio * scatter(steps, negated);
}

/// Poses so far from each other that noise hardly bends the way; the unit of length may be any.
std::vector<PoseSample> spaced(const std::vector<PoseSample>& poses) {
  double length = 0.0;
  for (std::size_t k = 1; k < poses.size(); ++k)
    length = std::max(length, std::hypot(poses[k].x - poses[0].x, poses[k].y - poses[0].y));
  const double step = settings::kPoseStep * length;
  std::vector<PoseSample> chosen;
  for (const PoseSample& pose : poses)
    if (chosen.empty() || std::hypot(pose.x - chosen.back().x, pose.y - chosen.back().y) > step)
      chosen.push_back(pose);
  return chosen;
}

/// A heading that stays the same while the way turns.
bool heading_stands(const std::vector<PoseSample>& poses) {
  for (const PoseSample& pose : poses)
    if (std::abs(std::remainder(pose.yaw - poses.front().yaw, 2.0 * math::kPi)) > 1e-6) return false;
  return true;
}

struct Subject {
  const char* goes;
  const char* whose;
};
constexpr Subject kPoses{"poses go", "their"}, kOdometry{"the odometry goes", "its"};

std::optional<Error> goes_sideways(const std::vector<PoseSample>& steps, const Subject& subject,
                                   const std::string& where) {
  const double given = sideways(steps, as_given);
  if (given < settings::kSidewaysAtLeast) return std::nullopt;
  const auto wrong = [&](const std::string& what, const std::string& remedy) {
    return Error{ErrorCode::format,
                 std::string(subject.goes) + " sideways over " + std::to_string(std::lround(100.0 * given)) +
                     " % of " + subject.whose + " way: " + what,
                 where, remedy};
  };
  if (heading_stands(steps)) return wrong("yaw never changes", "record the heading of the robot in radians");
  for (const Mistake& mistake : kMistakes)
    if (const double mended = sideways(steps, mistake.mend);
        mended < settings::kSidewaysAtMost && mended < settings::kSidewaysMended * given)
      return wrong(mistake.what, mistake.remedy);
  return std::nullopt;
}

std::optional<Error> wrong_headings(const std::vector<PoseSample>& poses, const Subject& subject,
                                    const std::string& where) {
  const std::vector<PoseSample> steps = spaced(poses);
  if (steps.size() < settings::kFewestPoseSteps) return std::nullopt;
  if (auto error = goes_sideways(steps, subject, where)) return error;
  if (!turns_the_other_way(steps)) return std::nullopt;
  return Error{
      ErrorCode::format,
      "yaw turns clockwise where the way through x and y turns counter-clockwise (yaw clockwise, or a "
      "frame with z down)",
      where, kNegate};
}

}  // namespace

std::optional<double> beside_axle(const Recording& recording) {
  const double track = recording.robot.track_width;
  if (recording.motion != MotionSource::odometry || recording.odometry.empty() || !(track > 0.0))
    return std::nullopt;
  const std::vector<Step> steps = steps_of(recording.odometry);
  std::array<TurnedAbout, 2> sides;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const auto centres = centres_of_turns(steps, k == 0 ? 1.0 : -1.0, settings::kNearWheels * track);
    if (centres.size() < settings::kFewestTurnSteps) return std::nullopt;
    sides.at(k) = where_most_are(centres);
    if (sides.at(k).width > settings::kTurnsAgree * track) return std::nullopt;
  }
  // An arc that is driven ahead lies to the left of the robot in turns to the left, else to the right.
  if (std::abs(sides[0].left - sides[1].left) > settings::kTurnsAgree * track) return std::nullopt;
  const double left = -0.5 * (sides[0].left + sides[1].left);
  return std::abs(left) > settings::kBesideAxle * track ? std::optional(left) : std::nullopt;
}

std::optional<Error> wrong_odometry_frame(const Recording& recording) {
  if (recording.motion != MotionSource::odometry || recording.odometry.empty()) return std::nullopt;
  const std::vector<Step> steps = steps_of(recording.odometry);
  if (steps.size() < settings::kFewestPoseSteps) return std::nullopt;
  const auto sideways = sideways_of(steps);
  if (!sideways) return std::nullopt;
  if (sideways->unexplained > settings::kAsideUnexplained) {
    if (const double rounding = rounding_of(recording.odometry); rounding > 0.0)
      return wrong(recording, sideways->share,
                   "x and y are rounded to " + math::millimetres_text(rounding) +
                       ", which bends the way from one to the next",
                   "write x and y with four digits after the point at least");
    return wrong(
        recording, sideways->share,
        "yaw and place do not belong together, as where yaw is that of a filter or a gyro and the place "
        "is that of the wheels",
        "record the odometry that the wheels alone make, or joint states");
  }
  const double slope = sideways->slope;
  if (std::abs(slope) < settings::kTurnedFrame ||
      std::abs(slope) < settings::kPlainlyTurned * sideways->slope_deviation)
    return std::nullopt;
  const std::string degrees = math::fixed(std::abs(std::atan(slope)) * 180.0 / math::kPi, 1);
  return wrong(recording, sideways->share,
               "its frame is turned " + degrees + " degrees to the " + (slope > 0.0 ? "right" : "left") +
                   " of where the wheels drive",
               "record the frame whose x axis points ahead (base_link), or turn its yaw " + degrees +
                   " degrees to the " + (slope > 0.0 ? "left" : "right"));
}

std::optional<Error> wrong_pose_frame(const Recording& recording) {
  return wrong_headings(recording.poses, kPoses, recording.name);
}

std::optional<Error> wrong_odometry_heading(const Recording& recording) {
  if (recording.motion != MotionSource::odometry) return std::nullopt;
  return wrong_headings(recording.odometry, kOdometry, recording.name);
}

}  // namespace odomcalib::calib::ingest
