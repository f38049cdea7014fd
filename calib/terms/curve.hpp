// The non-parametric fallback: a defect that depends on one observed variable, whatever the law.
#pragma once

#include <array>
#include <vector>

#include "calib/vehicle/carrier.hpp"

namespace odomcalib::calib::terms {

/// Knots over the magnitude of a speed to find a law, and the most to describe it.
inline constexpr int kKnots = 4, kMostKnots = 24;
/// Highest degree of the polynomials of a law; one that was found may be as plain as the least.
inline constexpr int kDegrees = 4, kPlainest = 1;
/// How rough a law may be that is described: deviation of the second differences of neighbouring splines, in
/// typical sizes.
inline constexpr std::array<double, 4> kRoughness = {0.04, 0.16, 0.64, 2.56};
/// That a drive is parted into to find when something happened.
inline constexpr int kMoments = 14;
/// Of an angle, together; higher ones are tried one by one.
inline constexpr int kHarmonics = 3;
/// Of a distance since an event, each at twice the distance of the one before.
inline constexpr int kFadeKnots = 4;
/// Knots each way over a place with patches: a rug has an edge, which no polynomial has.
inline constexpr int kPatches = 4;

/// f(z) = sum of coefficients times basis functions of the variable z:
/// - angles: harmonics 1 to 3, or one alone;
/// - distances since an event: piecewise linear in its logarithm, zero far away;
/// - time, a distance or a wheel's angle with a period: one cosine and one sine;
/// - time that fades: exp(-t / time constant), so that the base is what it comes to, as of a lidar once it is
///   warm;
/// - time with a moment: 0 before it and 1 from then on, as when a load is taken up; on both wheels, for each
///   its own; of a sensor that was moved 1 before it and 0 from then on, for its x, y and yaw on the base;
/// - position: polynomials of degree 1 and 2 in x and y, [low, high] being the range of both; or patches,
///   bilinear between kPatches knots each way; or, of a floor that repeats itself, one wave: its cosine and
///   sine, and both times the cosine of the angle between the heading and the way across the crests;
/// - a push that stays until the opposite one: its sign;
/// - speeds and turn rate: piecewise linear in the magnitude at four knots or cubic splines at more, smooth
/// by a prior on their second differences (P-splines, Eilers and Marx, Stat. Sci. 11, 1996, eq. 6), a step
/// with the direction (on the unsigned way that has this direction a constant), and the magnitude times the
/// direction;
/// - accelerations, once found, may take the splines of speeds: a law of the side that is pushed has a step;
/// - on the sensor's yaw: the variable and its signed square;
/// - all others: Legendre polynomials of degree 1 to `degree` on [low, high], clamped outside and zero at
/// rest. Any other constant is a base parameter's, except on carriers of the unsigned way in drives both
/// ways, and on the turn path, where it is the first function.
struct Curve {
  vehicle::Law law;
  double low = -1.0;
  double high = 1.0;
  double period = 0.0;  ///< in the unit of the variable; 0: none
  int harmonic = 0;     ///< of angles only: this one alone; 0: the first three
  /// Subtracted from the functions; none: 0. Functions that are zero at rest leave the base parameters the
  /// meaning of slow motion; functions without a mean leave them that of the drive they were fitted to.
  std::vector<double> mean = {};
  int knots = kKnots;                          ///< of speeds and accelerations only
  std::size_t memory = vehicle::kUsualMemory;  ///< of what happened before only: which way to understand it
  std::array<double, 2> wave{};                ///< of position only: cycles per m along x and y; zero: none
  bool constant = false;                       ///< of heading only: with a constant as the first function
  bool patches = false;                        ///< of position only
  bool with_motion = false;  ///< of accelerations only: growth of the pace, so that braking is negative
  bool strong = false;       ///< a tenth and more, which few robots do and only plain data should be believed
  int degree = kDegrees;     ///< of Legendre polynomials only
  double moment = 0.0;       ///< of time only, s: when it changes, all at once; 0: bit by bit
  double fading = 0.0;       ///< of time only, s: time constant of what fades away; 0: it does not
  /// Of splines only: of each second difference, see kRoughness; none: each spline by itself.
  std::vector<double> roughness = {};
  bool operator==(const Curve&) const = default;
  [[nodiscard]] bool is_wave() const { return wave[0] != 0.0 || wave[1] != 0.0; }
};

/// A mast that sways: the sensor turns on the base.
bool is_sway(const Curve& curve);
/// A sensor that was moved on the base at some moment.
bool is_bump(const Curve& curve);
/// A change of the sensor's place on the base.
bool concerns_sensor(const Curve& curve);
/// That, a metre that changes as a lidar warms up, or a sideways motion that goes with time or with the last
/// turn: no base begins to crab, but a mount gives way. None of odometry's.
bool is_the_lidars(const Curve& curve);

/// Has a phase or an origin that the next drive does not share.
bool is_of_one_drive(const Curve& curve);

/// Begins with a stop or a push, of which it is not known how long or how hard it has to be.
bool takes_an_event(const Curve& curve);

/// All of it at one moment: no law that bends, but an event.
bool happens_at_once(const Curve& curve);

/// Described by Legendre polynomials.
bool has_polynomials(const Curve& curve);

/// Described by splines, which also accelerations may be.
bool has_splines(const Curve& curve);

/// The same curve, expected to be large.
Curve strong(Curve curve);

}  // namespace odomcalib::calib::terms
