#include "calib/terms/basis.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::terms {
namespace {

constexpr double kNearestLength = 0.03;  ///< m of the base
constexpr double kNearestAngle = 0.2;    ///< rad of a wheel

/// Sway of a mast: both directions alike, more than linear at most by a square.
BasisValues sway_functions(const Curve& curve, double z) {
  const double relative = std::clamp(z / std::max(std::abs(curve.low), std::abs(curve.high)), -1.0, 1.0);
  return {relative, relative * std::abs(relative)};
}

/// Of each function over the interval.
BasisValues growth(const Curve& curve, const vehicle::StepContext& c) {
  BasisValues after = sway_functions(curve, c.turn_acceleration_after[curve.memory]);
  const BasisValues before = sway_functions(curve, c.turn_acceleration_before[curve.memory]);
  for (std::size_t k = 0; k < after.size(); ++k) after[k] -= before[k];
  return after;
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

/// Whether direction times the carrier's unsigned way is the signed one, which the base parameters scale.
bool goes_the_way_of(vehicle::Variable variable, vehicle::Carrier carrier) {
  switch (carrier) {
    case vehicle::Carrier::left_path:
      return variable == vehicle::Variable::left_speed;
    case vehicle::Carrier::right_path:
      return variable == vehicle::Variable::right_speed;
    case vehicle::Carrier::both_path:
    case vehicle::Carrier::sideways_path:
    case vehicle::Carrier::yaw_path:
      return variable == vehicle::Variable::speed;
    default:
      return false;
  }
}

/// Those of the magnitude, the direction, and the direction times the magnitude.
BasisValues speed_functions(const Curve& curve, double z) {
  const double relative = std::clamp(z / std::max(std::abs(curve.low), std::abs(curve.high)), -1.0, 1.0);
  const double direction = direction_of(relative), magnitude = std::abs(relative);
  if (curve.law.carrier == vehicle::Carrier::turn_path) return {1.0, magnitude, direction, relative};
  // A law is found by few straight pieces; one that bends is described by many splines.
  const double place = curve.knots * magnitude;
  BasisValues functions = has_splines(curve) ? cubic_splines(curve.knots, place) : hats(curve.knots, place);
  functions.push_back(goes_the_way_of(curve.law.variable, curve.law.carrier) ? 1.0 : direction);
  functions.push_back(relative);
  return functions;
}

/// Hats over the logarithm of the distance, the first flat towards zero; nothing beyond the last knot's
/// double.
BasisValues fading(vehicle::Variable variable, double distance) {
  const bool of_wheel = variable == vehicle::Variable::left_since_reversal ||
                        variable == vehicle::Variable::right_since_reversal;
  const double nearest = of_wheel ? kNearestAngle : kNearestLength;
  const double place = std::log2(std::max(distance, nearest) / nearest);
  BasisValues functions;
  for (int k = 0; k < kFadeKnots; ++k) functions.push_back(hat(place - k));
  return functions;
}

/// Legendre polynomials of degree 1 to the highest by Bonnet's recursion.
BasisValues legendre(double x, int highest) {
  BasisValues functions;
  double before = 1.0;
  double here = x;
  for (int n = 1; n <= highest; ++n) {
    functions.push_back(here);
    const double order = n;
    const double next = ((2.0 * order + 1.0) * x * here - order * before) / (order + 1.0);
    before = here;
    here = next;
  }
  return functions;
}

/// Zero at rest, so that the base parameters keep their meaning of slow, steady motion.
BasisValues zero_at_rest(const Curve& curve, double z) {
  BasisValues functions = legendre(scaled(curve, z), curve.degree);
  const BasisValues at_rest = legendre(scaled(curve, 0.0), curve.degree);
  for (std::size_t k = 0; k < functions.size(); ++k) functions[k] -= at_rest[k];
  return functions;
}

BasisValues with_constant(const BasisValues& functions) {
  BasisValues all{1.0};
  for (const double f : functions) all.push_back(f);
  return all;
}

/// A level that comes and goes, and a slope that lengthens one way and shortens the other.
BasisValues wave_functions(const Curve& curve, const vehicle::StepContext& c) {
  const auto [a, b] = curve.wave;
  const double waves = a * c.x + b * c.y;
  // More than a thousand waves are asked at every step; single precision of a turn is a ten millionth of one.
  const std::complex<float> here =
      std::polar(1.0F, static_cast<float>(2.0 * math::kPi * (waves - std::floor(waves))));
  const double across = (a * c.heading_cosine + b * c.heading_sine) / std::sqrt(a * a + b * b);
  const double cosine = static_cast<double>(here.real()), sine = static_cast<double>(here.imag());
  return {cosine, sine, across * cosine, across * sine};
}

/// Speed or turn rate of what an acceleration is one of.
double motion_of(vehicle::Variable variable, const vehicle::StepContext& c) {
  switch (variable) {
    case vehicle::Variable::left_acceleration:
      return c.left_speed;
    case vehicle::Variable::right_acceleration:
      return c.right_speed;
    case vehicle::Variable::turn_acceleration:
      return c.turn_rate;
    default:
      return c.speed;
  }
}

/// Of the curve's variable, as the curve understands it.
double argument_of(const Curve& curve, const vehicle::StepContext& c) {
  const double z = value_of(curve.law.variable, c, curve.memory);
  return curve.with_motion ? vehicle::growth_of_pace(z, motion_of(curve.law.variable, c)) : z;
}

/// One function of each carrier. What is stated of a sensor's place is where it is now.
BasisValues event(const Curve& curve, double t) {
  const bool is_now = t >= curve.moment;
  BasisValues functions;
  for (std::size_t part = 0; part < acts_on(curve).size(); ++part)
    functions.push_back(is_now == is_bump(curve) ? 0.0 : 1.0);
  return functions;
}

BasisValues raw_basis(const Curve& curve, const vehicle::StepContext& c) {
  const vehicle::Variable variable = curve.law.variable;
  const double z = argument_of(curve, c);
  if (is_sway(curve)) return sway_functions(curve, z);
  if (curve.constant) return with_constant(harmonics(z, 1, kHarmonics));
  if (curve.period > 0.0) return harmonics(2.0 * math::kPi * z / curve.period, 1, 1);
  if (is_angle(variable))
    return curve.harmonic > 0 ? harmonics(z, curve.harmonic, curve.harmonic) : harmonics(z, 1, kHarmonics);
  if (is_distance_since(variable)) return fading(variable, z);
  if (is_relay(variable, curve.memory)) return {z};
  if (happens_at_once(curve)) return event(curve, z);
  if (curve.fading > 0.0) return {std::exp(-z / curve.fading)};
  if (variable == vehicle::Variable::time) return legendre(scaled(curve, z), curve.degree);
  if (curve.is_wave()) return wave_functions(curve, c);
  if (curve.patches) return patches(curve, c.x, c.y);
  if (variable == vehicle::Variable::position) {
    const double x = scaled(curve, c.x), y = scaled(curve, c.y);
    return {x, y, x * x, x * y, y * y};
  }
  const bool has_knots = is_signed_speed(variable) || has_splines(curve);
  return has_knots ? speed_functions(curve, z) : zero_at_rest(curve, z);
}

}  // namespace

std::span<const vehicle::Carrier> acts_on(const Curve& curve) {
  static constexpr std::array kEachWheel = {vehicle::Carrier::left_travel, vehicle::Carrier::right_travel};
  // Levers first: the sensor's way is that of its place, seen by axes that were turned.
  static constexpr std::array kPlace = {vehicle::Carrier::turn_side, vehicle::Carrier::turn_ahead,
                                        vehicle::Carrier::way_turned};
  if (is_bump(curve)) return kPlace;
  const bool is_of_both_wheels = happens_at_once(curve) && curve.law.carrier == vehicle::Carrier::both_travel;
  if (curve.law == vehicle::kOfEachWheel || is_of_both_wheels) return kEachWheel;
  return {&curve.law.carrier, 1};
}

bool belongs_to(const Curve& curve, std::size_t function, std::size_t part) {
  return !happens_at_once(curve) || function == part;
}

BasisValues basis(const Curve& curve, const vehicle::StepContext& c, std::size_t part) {
  const bool of_right_speed = part > 0 && curve.law == vehicle::kOfEachWheel;
  BasisValues functions = of_right_speed ? speed_functions(curve, c.right_speed) : raw_basis(curve, c);
  for (std::size_t k = 0; k < curve.mean.size(); ++k) functions[k] -= curve.mean[k];
  if (happens_at_once(curve))
    for (std::size_t k = 0; k < functions.size(); ++k)
      if (!belongs_to(curve, k, part)) functions[k] = 0.0;
  return functions;
}

BasisValues functions_in(const Curve& curve, const vehicle::StepContext& c, std::size_t part) {
  return is_sway(curve) ? growth(curve, c) : basis(curve, c, part);
}

std::size_t basis_size(const Curve& curve) { return basis(curve, vehicle::StepContext{}).size(); }

}  // namespace odomcalib::calib::terms
