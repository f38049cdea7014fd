// Covariates that few terms look at, with what each remembers of the drive so far: they are computed in
// groups, as a model needs them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "calib/math/se2.hpp"
#include "calib/vehicle/enum_set.hpp"

namespace odomcalib::calib::vehicle {

/// Covariates that are computed together.
enum class CovariateGroup : unsigned {
  acceleration_changes,
  sway,
  tyre_relaxation,
  gear_play,
  stops,
  winding,  ///< begins where a stop does: computed beside `stops` only
  previous_turn,
  previous_acceleration,
  caster,
};
inline constexpr CovariateGroup kLastCovariateGroup = CovariateGroup::caster;

using CovariateGroups = EnumSet<CovariateGroup>;
inline constexpr CovariateGroups kAllCovariateGroups = CovariateGroups::up_to(kLastCovariateGroup);

/// Spans over which the memory of a motion fades, the usual one second: nobody knows how long a robot
/// remembers.
inline constexpr std::array<double, 8> kMemorySpans = {0.3, 1.0, 3.3, 0.2, 0.45, 0.67, 1.5, 2.2};
inline constexpr std::size_t kUsualMemory = 1;
using Memory = std::array<double, kMemorySpans.size()>;

/// m/s^2; what an acceleration of such size moved stays until one the other way (the relay of Krasnosel'skii
/// and Pokrovskii, Systems with Hysteresis, 1989, section 28, its thresholds symmetrical).
inline constexpr std::array<double, 13> kAccelerationThresholds = {0.1,  0.12, 0.145, 0.17, 0.205, 0.25, 0.3,
                                                                   0.36, 0.43, 0.5,   0.6,  0.75,  0.9};
/// Means as in Memory, then relays.
struct AccelerationMemory {
  Memory means{};
  std::array<std::int8_t, kAccelerationThresholds.size()> relays{};  ///< -1, 0 or 1

  [[nodiscard]] static constexpr std::size_t size() {
    return kMemorySpans.size() + kAccelerationThresholds.size();
  }
  double operator[](std::size_t k) const { return k < means.size() ? means[k] : relays[k - means.size()]; }
};

/// Memory of the way the robot turned lately.
class PreviousTurn {
 public:
  [[nodiscard]] const Memory& value() const { return memory_; }
  /// @param yaw rad, turned in an interval
  void advance(double yaw);

 private:
  Memory memory_{};
};

/// Memory of the way it accelerated lately.
class PreviousAcceleration {
 public:
  [[nodiscard]] const AccelerationMemory& value() const { return memory_; }
  /// @param acceleration m/s^2, forward
  /// @param peak m/s^2, which it comes to before it falls below the least threshold
  /// @param dt s
  void advance(double acceleration, double peak, double dt);

 private:
  AccelerationMemory memory_{};
};

/// s; how long a robot has to stand until something sticks is not known either. Shorter stops are reversals.
inline constexpr std::array<double, 14> kStops = {0.12,  0.14, 0.155, 0.17, 0.19, 0.21, 0.23,
                                                  0.255, 0.28, 0.31,  0.34, 0.37, 0.41, 0.45};
using SinceStop = std::array<double, kStops.size()>;

/// How far back the last stop lies.
class Standstill {
 public:
  Standstill();
  /// @param relative_speed of the rims of late, in units of the least that is no standing
  /// @param dt s
  void arrive(double relative_speed, double dt);
  /// @param way m, mean of the two rims in the interval
  void leave(double way);
  /// s; 0 while it moves
  [[nodiscard]] double stood() const { return stood_; }
  /// It moves again in this interval, after it had stood.
  [[nodiscard]] bool sets_off() const { return sets_off_; }
  /// Way since it last stood still for each of kStops, m.
  [[nodiscard]] const SinceStop& since() const { return since_; }

 private:
  double relative_speed_ = 0.0;
  double stood_ = 0.0;  ///< s
  bool sets_off_ = false;
  SinceStop since_{};
};

/// Winding released after a stop, as shares of the most that a motion can wind up: a straight motion winds
/// up by its way, one on the spot by its turn, -1 to 1 in all.
struct ReleasedWinding {
  double way = 0.0;
  double turn = 0.0;
};
/// The next few centimetres wind up anew whatever they are, as they do with the side walls of tyres; or a
/// turn stays wound up until another.
inline constexpr std::size_t kWindings = 2;

/// Winding that tyres, belts and gears release at rest after a motion has wound them up.
class Winding {
 public:
  struct Rims {
    double left = 0.0, right = 0.0;  ///< m, of either in the interval
    double speed = 0.0;              ///< m/s, of the faster one
  };
  /// @param step of the base; @param dt s
  /// @return what unwinds in the interval, by each way of winding up
  std::array<ReleasedWinding, kWindings> advance(const Standstill& standstill, const Rims& rims,
                                                 const math::Pose& step, double dt);
  /// Rim speed since the robot last stood, m/s.
  [[nodiscard]] double fastest() const { return fastest_; }

 private:
  void wind_up(const Rims& rims, const math::Pose& step);
  std::array<ReleasedWinding, kWindings> unwind(double duration);

  std::array<ReleasedWinding, kWindings> wound_{};
  double fastest_ = 0.0;
};

/// s; the time constants by which a mast may follow the base's acceleration late, the usual one second (see
/// kUsualMemory).
inline constexpr std::array<double, 4> kSwayLags = {0.05, 0.0, 0.1, 0.2};
using Sways = std::array<double, kSwayLags.size()>;

/// A mast with friction follows with a time constant.
class SwayLag {
 public:
  /// @param before rad/s^2, at the begin of an interval, as late as each lag when this returns
  /// @param after the same at its end
  /// @param dt s
  void advance(Sways& before, Sways& after, double dt);

 private:
  Sways bend_{};
};

/// m; the ways over which tyres take up a slip angle are not known either (Pacejka, Tire and Vehicle
/// Dynamics, chapter 7).
inline constexpr std::array<double, 3> kRelaxations = {0.03, 0.07, 0.15};
using Relaxed = std::array<double, kRelaxations.size()>;

/// Causes of the tyres' sideways slip, as late as the tyres follow them.
class TyreRelaxation {
 public:
  /// @param way m, of the base in its direction; @param turn_rate rad/s; @param lateral_acceleration m/s^2
  void advance(double way, double turn_rate, double lateral_acceleration);
  [[nodiscard]] const Relaxed& turn_rate() const { return turn_rate_; }                        ///< rad/s
  [[nodiscard]] const Relaxed& lateral_acceleration() const { return lateral_acceleration_; }  ///< m/s^2

 private:
  Relaxed turn_rate_{}, lateral_acceleration_{};
};

/// rad; the play of a gear train is not known either (Renard numbers, ISO 3, R10).
inline constexpr std::array<double, 20> kPlays = {0.004, 0.005, 0.0063, 0.008, 0.01, 0.0125, 0.016,
                                                  0.02,  0.025, 0.0315, 0.04,  0.05, 0.063,  0.08,
                                                  0.1,   0.125, 0.16,   0.2,   0.25, 0.315};
using LostToPlay = std::array<double, kPlays.size()>;

/// Rotation that a gear train with play loses when its motor turns round, for each of kPlays.
class GearPlay {
 public:
  /// @param delta rad, rotation of the wheel in an interval
  /// @param dither rad, within which a wheel that stands may show either of two counts
  /// @return rotation of this interval that does not reach the wheel, rad
  LostToPlay advance(double delta, double dither);

 private:
  bool has_moved_ = false;
  std::array<double, kPlays.size()> gap_{};  ///< rad, from the flank that drives backwards
};

/// m; trails of casters are not known either ...
inline constexpr std::array<double, 6> kCasterTrails = {0.02, 0.028, 0.04, 0.057, 0.08, 0.113};
/// ... nor by how much a caster that has settled still points past its way, rad: to which side it falls after
/// a straight motion is reversed hangs on this alone.
inline constexpr std::array<double, 5> kCasterLeans = {0.0, -0.002, 0.002, -0.01, 0.01};
inline constexpr std::size_t kCasters = kCasterTrails.size() * kCasterLeans.size();  ///< by trail, then lean
using CasterSines = std::array<double, kCasters>;

/// Where a caster behind the axle points, for each trail and lean.
class CasterSwing {
 public:
  /// @param step of the base; @param track_width m
  /// @return sine of the angle by which each still points past the way its pivot moves
  CasterSines advance(const math::Pose& step, double track_width);

 private:
  std::array<double, kCasters> direction_{};  ///< rad, in which each would roll, base axes
};

/// Rotation of each wheel in an interval that a gear train with each of kPlays loses, rad.
struct LostByWheels {
  LostToPlay left{}, right{};
};

inline constexpr LostByWheels kNothingLost{};
inline constexpr CasterSines kNoSwing{};

/// Covariates of which an interval has dozens of values, and that one effect each asks for: no interval holds
/// them itself.
class OnDemand {
 public:
  OnDemand() = default;
  virtual ~OnDemand() = default;
  OnDemand(const OnDemand&) = delete;
  OnDemand& operator=(const OnDemand&) = delete;
  [[nodiscard]] virtual const LostByWheels& lost_to_play(std::size_t interval) const = 0;
  [[nodiscard]] virtual const CasterSines& caster(std::size_t interval) const = 0;
};

}  // namespace odomcalib::calib::vehicle
