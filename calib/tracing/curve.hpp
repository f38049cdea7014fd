// The non-parametric fallback: a defect that depends on one observed variable, whatever the law.
#pragma once

#include <array>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/carrier.hpp"
#include "calib/model/drive_model.hpp"

namespace odomcalib::calib {

/// Knots over the magnitude of a speed: the first to find a law, the others to describe it.
inline constexpr std::array<int, 4> kKnots = {4, 8, 12, 16};
/// Knots each way over a place with patches: a rug has an edge, which no polynomial has.
inline constexpr int kPatches = 4;

/// f(z) = sum of coefficients times basis functions of the variable z:
/// - angles: harmonics 1 to 3, or one alone;
/// - distances since an event: piecewise linear in its logarithm, zero far away;
/// - time with a period: one cosine and one sine;
/// - position: polynomials of degree 1 and 2 in x and y, [low, high] being the range of both; or patches,
///   bilinear between kPatches knots each way; or, of a floor that repeats itself, one wave: its cosine and
///   sine, and both times the cosine of the angle between the heading and the way across the crests;
/// - a push that stays until the opposite one: its sign;
/// - speeds and turn rate: piecewise linear in the magnitude at four knots or cubic splines at more, a step
/// with the direction, and the magnitude times the direction;
/// - on the sensor's yaw: the variable and its signed square;
/// - all others: Legendre polynomials of degree 1 to 4 on [low, high], clamped outside and zero at rest.
/// A constant is a base parameter's, except on carriers of the unsigned way in drives both ways, and on the
/// turn path, where it is the first function.
struct Curve {
  Law law;
  double low = -1.0;
  double high = 1.0;
  double period = 0.0;  ///< s, of time only; 0: none
  int harmonic = 0;     ///< of angles only: this one alone; 0: the first three
  /// Subtracted from the functions; none: 0. Functions that are zero at rest leave the base parameters the
  /// meaning of slow motion; functions without a mean leave them that of the drive they were fitted to.
  std::vector<double> mean = {};
  int knots = kKnots.front();         ///< of speeds only
  std::size_t memory = kUsualMemory;  ///< of what happened before only: which way to understand it
  std::array<double, 2> wave{};       ///< of position only: cycles per m along x and y; zero: none
  bool constant = false;              ///< of heading only: with a constant as the first function
  bool patches = false;               ///< of position only
  bool strong = false;  ///< a tenth and more, which few robots do and only plain data should be believed
  bool operator==(const Curve&) const = default;
  [[nodiscard]] bool is_wave() const { return wave[0] != 0.0 || wave[1] != 0.0; }
};

/// A curve's functions' values. They are asked for each tick interval of each fit, so they stay off the
/// heap.
class BasisValues {
 public:
  BasisValues() = default;
  /// All zero.
  explicit BasisValues(std::size_t count) : count_(count) {}
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
  std::array<double, kKnots.back() + 3> values_{};
  std::size_t count_ = 0;
};

BasisValues basis(const Curve& curve, const StepContext& context);
std::size_t basis_size(const Curve& curve);

/// What the coefficients are multiplied by in an interval: the basis, or on the sensor's yaw its growth.
BasisValues functions_in(const Curve& curve, const StepContext& context);

std::shared_ptr<const Effect> make_curve_effect(const Curve& curve);

/// The same curve, expected to be large.
Curve strong(Curve curve);

/// The same curve about its mean over these drives.
Curve centred(Curve curve, std::span<const DriveModel* const> models);

/// Root mean square of the curve over the motion of its carrier in these drives.
double spread_of(const Curve& curve, std::span<const double> coefficients,
                 std::span<const DriveModel* const> models);

/// Driven one way only, the mean of a pull over the headings is a difference of the wheels.
bool leaves_mean_to_wheels(const Curve& curve, std::span<const DriveModel* const> models);

/// The same law in other shapes: more knots, other ways to understand what happened before.
std::vector<Curve> other_shapes(const Curve& curve, std::span<const DriveModel* const> models);

/// A dependence of the sensor's place on the base: none of odometry's.
bool concerns_sensor(const Curve& curve);

/// Curves worth trying on this data: every sensible (variable, carrier) whose variable varies, on its 0.5 to
/// 99.5 % range, higher harmonics of the wheels, and
/// periods of time between 8 s and two thirds of the recording.
std::vector<Curve> candidate_curves(std::span<const DriveModel* const> models);

}  // namespace odomcalib::calib
