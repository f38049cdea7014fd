#include "calib/classical/length_factor.hpp"

#include <array>
#include <cmath>

#include "calib/classical/settings.hpp"
#include "calib/math/number_text.hpp"
#include "calib/math/se2.hpp"
#include "proto/recording/motion_units.hpp"

namespace odomcalib::calib::classical {
namespace {

std::string number(double value) { return math::significant(value, 3); }

/// The number to type: a factor of a unit, counts.
std::string exact(double value) { return math::significant(value, 6); }

bool is_one(double ratio) { return ratio > 1.0 / settings::kSameLength && ratio < settings::kSameLength; }

bool is_near(double ratio, double factor) { return std::abs(ratio / factor - 1.0) < settings::kSameFactor; }

struct Factor {
  double ratio;
  const char* reason;
  enum class Kind { any, of_ranges, of_a_gear } kind = Kind::any;
};
constexpr auto kOfRanges = Factor::Kind::of_ranges;  ///< no other reference has that mistake
constexpr auto kOfAGear = Factor::Kind::of_a_gear;   ///< gears have any ratio, not this one only

constexpr std::array kOfAllLengths = {
    Factor{1e3, "lengths of the reference are in millimetres"},
    Factor{1e2, "lengths of the reference are in centimetres"},
    Factor{1.0 / 0.0254, "lengths of the reference are in inches"},
    Factor{1.0 / 0.3048, "lengths of the reference are in feet"},
    Factor{2.0, "ranges are twice as long as they are: the way there and back was not halved", kOfRanges},
    Factor{0.5, "ranges are half as long as they are: they were halved twice", kOfRanges},
    Factor{0.25, "ranges in quarters of a millimetre were taken for millimetres", kOfRanges},
    Factor{4.0, "ranges in millimetres were taken for four times as much", kOfRanges},
    Factor{0.3048, "wheel_diameter and track_width are in feet"},
    Factor{0.0254, "wheel_diameter and track_width are in inches"},
    Factor{1e-2, "wheel_diameter and track_width are in centimetres"},
    Factor{1e-3, "wheel_diameter and track_width are in millimetres"}};

constexpr std::array kOfCounts = {
    Factor{4.0, "ticks_per_rev counts all four edges of a period, the recorded counts only one"},
    Factor{0.25, "ticks_per_rev counts one edge of a period, the recorded counts all four"},
    Factor{2.0, "the radius was given as diameter, or ticks_per_rev counts twice the edges that come"},
    Factor{0.5, "ticks_per_rev counts half of the edges that come, or the diameter was doubled"},
    Factor{0.5 / math::kPi, "ticks_per_rev is counts per radian"},
    Factor{2.0 * math::kPi, "ticks_per_rev was multiplied by 2 pi"},
    Factor{1.5, "ticks_per_rev has a gear ratio in it that the counts have not", kOfAGear},
    Factor{2.0 / 3.0, "ticks_per_rev lacks a gear ratio", kOfAGear}};

constexpr std::array kOfDiameters = {Factor{2.0, "the radius was given as diameter"},
                                     Factor{0.5, "the diameter was doubled"},
                                     Factor{1.0 / math::kPi, "the circumference was given as diameter"},
                                     Factor{math::kPi, "the diameter was divided by pi"},
                                     Factor{0.0254, "wheel_diameter is in inches"},
                                     Factor{1e-2, "wheel_diameter is in centimetres"},
                                     Factor{1e-3, "wheel_diameter is in millimetres"}};

constexpr std::array kOfTrack = {Factor{2.0, "it was measured from the middle of the robot to a wheel"},
                                 Factor{0.5, "it was doubled"}, Factor{0.0254, "it is in inches"},
                                 Factor{1e-2, "it is in centimetres"}, Factor{1e-3, "it is in millimetres"}};

/// A factor that was found. What is typed by a measured ratio makes lengths nominal again, wrong as these
/// are; what has a name is typed as the name says.
struct Found {
  double measured;
  const Factor* named = nullptr;
  [[nodiscard]] bool is_exact() const { return named != nullptr && named->kind != kOfAGear; }
  [[nodiscard]] double ratio() const { return is_exact() ? named->ratio : measured; }
  [[nodiscard]] std::string because() const {
    if (named == nullptr) return "";
    return ": it looks as if " + std::string(named->reason) +
           (is_exact() ? " (a factor of " + number(named->ratio) + ")" : "");
  }
};

template <std::size_t kCount>
const Factor* factor_for(const std::array<Factor, kCount>& table, double ratio, bool of_poses = false) {
  for (const Factor& factor : table)
    if (is_near(ratio, factor.ratio) && !(factor.kind == kOfRanges && of_poses)) return &factor;
  return nullptr;
}

/// Three digits, and no exponent in a number of counts.
std::string rounded(double value) {
  const double digit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return exact(digit * std::round(value / digit));
}

/// To type, and how good it is.
std::string to_type(const Found& found, double value) {
  return found.is_exact() ? exact(value) : "about " + rounded(value);
}

constexpr const char* kOnlyAbout = ": only as good as the nominal values, look up the true one";

std::string values_of(MotionSource motion) {
  switch (motion) {
    case MotionSource::wheels:
      return "the angles of the wheels";
    case MotionSource::wheel_speeds:
      return "the speeds of the wheels";
    case MotionSource::odometry:
      return "x and y of the odometry";
    case MotionSource::ticks:
      break;
  }
  return "the counts";
}

/// The unit in which numbers would be so many times as large; the nearest where several are near.
const MotionUnit* unit_for(const Measured& measured, double times) {
  const MotionUnit* nearest = nullptr;
  const auto distance = [&](const MotionUnit& unit) {
    return std::abs(std::log(times / factor_of(unit, measured.robot)));
  };
  for (const MotionUnit& unit : motion_units())
    if (unit.source == measured.motion && is_near(times, factor_of(unit, measured.robot)) &&
        (nearest == nullptr || distance(unit) < distance(*nearest)))
      nearest = &unit;
  return nearest;
}

Cause of_unit(const MotionUnit& unit, const Measured& measured, double times) {
  const std::string values = values_of(measured.motion);
  const double factor = factor_of(unit, measured.robot);
  return {values + " look like " + unit.words + ": they are " + number(times) + " times as large as " +
              si_unit_of(measured.motion) + " would be (" + unit.words + ": " + number(factor) + ")",
          "multiply them by " + exact(1.0 / factor)};
}

Cause of_all(double ratio, const Measured& measured) {
  if (const MotionUnit* unit = unit_for(measured, 1.0 / ratio)) return of_unit(*unit, measured, 1.0 / ratio);
  const Found found{ratio, factor_for(kOfAllLengths, ratio, measured.of_poses)};
  const std::string lengths = measured.of_poses ? "x and y of the poses" : "ranges and their limits";
  const bool odometry = measured.motion == MotionSource::odometry;
  const std::string own =
      odometry ? ", or x and y of the odometry are " + number(1.0 / ratio) + " times as long as they are"
               : "";
  return {"both wheel diameters and the track width come out " + number(ratio) +
              " times their nominal values, so that a unit or the scale of the reference is wrong" +
              found.because() + own,
          "measure a wheel with a tape; then multiply " + lengths + " by " +
              to_type(found, 1.0 / found.ratio()) +
              (odometry ? ", or x and y of the odometry by " + to_type(found, found.ratio()) : "") +
              ", or wheel_diameter and track_width by " + to_type(found, found.ratio()) +
              (found.is_exact() ? "" : kOnlyAbout)};
}

bool is_large(double ratio) { return ratio > settings::kGearFactor || ratio < 1.0 / settings::kGearFactor; }

std::string diameter_for(double ratio, const RobotDescription& robot) {
  return number(0.5 * (robot.left_wheel_diameter + robot.right_wheel_diameter) * ratio) + " m";
}

std::string of_both(double ratio) {
  return "both wheel diameters come out " + number(ratio) +
         " times their nominal values, the track width does not";
}

Cause of_counted_wheels(double ratio, const RobotDescription& robot) {
  static constexpr Factor kGear{0.0, "counts are those of the motor before a gear, or ticks_per_rev is",
                                kOfAGear};
  Found found{ratio, factor_for(kOfCounts, ratio)};
  const Factor* of_diameter = found.named == nullptr ? factor_for(kOfDiameters, ratio) : nullptr;
  if (of_diameter != nullptr) found.named = of_diameter;
  if (found.named == nullptr && is_large(ratio)) found.named = &kGear;
  const std::string resolution = "ticks_per_rev to " + to_type(found, robot.ticks_per_rev / found.ratio()) +
                                 " instead of " + exact(robot.ticks_per_rev) +
                                 (found.is_exact() ? "" : kOnlyAbout) + "; or ";
  return {of_both(ratio) + found.because(), "set " + (of_diameter != nullptr ? "" : resolution) +
                                                "wheel_diameter to " + diameter_for(found.ratio(), robot) +
                                                "; a tape at the wheel tells" +
                                                (of_diameter != nullptr ? "" : " which")};
}

/// Where there are no counts there is nothing to say about ticks_per_rev.
Cause of_wheels(double ratio, const Measured& measured) {
  if (measured.motion == MotionSource::ticks) return of_counted_wheels(ratio, measured.robot);
  if (const MotionUnit* unit = unit_for(measured, 1.0 / ratio)) return of_unit(*unit, measured, 1.0 / ratio);
  static constexpr Factor kGear{0.0, "they are those of the motor before a gear", kOfAGear};
  const std::string values = values_of(measured.motion);
  Found found{ratio, factor_for(kOfDiameters, ratio)};
  if (found.named == nullptr && is_large(ratio)) found.named = &kGear;
  const bool are_counts = 1.0 / ratio > settings::kCountsFactor && measured.motion != MotionSource::odometry;
  return {of_both(ratio) + ": " + values + " are " + number(1.0 / ratio) + " times as large as the wheels'" +
              (are_counts ? ": they look like encoder counts, some " + rounded(2.0 * math::kPi / ratio) +
                                " a turn of the wheel"
                          : found.because()),
          "multiply " + values + " by " + to_type(found, found.ratio()) +
              (found.is_exact() ? "" : kOnlyAbout) +
              (are_counts ? ""
                          : "; or set wheel_diameter to " + diameter_for(found.ratio(), measured.robot) +
                                "; a tape at the wheel tells which")};
}

Cause of_track(const Found& found, const RobotDescription& robot) {
  return {"track_width comes out " + number(found.measured) +
              " times its nominal value, the wheel diameters do not" + found.because(),
          "measure it from where one wheel touches the floor to where the other does, and set track_width "
          "to about " +
              number(robot.track_width * found.ratio()) + " m"};
}

Cause of_one_wheel(const std::string& side, double ratio) {
  return {"the " + side + " wheel diameter comes out " + number(ratio) +
              " times its nominal value, the other one does not: the encoders count unlike each other",
          "check that both encoders have the same resolution, gear and edges per period, or state "
          "left_wheel_diameter and right_wheel_diameter"};
}

}  // namespace

std::optional<Cause> cause_of_ratios(const LengthRatios& ratios, const Measured& measured) {
  const auto [left, right, track] = ratios;
  for (const double ratio : {left, right, track})
    if (!(ratio > 0.0) || !std::isfinite(ratio)) return std::nullopt;
  const bool left_fits = is_one(left), right_fits = is_one(right), track_fits = is_one(track);
  const double mean = 0.5 * (left + right);
  if (!left_fits && !right_fits && is_near(left, right)) {
    if (track_fits) return of_wheels(mean, measured);
    if (is_near(track, mean)) return of_all((left + right + track) / 3.0, measured);
    return std::nullopt;
  }
  if (const Found found{track, factor_for(kOfTrack, track)};
      left_fits && right_fits && !track_fits && (found.named != nullptr || is_large(track)))
    return of_track(found, measured.robot);
  if (track_fits && left_fits != right_fits) {
    const double odd = left_fits ? right : left;
    if (odd > settings::kUnlikeCounts / settings::kSameLength ||
        odd < settings::kSameLength / settings::kUnlikeCounts)
      return of_one_wheel(left_fits ? "right" : "left", odd);
  }
  return std::nullopt;
}

}  // namespace odomcalib::calib::classical
