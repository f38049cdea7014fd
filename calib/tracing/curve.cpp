#include "calib/tracing/curve.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <tuple>

#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

constexpr std::size_t kDegrees = 4;
constexpr int kHarmonics = 3;
constexpr int kHighestHarmonic = 8;      ///< poles of encoder magnets, lugs, spokes
constexpr double kMoving = 0.01;         ///< m/s of either wheel; standing still shows nothing
constexpr int kFadeKnots = 4;            ///< each at twice the distance of the one before
constexpr double kNearestLength = 0.03;  ///< m of the base
constexpr double kNearestAngle = 0.2;    ///< rad of a wheel

using Carriers = std::vector<Carrier>;

/// A wheel's own variables act on that wheel; a pair that no mechanism links only adds false alarms.
Carriers carriers_of(Variable variable) {
  using enum Carrier;
  switch (variable) {
    case Variable::left_speed:
    case Variable::left_phase:
    case Variable::left_since_reversal:
      return {left_travel};
    case Variable::right_speed:
    case Variable::right_phase:
    case Variable::right_since_reversal:
      return {right_travel};
    case Variable::left_acceleration:
      return {left_travel, left_path};
    case Variable::right_acceleration:
      return {right_travel, right_path};
    case Variable::turn_acceleration:
      return {sensor_yaw};
    case Variable::speed:
      return {both_travel, track, sideways, turn_side};
    case Variable::turn_rate:
      return {both_travel, left_travel, right_travel, track, sideways, turn_path, turn_side};
    case Variable::lateral_acceleration:
      return {sideways, sideways_path, track};
    case Variable::time:
      return {both_travel, left_travel, right_travel, track, sideways, turn_side};
    case Variable::heading:
    case Variable::position:
      return {both_travel, left_travel, right_travel, both_path, sideways_path, yaw_path};
    case Variable::since_reversal:
    case Variable::since_stop:
    case Variable::previous_turn:
      return {both_travel, left_travel, right_travel, track, sideways_path, yaw_path};
    case Variable::previous_push:
      return {both_travel, left_travel, right_travel, track};
  }
  return {};
}

/// Sway of a mast: both directions alike, more than linear at most by a square.
BasisValues sway_functions(const Curve& curve, double z) {
  const double relative = std::clamp(z / std::max(std::abs(curve.low), std::abs(curve.high)), -1.0, 1.0);
  return {relative, relative * std::abs(relative)};
}

/// Of each function over the interval.
BasisValues growth(const Curve& curve, const StepContext& c) {
  BasisValues after = sway_functions(curve, c.turn_acceleration_after[curve.memory]);
  const BasisValues before = sway_functions(curve, c.turn_acceleration_before[curve.memory]);
  for (std::size_t k = 0; k < after.size(); ++k) after[k] -= before[k];
  return after;
}

class CurveEffect final : public StepEffect<CurveEffect> {
 public:
  explicit CurveEffect(const Curve& curve) : curve_(curve) {}
  [[nodiscard]] std::string name() const override {
    return "curve of " + to_string(curve_.law.variable) + " on " + to_string(curve_.law.carrier);
  }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    std::vector<EffectParameter> list;
    for (std::size_t k = 0; k < basis_size(curve_); ++k) {
      std::string name(1, 'c');
      list.push_back({name.append(std::to_string(k + 1)), "1", typical_size(), -largest_size(),
                      largest_size(), 0.0, prior(k)});
    }
    return list;
  }
  [[nodiscard]] Storage storage() const override {
    if (concerns_sensor(curve_)) return Storage::driver;
    return belongs_to_the_place(curve_.law.variable) ? Storage::nowhere : Storage::host;
  }

  template <typename T>
  void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) const {
    const BasisValues functions = functions_in(curve_, c);
    T f(0.0);
    for (std::size_t k = 0; k < functions.size(); ++k) f += p[k] * functions[k];
    carry(curve_.law.carrier, c, f, step);
  }

 private:
  /// Relative; rad per m; m per rad.
  [[nodiscard]] double typical_size() const {
    if (curve_.law.carrier == Carrier::yaw_path || concerns_sensor(curve_)) return 0.02;
    // What a scan matcher's own bias in one room amounts to is a part of this.
    if (curve_.law.variable == Variable::heading || curve_.law.variable == Variable::position) return 0.015;
    // An error of the encoder's angle shows in its rate, n times as large for the n-th harmonic.
    if (curve_.harmonic > 0) return 5e-3 * curve_.harmonic;
    const bool per_turn =
        curve_.law.carrier == Carrier::turn_path || curve_.law.carrier == Carrier::turn_side;
    return per_turn ? 1e-3 : 5e-3;
  }
  /// Just after a reversal or a stop a wheel may lose a good part of its travel; otherwise no robot is that
  /// bad.
  [[nodiscard]] double largest_size() const {
    return typical_size() * (is_distance_since(curve_.law.variable) ? 100.0 : 10.0 * strength());
  }
  [[nodiscard]] double strength() const { return curve_.strong ? 6.0 : 1.0; }
  /// Wide for any real defect, narrow enough that what this drive does not show is not made up: a curve must
  /// do no harm in other drives.
  [[nodiscard]] double prior(std::size_t function) const {
    // Where turns of one speed cannot tell which, each radian leaves the same way.
    const bool is_refinement = curve_.law.carrier == Carrier::turn_path && function > 0;
    const double usual = (is_refinement ? 1.0 : 4.0) * typical_size();
    if (!is_distance_since(curve_.law.variable)) return usual * strength();
    // What is lost between one knot and the next is as much everywhere, the way between them half as long.
    return std::min(std::ldexp(usual, kFadeKnots - 1 - static_cast<int>(function)), largest_size());
  }

  Curve curve_;
};

/// 0.5 and 99.5 % quantiles of the variable while the wheels turn; equal when it does not vary.
std::pair<double, double> range_of(Variable variable, std::span<const DriveModel* const> models,
                                   std::size_t memory = kUsualMemory) {
  std::vector<double> values;
  for (const DriveModel* model : models)
    for (const StepContext& c : model->context()) {
      if (std::abs(c.left_speed) <= kMoving && std::abs(c.right_speed) <= kMoving) continue;
      values.push_back(value_of(variable, c, memory));
      if (variable == Variable::position) values.push_back(c.y);
    }
  if (values.size() < 10) return {0.0, 0.0};
  const auto at = [&](double share) {
    const auto nth =
        values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  };
  const double low = at(0.005);
  return {low, at(0.995)};
}

double scaled(const Curve& curve, double z) {
  return std::clamp(2.0 * (z - curve.low) / (curve.high - curve.low) - 1.0, -1.0, 1.0);
}

/// Cosines and sines of multiples, by rotating on from one to the next.
BasisValues harmonics(double angle, int first, int last) {
  BasisValues functions;
  const std::complex<double> turn = std::polar(1.0, angle);
  std::complex<double> here = first == 1 ? turn : std::polar(1.0, first * angle);
  for (int k = first; k <= last; ++k, here *= turn) {
    functions.push_back(here.real());
    functions.push_back(here.imag());
  }
  return functions;
}

bool is_signed_speed(Variable variable) {
  return variable == Variable::left_speed || variable == Variable::right_speed ||
         variable == Variable::speed || variable == Variable::turn_rate;
}

/// Direction as a step, smooth over a few percent of the range so that noise about zero does not flip it.
double direction_of(double relative) { return std::tanh(relative / 0.03); }

/// Cubic B-spline with unit knots about zero (Schoenberg, Quart. Appl. Math. 4, 1946).
double cubic_bump(double x) {
  const double a = std::abs(x);
  if (a >= 2.0) return 0.0;
  const double tail = 2.0 - a, core = 1.0 - a;
  return (tail * tail * tail - (a < 1.0 ? 4.0 * core * core * core : 0.0)) / 6.0;
}

/// 1 at the knot, 0 from its neighbours on.
double hat(double steps) { return std::max(0.0, 1.0 - std::abs(steps)); }

/// Bilinear, one knot after another along x for each along y.
BasisValues patches(const Curve& curve, double x, double y) {
  const auto place = [&](double z) { return 0.5 * (scaled(curve, z) + 1.0) * (kPatches - 1); };
  const double along = place(x), across = place(y);
  BasisValues functions;
  for (int j = 0; j < kPatches; ++j)
    for (int i = 0; i < kPatches; ++i) functions.push_back(hat(along - i) * hat(across - j));
  return functions;
}

BasisValues hats(int knots, double place) {
  BasisValues functions;
  for (int k = 1; k <= knots; ++k) functions.push_back(hat(place - k));
  return functions;
}

/// Of the splines about knots 1 to one past the last, four differ from zero.
BasisValues cubic_splines(int knots, double place) {
  BasisValues functions(static_cast<std::size_t>(knots) + 1);
  const int before = static_cast<int>(place) - 1;
  for (int k = std::max(before, 1); k <= std::min(before + 3, knots + 1); ++k)
    functions[static_cast<std::size_t>(k) - 1] = cubic_bump(place - k);
  functions[0] -= cubic_bump(1.0);  // zero at rest
  return functions;
}

/// Those of the magnitude, the direction, and the direction times the magnitude.
BasisValues speed_functions(const Curve& curve, double z) {
  const double relative = std::clamp(z / std::max(std::abs(curve.low), std::abs(curve.high)), -1.0, 1.0);
  const double direction = direction_of(relative), magnitude = std::abs(relative);
  if (curve.law.carrier == Carrier::turn_path) return {1.0, magnitude, direction, relative};
  // A law is found by few straight pieces; one that bends is described by many splines.
  const double place = curve.knots * magnitude;
  BasisValues functions =
      curve.knots == kKnots.front() ? hats(curve.knots, place) : cubic_splines(curve.knots, place);
  functions.push_back(direction);
  functions.push_back(relative);
  return functions;
}

/// Hats over the logarithm of the distance, the first flat towards zero; nothing beyond the last knot's
/// double.
BasisValues fading(Variable variable, double distance) {
  const bool of_wheel =
      variable == Variable::left_since_reversal || variable == Variable::right_since_reversal;
  const double nearest = of_wheel ? kNearestAngle : kNearestLength;
  const double place = std::log2(std::max(distance, nearest) / nearest);
  BasisValues functions;
  for (int k = 0; k < kFadeKnots; ++k) functions.push_back(hat(place - k));
  return functions;
}

/// Legendre polynomials of degree 1 to kDegrees by Bonnet's recursion.
BasisValues legendre(double x) {
  BasisValues functions;
  double before = 1.0;
  double here = x;
  for (std::size_t n = 1; n <= kDegrees; ++n) {
    functions.push_back(here);
    const double order = static_cast<double>(n);
    const double next = ((2.0 * order + 1.0) * x * here - order * before) / (order + 1.0);
    before = here;
    here = next;
  }
  return functions;
}

/// Zero at rest, so that the base parameters keep their meaning of slow, steady motion.
BasisValues zero_at_rest(const Curve& curve, double z) {
  BasisValues functions = legendre(scaled(curve, z));
  const BasisValues at_rest = legendre(scaled(curve, 0.0));
  for (std::size_t k = 0; k < functions.size(); ++k) functions[k] -= at_rest[k];
  return functions;
}

/// What an unsigned way adds to a signed one, a drive that goes only one way cannot tell from the wheels.
bool goes_both_ways(std::span<const DriveModel* const> models) {
  constexpr double kLeast = 0.2;  // of the way
  double ahead = 0.0, back = 0.0;
  for (const DriveModel* model : models)
    for (const StepContext& c : model->context()) (c.speed > 0.0 ? ahead : back) += std::abs(c.speed) * c.dt;
  return std::min(ahead, back) > kLeast * (ahead + back);
}

bool is_unsigned(Carrier carrier) {
  return carrier == Carrier::both_path || carrier == Carrier::sideways_path || carrier == Carrier::yaw_path;
}

/// Of both wheels, as the day goes, or of one, as its brake or its motor does. Periods closer than kStep
/// cycles per recording look alike.
void add_periods(double duration, std::vector<Curve>& curves) {
  constexpr double kShortest = 8.0;  // s
  constexpr double kFewestCycles = 1.5;
  constexpr double kStep = 0.7;  // cycles
  for (double cycles = kFewestCycles; duration / cycles > kShortest; cycles += kStep)
    for (const auto carrier : {Carrier::both_travel, Carrier::left_travel, Carrier::right_travel})
      curves.push_back({{Variable::time, carrier}, 0.0, duration, duration / cycles, 0});
}

/// Of what lies on the floor; wheels sink in, both alike.
void add_patches(double low, double high, std::vector<Curve>& curves) {
  curves.push_back({{Variable::position, Carrier::both_travel}, low, high});
  curves.back().patches = true;
}

void add_harmonics(const Curve& curve, int first, int last, std::vector<Curve>& curves) {
  for (int harmonic = first; harmonic <= last; ++harmonic) {
    curves.push_back(curve);
    curves.back().harmonic = harmonic;
  }
}

BasisValues with_constant(const BasisValues& functions) {
  BasisValues all{1.0};
  for (const double f : functions) all.push_back(f);
  return all;
}

/// A level that comes and goes, and a slope that lengthens one way and shortens the other.
BasisValues wave_functions(const Curve& curve, const StepContext& c) {
  const auto [a, b] = curve.wave;
  const double waves = a * c.x + b * c.y;
  // More than a thousand waves are asked at every step; single precision of a turn is a ten millionth of one.
  const std::complex<float> here =
      std::polar(1.0F, static_cast<float>(2.0 * kPi * (waves - std::floor(waves))));
  const double across = (a * std::cos(c.heading) + b * std::sin(c.heading)) / std::sqrt(a * a + b * b);
  const double cosine = static_cast<double>(here.real()), sine = static_cast<double>(here.imag());
  return {cosine, sine, across * cosine, across * sine};
}

/// How much motion of the carrier an interval holds.
double amount(Carrier carrier, const StepContext& c) {
  switch (carrier) {
    case Carrier::left_travel:
    case Carrier::left_path:
      return std::abs(c.left_delta);
    case Carrier::right_travel:
    case Carrier::right_path:
      return std::abs(c.right_delta);
    case Carrier::track:
    case Carrier::turn_path:
    case Carrier::turn_side:
      return std::abs(c.turn_rate) * c.dt;
    default:
      return std::abs(c.speed) * c.dt;
  }
}

BasisValues raw_basis(const Curve& curve, const StepContext& c) {
  const Variable variable = curve.law.variable;
  const double z = value_of(variable, c, curve.memory);
  if (concerns_sensor(curve)) return sway_functions(curve, z);
  if (curve.constant) return with_constant(harmonics(z, 1, kHarmonics));
  if (is_angle(variable))
    return curve.harmonic > 0 ? harmonics(z, curve.harmonic, curve.harmonic) : harmonics(z, 1, kHarmonics);
  if (is_distance_since(variable)) return fading(variable, z);
  if (is_relay(variable, curve.memory)) return {z};
  if (curve.period > 0.0) return harmonics(2.0 * kPi * z / curve.period, 1, 1);
  if (variable == Variable::time) return legendre(scaled(curve, z));
  if (curve.is_wave()) return wave_functions(curve, c);
  if (curve.patches) return patches(curve, c.x, c.y);
  if (variable == Variable::position) {
    const double x = scaled(curve, c.x), y = scaled(curve, c.y);
    return {x, y, x * x, x * y, y * y};
  }
  return is_signed_speed(variable) ? speed_functions(curve, z) : zero_at_rest(curve, z);
}

}  // namespace

BasisValues basis(const Curve& curve, const StepContext& c) {
  BasisValues functions = raw_basis(curve, c);
  for (std::size_t k = 0; k < curve.mean.size(); ++k) functions[k] -= curve.mean[k];
  return functions;
}

BasisValues functions_in(const Curve& curve, const StepContext& c) {
  return concerns_sensor(curve) ? growth(curve, c) : basis(curve, c);
}

bool concerns_sensor(const Curve& curve) { return curve.law.carrier == Carrier::sensor_yaw; }

std::vector<Curve> other_shapes(const Curve& curve, std::span<const DriveModel* const> models) {
  std::vector<Curve> shapes;
  const bool has_knots = is_signed_speed(curve.law.variable) && curve.law.carrier != Carrier::turn_path;
  for (const int knots : kKnots) {
    if (!has_knots || knots <= curve.knots) continue;
    shapes.push_back(curve);
    shapes.back().knots = knots;
  }
  if (curve.law.variable == Variable::position && !curve.is_wave() && !curve.patches) {
    shapes.push_back(curve);
    shapes.back().patches = true;
  }
  const std::size_t memories = memories_of(curve.law.variable);
  for (std::size_t memory = 0; memories > kUsualMemory + 1 && memory < memories; ++memory) {
    if (memory == curve.memory) continue;
    shapes.push_back(curve);
    shapes.back().memory = memory;
    std::tie(shapes.back().low, shapes.back().high) = range_of(curve.law.variable, models, memory);
  }
  for (Curve& shape : shapes)
    if (!shape.mean.empty()) shape = centred(std::move(shape), models);
  return shapes;
}

std::size_t basis_size(const Curve& curve) { return basis(curve, StepContext{}).size(); }

std::shared_ptr<const Effect> make_curve_effect(const Curve& curve) {
  return std::make_shared<CurveEffect>(curve);
}

Curve strong(Curve curve) {
  curve.strong = true;
  return curve;
}

Curve centred(Curve curve, std::span<const DriveModel* const> models) {
  std::vector<double> sum(basis_size(curve), 0.0);
  curve.mean.clear();
  double total = 0.0;
  for (const DriveModel* model : models)
    for (const StepContext& c : model->context()) {
      const double weight = amount(curve.law.carrier, c);
      const BasisValues functions = basis(curve, c);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * functions[k];
      total += weight;
    }
  for (double& value : sum) value /= std::max(total, 1e-12);
  curve.mean = std::move(sum);
  return curve;
}

double spread_of(const Curve& curve, std::span<const double> coefficients,
                 std::span<const DriveModel* const> models) {
  double sum = 0.0, total = 0.0;
  for (const DriveModel* model : models)
    for (const StepContext& c : model->context()) {
      const BasisValues functions = basis(curve, c);
      const double f = std::inner_product(functions.begin(), functions.end(), coefficients.begin(), 0.0);
      const double weight = amount(curve.law.carrier, c);
      sum += weight * f * f;
      total += weight;
    }
  return std::sqrt(sum / std::max(total, 1e-12));
}

bool leaves_mean_to_wheels(const Curve& curve, std::span<const DriveModel* const> models) {
  return curve.law == Law{Variable::heading, Carrier::yaw_path} && !goes_both_ways(models);
}

std::vector<Curve> candidate_curves(std::span<const DriveModel* const> models) {
  std::vector<Curve> curves;
  const bool both_ways = goes_both_ways(models);
  for (int v = 0; v <= static_cast<int>(kLastVariable); ++v) {
    const auto variable = static_cast<Variable>(v);
    if (models.size() > 1 && begins_with_the_recording(variable)) continue;
    const auto [low, high] = range_of(variable, models);
    if (!(high - low > 1e-6)) continue;
    for (const Carrier carrier : carriers_of(variable)) {
      Curve curve{{variable, carrier}, low, high, 0.0, 0};
      curve.constant = variable == Variable::heading && is_unsigned(carrier) && both_ways;
      curves.push_back(curve);
      curve.constant = false;
      if (variable == Variable::left_phase || variable == Variable::right_phase)
        add_harmonics(curve, kHarmonics + 1, kHighestHarmonic, curves);
      if (variable == Variable::turn_acceleration) {  // what comes late may look like what went before
        curves.push_back(curve);
        curves.back().memory = kSwayLags.size() - 1;
      }
      // What stays until the opposite push hardly resembles what fades.
      for (std::size_t memory = 0; memory < memories_of(variable); ++memory)
        if (is_relay(variable, memory)) {
          curves.push_back(curve);
          curves.back().memory = memory;
        }
      // A drive seldom shows all headings; one wave round the circle is what few of them can tell.
      if (variable == Variable::heading) add_harmonics(curve, 1, 1, curves);
    }
    if (variable == Variable::time) add_periods(high - low, curves);
    if (variable == Variable::position) add_patches(low, high, curves);
  }
  return curves;
}

}  // namespace odomcalib::calib
