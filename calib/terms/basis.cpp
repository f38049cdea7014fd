#include "calib/terms/basis.hpp"

#include <complex>

#include "calib/math/se2.hpp"
#include "calib/terms/settings.hpp"

namespace odomcalib::calib::terms {
namespace {

static_assert(kMostKnots + 3 == kMostFunctions);

/// Hat functions about knots: 1 at the knot, 0 from its neighbours on.
double hat(double steps) { return std::max(0.0, 1.0 - (steps < 0.0 ? -steps : steps)); }

/// Degree 1 to the highest by Bonnet's recursion.
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

/// Whether direction times the channel's unsigned way is the signed one, which the base parameters scale.
bool goes_the_way_of(const vehicle::Dependence& dependence) {
  switch (dependence.channel) {
    case vehicle::Channel::left_path:
      return dependence.covariate == vehicle::Covariate::left_speed;
    case vehicle::Channel::right_path:
      return dependence.covariate == vehicle::Covariate::right_speed;
    case vehicle::Channel::both_path:
    case vehicle::Channel::sideways_path:
    case vehicle::Channel::yaw_path:
      return dependence.covariate == vehicle::Covariate::speed;
    default:
      return false;
  }
}

/// Direction as a step, smooth over a few percent of the range so that noise about zero does not flip it.
/// @param relative share of the largest speed, -1 to 1
double direction_of(double relative) { return std::tanh(relative / 0.03); }

/// The part that each direction adds to functions of the magnitude: a step with the direction, which on the
/// unsigned way that has this direction is a constant, and the magnitude times the direction.
void add_direction(const Argument& at, BasisValues& functions) {
  const double relative = at.relative();
  functions.push_back(goes_the_way_of(at.dependence) ? 1.0 : direction_of(relative));
  functions.push_back(relative);
}

/// Cubic B-spline with unit knots about zero (Schoenberg, Quart. Appl. Math. 4, 1946).
double cubic_bump(double x) {
  const double a = std::abs(x);
  if (a >= 2.0) return 0.0;
  const double tail = 2.0 - a, core = 1.0 - a;
  return (tail * tail * tail - (a < 1.0 ? 4.0 * core * core * core : 0.0)) / 6.0;
}

/// Four of the splines about knots 1 to one past the last differ from zero.
BasisValues cubic_splines(int knots, double place) {
  BasisValues functions(static_cast<std::size_t>(knots) + 1);
  const int before = static_cast<int>(place) - 1;
  for (int k = std::max(before, 1); k <= std::min(before + 3, knots + 1); ++k)
    functions[static_cast<std::size_t>(k) - 1] = cubic_bump(place - k);
  functions[0] -= cubic_bump(1.0);  // zero at rest
  return functions;
}

/// Cosines and sines of the first to the last multiple of an angle, by rotating on from one to the next.
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

}  // namespace

BasisValues Polynomials::values(const Argument& at) const {
  BasisValues functions = legendre(at.scaled(at.z), degree);
  if (at.dependence.covariate == vehicle::Covariate::time) return functions;
  const BasisValues at_rest = legendre(at.scaled(0.0), degree);
  for (std::size_t k = 0; k < functions.size(); ++k) functions[k] -= at_rest[k];
  return functions;
}

BasisValues SpeedHats::values(const Argument& at) const {
  const double place = kKnots * std::abs(at.relative());
  BasisValues functions;
  for (int k = 1; k <= kKnots; ++k) functions.push_back(hat(place - k));
  add_direction(at, functions);
  return functions;
}

BasisValues Splines::values(const Argument& at) const {
  BasisValues functions = cubic_splines(knots, knots * std::abs(at.relative()));
  add_direction(at, functions);
  return functions;
}

std::vector<std::vector<double>> Splines::penalty(double strength, double typical_size,
                                                  std::size_t count) const {
  std::vector<std::vector<double>> differences;
  for (std::size_t k = 0; k < roughness.size(); ++k) {
    const double weight = 1.0 / (roughness[k] * strength * typical_size);
    differences.emplace_back(count, 0.0);
    differences.back()[k] = differences.back()[k + 2] = weight;
    differences.back()[k + 1] = -2.0 * weight;
  }
  return differences;
}

BasisValues TurnPath::values(const Argument& at) const {
  const double relative = at.relative();
  return {1.0, std::abs(relative), direction_of(relative), relative};
}

BasisValues Harmonics::values(const Argument& at) const {
  if (only > 0) return harmonics(at.z, only, only);
  const BasisValues waves = harmonics(at.z, 1, kHarmonics);
  if (!constant) return waves;
  BasisValues all{1.0};
  for (const double f : waves) all.push_back(f);
  return all;
}

BasisValues Cycle::values(const Argument& at) const {
  return harmonics(2.0 * math::kPi * at.z / period, 1, 1);
}

BasisValues FadingSince::values(const Argument& at) const {
  const double nearest =
      is_angle_of_a_wheel(at.dependence.covariate) ? settings::kNearestKnot_rad : settings::kNearestKnot_m;
  const double place = std::log2(std::max(at.z, nearest) / nearest);
  BasisValues functions;
  for (int k = 0; k < kFadeKnots; ++k) functions.push_back(hat(place - k));
  return functions;
}

double FadingSince::prior(std::size_t function, double usual) {
  return std::ldexp(usual, kFadeKnots - 1 - static_cast<int>(function));
}

std::size_t ChangePoint::parts(vehicle::Channel channel) {
  if (channel == vehicle::Channel::way_turned) return 3;
  return channel == vehicle::Channel::both_travel ? 2 : 1;
}

BasisValues ChangePoint::values(const Argument& at) const {
  const bool is_now = at.z >= moment, of_sensor = at.dependence.channel == vehicle::Channel::way_turned;
  BasisValues functions;
  for (std::size_t part = 0; part < parts(at.dependence.channel); ++part)
    functions.push_back(is_now == of_sensor ? 0.0 : 1.0);
  return functions;
}

BasisValues Sway::values(const Argument& at) const {
  const double relative = at.relative();
  return {relative, relative * std::abs(relative)};
}

BasisValues Patches::values(const Argument& at) const {
  const auto place = [&](double value) { return 0.5 * (at.scaled(value) + 1.0) * (kPatches - 1); };
  const double along = place(at.interval.x), across = place(at.interval.y);
  BasisValues functions;
  for (int j = 0; j < kPatches; ++j)
    for (int i = 0; i < kPatches; ++i) functions.push_back(hat(along - i) * hat(across - j));
  return functions;
}

BasisValues Wave::values(const Argument& at) const {
  const vehicle::StepContext& c = at.interval;
  const double waves = along_x * c.x + along_y * c.y;
  // More than a thousand waves are tried at every step; single precision of a turn is a ten millionth of one.
  const std::complex<float> here =
      std::polar(1.0F, static_cast<float>(2.0 * math::kPi * (waves - std::floor(waves))));
  const double across = (along_x * c.heading_cosine + along_y * c.heading_sine) /
                        std::sqrt(along_x * along_x + along_y * along_y);
  const double cosine = static_cast<double>(here.real()), sine = static_cast<double>(here.imag());
  return {cosine, sine, across * cosine, across * sine};
}

Basis usual_basis(const vehicle::Dependence& dependence, std::size_t memory) {
  if (dependence.channel == vehicle::Channel::sensor_yaw) return Sway{};
  if (is_angle(dependence.covariate)) return Harmonics{};
  if (is_distance_since(dependence.covariate)) return FadingSince{};
  if (is_relay(dependence.covariate, memory)) return Relay{};
  if (dependence.covariate == vehicle::Covariate::position) return Surface{};
  if (!is_signed_speed(dependence.covariate)) return Polynomials{};
  return dependence.channel == vehicle::Channel::turn_path ? Basis(TurnPath{}) : Basis(SpeedHats{});
}

}  // namespace odomcalib::calib::terms
