// Bases whose sum a smooth term may be: a closed set, each with its own settings.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <variant>
#include <vector>

#include "calib/vehicle/channel.hpp"

namespace odomcalib::calib::terms {

/// The most functions that a basis may have.
inline constexpr std::size_t kMostFunctions = 27;

/// A basis' functions' values. They are computed for each tick interval of each fit, so they stay off the
/// heap.
class BasisValues {
 public:
  BasisValues() = default;
  /// All zero.
  explicit BasisValues(std::size_t count) : count_(count) { std::fill_n(values_.begin(), count, 0.0); }
  BasisValues(std::initializer_list<double> values) {
    for (const double value : values) push_back(value);
  }
  void push_back(double value) { values_[count_++] = value; }
  [[nodiscard]] std::size_t size() const { return count_; }
  double& operator[](std::size_t k) { return values_[k]; }
  double operator[](std::size_t k) const { return values_[k]; }
  [[nodiscard]] const double* begin() const { return values_.data(); }
  [[nodiscard]] const double* end() const { return values_.data() + count_; }

 private:
  std::array<double, kMostFunctions> values_;  // NOLINT(*-member-init): the first `count_` are set
  std::size_t count_ = 0;
};

/// The values of one interval that a basis sees.
struct Argument {
  double z;                              ///< the covariate, in its unit
  double low, high;                      ///< its range in the drives that the smooth term was fitted to
  vehicle::Dependence dependence;        ///< which covariate it is, and on what the smooth term acts
  const vehicle::StepContext& interval;  ///< for what takes more than one covariate

  /// A value of the covariate on its range, -1 to 1, clamped outside.
  [[nodiscard]] double scaled(double value) const {
    return std::clamp(2.0 * (value - low) / (high - low) - 1.0, -1.0, 1.0);
  }
  /// The covariate as a share of the largest magnitude in its range, -1 to 1, clamped outside.
  [[nodiscard]] double relative() const {
    return std::clamp(z / std::max(std::abs(low), std::abs(high)), -1.0, 1.0);
  }
};

/// Highest degree of the polynomials of a term; one that was found may be as plain as the least.
inline constexpr int kHighestDegree = 4, kPlainest = 1;

/// Degree 1 to `degree` on the covariate's range, clamped outside. Zero at rest where the covariate has a
/// rest, so that the base parameters keep their meaning of slow, steady motion; time has none.
struct Polynomials {
  int degree = kHighestDegree;
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Polynomials&, const Polynomials&) = default;
};

/// Knots over the magnitude of a speed to find a term.
inline constexpr int kKnots = 4;

/// Piecewise linear in the magnitude, zero at rest, and what the direction adds.
struct SpeedHats {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const SpeedHats&, const SpeedHats&) = default;
};

/// The most knots over the magnitude of a speed to describe a term.
inline constexpr int kMostKnots = 24;
/// How rough a term may be that is described: deviation of the second differences of neighbouring splines, in
/// typical sizes.
inline constexpr std::array<double, 4> kRoughness = {0.04, 0.16, 0.64, 2.56};

/// Cubic splines of the magnitude, zero at rest, and what the direction adds. They are smooth by a prior on
/// their second differences (P-splines, Eilers and Marx, Stat. Sci. 11, 1996, eq. 6). Accelerations may take
/// them too: a term of the side that is pushed has a step.
struct Splines {
  int knots = kMostKnots;
  /// How rough the term may be: expected deviation of each second difference of neighbouring splines, in
  /// typical sizes; none: each spline by itself.
  std::vector<double> roughness = {};
  [[nodiscard]] BasisValues values(const Argument& at) const;
  /// Sums of coefficients that are expected to be zero with deviation 1.
  /// @param strength, typical_size whose product roughness is counted in
  /// @param count number of the basis' functions
  [[nodiscard]] std::vector<std::vector<double>> penalty(double strength, double typical_size,
                                                         std::size_t count) const;
  friend bool operator==(const Splines&, const Splines&) = default;
};

/// A constant, the magnitude of the speed, its direction, and both times each other. The constant belongs to
/// no base parameter here.
struct TurnPath {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  /// Where turns of one speed cannot show which, each radian leaves the same way.
  [[nodiscard]] static double prior(std::size_t function, double usual) {
    return function > 0 ? 0.25 * usual : usual;
  }
  friend bool operator==(const TurnPath&, const TurnPath&) = default;
};

/// Harmonics of an angle, together; higher ones are tried one by one.
inline constexpr int kHarmonics = 3;

/// Cosine and sine of the first three multiples of the covariate, or of a single one.
struct Harmonics {
  int only = 0;           ///< which multiple alone; 0: the first three
  bool constant = false;  ///< with a constant as the first function
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Harmonics&, const Harmonics&) = default;
};

/// One cosine and one sine of time, of a distance, or of a wheel's angle.
struct Cycle {
  double period = 1.0;  ///< in the unit of the covariate, positive
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Cycle&, const Cycle&) = default;
};

/// Knots over the distance since an event, each at twice the distance of the one before.
inline constexpr int kFadeKnots = 4;

/// Piecewise linear in the logarithm of the distance, flat towards zero, nothing beyond the last knot's
/// double.
struct FadingSince {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  /// The loss between one knot and the next is as much everywhere, the way between them half as long.
  /// @param usual deviation that is expected of a coefficient
  [[nodiscard]] static double prior(std::size_t function, double usual);
  friend bool operator==(const FadingSince&, const FadingSince&) = default;
};

/// The sign of the last acceleration beyond a threshold (the relay of Krasnosel'skii and Pokrovskii, Systems
/// with Hysteresis, 1989).
struct Relay {
  [[nodiscard]] static BasisValues values(const Argument& at) { return {at.z}; }
  friend bool operator==(const Relay&, const Relay&) = default;
};

/// Parts into which a drive is cut to find when something happened.
inline constexpr int kChangePoints = 14;

/// 0 before the moment and 1 from then on, as when a load is taken up; on both wheels, one function for each.
/// A sensor that was moved has 1 before it and 0 from then on, for its x, y and yaw on the base: what is
/// stated of its place is where it is now.
struct ChangePoint {
  double moment = 0.0;  ///< s after the recording's first sample
  /// Functions of a smooth term that acts there.
  static std::size_t parts(vehicle::Channel channel);
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const ChangePoint&, const ChangePoint&) = default;
};

/// exp(-t / time constant), so that the base is what it comes to, as of a lidar once it is warm.
struct Decay {
  double time_constant = 1.0;  ///< s, positive
  [[nodiscard]] BasisValues values(const Argument& at) const { return {std::exp(-at.z / time_constant)}; }
  friend bool operator==(const Decay&, const Decay&) = default;
};

/// The covariate and its signed square: both directions alike, more than linear at most by a square.
struct Sway {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Sway&, const Sway&) = default;
};

/// Polynomials of degree 1 and 2 in x and y, both on one range.
struct Surface {
  [[nodiscard]] static BasisValues values(const Argument& at) {
    const double x = at.scaled(at.interval.x), y = at.scaled(at.interval.y);
    return {x, y, x * x, x * y, y * y};
  }
  friend bool operator==(const Surface&, const Surface&) = default;
};

/// Knots each way over a place with patches: a rug has an edge, which no polynomial has.
inline constexpr int kPatches = 4;

/// Bilinear between the knots, one after another along x for each along y.
struct Patches {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Patches&, const Patches&) = default;
};

/// A plane wave over the place: its cosine and sine, a level that comes and goes, and both times the cosine
/// of the angle between the heading and the way across the crests, a slope that lengthens one way and
/// shortens the other.
struct Wave {
  double along_x = 0.0, along_y = 0.0;  ///< cycles per m, not both zero
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Wave&, const Wave&) = default;
};

/// Each gives the values of its functions in an interval (`values`); one whose coefficients are not all
/// expected to be alike says so (`prior`, `penalty`).
using Basis = std::variant<Polynomials, SpeedHats, Splines, TurnPath, Harmonics, Cycle, FadingSince, Relay,
                           ChangePoint, Decay, Sway, Surface, Patches, Wave>;

/// The plainest basis for a term, in which it is sought first.
/// @param memory which way to understand what happened before, see vehicle::memories_of
Basis usual_basis(const vehicle::Dependence& dependence, std::size_t memory);

}  // namespace odomcalib::calib::terms
