#include "calib/tracing/curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

constexpr std::size_t kDegrees = 4;
constexpr std::size_t kHarmonics = 3;
constexpr double kMoving = 0.01;                        ///< m/s of either wheel; standing still shows nothing
constexpr std::array kFadeLengths = {0.02, 0.07, 0.2};  ///< m of the base
constexpr std::array kFadeAngles = {0.1, 0.5, 2.0};     ///< rad of a wheel

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
    case Variable::speed:
      return {both_travel, track, sideways};
    case Variable::turn_rate:
      return {both_travel, left_travel, right_travel, track, sideways, turn_path};
    case Variable::lateral_acceleration:
      return {sideways, sideways_path, track};
    case Variable::time:
      return {both_travel, left_travel, right_travel, track, sideways};
    case Variable::heading:
    case Variable::position:
      return {both_travel, left_travel, right_travel, both_path, sideways_path, yaw_path};
    case Variable::since_reversal:
    case Variable::since_stop:
    case Variable::previous_turn:
      return {both_travel, left_travel, right_travel, track, sideways_path, yaw_path};
  }
  return {};
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
      list.push_back({name.append(std::to_string(k + 1)), "1", typical_size(), -0.5, 0.5, 0.0, prior()});
    }
    return list;
  }
  [[nodiscard]] Storage storage() const override {
    return belongs_to_the_place(curve_.law.variable) ? Storage::nowhere : Storage::host;
  }

  template <typename T>
  void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) const {
    const std::vector<double> functions = basis(curve_, c);
    T f(0.0);
    for (std::size_t k = 0; k < functions.size(); ++k) f += p[k] * functions[k];
    carry(curve_.law.carrier, c, f, step);
  }

 private:
  /// Relative; rad per m; m per rad.
  [[nodiscard]] double typical_size() const {
    if (curve_.law.carrier == Carrier::yaw_path) return 0.02;
    return curve_.law.carrier == Carrier::turn_path ? 1e-3 : 5e-3;
  }
  /// Wide for any real defect, narrow enough that what this drive does not show is not made up: a curve must
  /// do no harm in other drives.
  [[nodiscard]] double prior() const { return 4.0 * typical_size(); }

  Curve curve_;
};

/// 0.5 and 99.5 % quantiles of the variable while the wheels turn; equal when it does not vary.
std::pair<double, double> range_of(Variable variable, std::span<const DriveModel* const> models) {
  std::vector<double> values;
  for (const DriveModel* model : models)
    for (const StepContext& c : model->context()) {
      if (std::abs(c.left_speed) <= kMoving && std::abs(c.right_speed) <= kMoving) continue;
      values.push_back(value_of(variable, c));
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

std::vector<double> harmonics(double angle, std::size_t count) {
  std::vector<double> functions;
  for (std::size_t k = 1; k <= count; ++k) {
    functions.push_back(std::cos(static_cast<double>(k) * angle));
    functions.push_back(std::sin(static_cast<double>(k) * angle));
  }
  return functions;
}

std::vector<double> fading(Variable variable, double distance) {
  const bool of_wheel = variable != Variable::since_reversal && variable != Variable::since_stop;
  std::vector<double> functions;
  for (const double length : of_wheel ? kFadeAngles : kFadeLengths)
    functions.push_back(std::exp(-distance / length));
  return functions;
}

/// Legendre polynomials of degree 1 to kDegrees by Bonnet's recursion.
std::vector<double> legendre(double x) {
  std::vector<double> functions;
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
std::vector<double> zero_at_rest(const Curve& curve, double z) {
  std::vector<double> functions = legendre(scaled(curve, z));
  const std::vector<double> at_rest = legendre(scaled(curve, 0.0));
  for (std::size_t k = 0; k < functions.size(); ++k) functions[k] -= at_rest[k];
  return functions;
}

void add_periods(Carrier carrier, double duration, std::vector<Curve>& curves) {
  constexpr double kShortest = 8.0;  // s
  constexpr double kRatio = 1.4;
  for (double period = kShortest; period < duration / 2.0; period *= kRatio)
    curves.push_back({{Variable::time, carrier}, 0.0, duration, period});
}

}  // namespace

std::vector<double> basis(const Curve& curve, const StepContext& c) {
  const Variable variable = curve.law.variable;
  const double z = value_of(variable, c);
  if (is_angle(variable)) return harmonics(z, kHarmonics);
  if (is_distance_since(variable)) return fading(variable, z);
  if (curve.period > 0.0) return harmonics(2.0 * kPi * z / curve.period, 1);
  if (variable == Variable::time) return legendre(scaled(curve, z));
  if (variable == Variable::position) {
    const double x = scaled(curve, c.x), y = scaled(curve, c.y);
    return {x, y, x * x, x * y, y * y};
  }
  if (curve.law.carrier != Carrier::turn_path) return zero_at_rest(curve, z);
  std::vector<double> functions = legendre(scaled(curve, z));
  functions.insert(functions.begin(), 1.0);
  functions.pop_back();
  return functions;
}

std::size_t basis_size(const Curve& curve) { return basis(curve, StepContext{}).size(); }

std::shared_ptr<const Effect> make_curve_effect(const Curve& curve) {
  return std::make_shared<CurveEffect>(curve);
}

std::vector<Curve> candidate_curves(std::span<const DriveModel* const> models) {
  std::vector<Curve> curves;
  for (int v = 0; v <= static_cast<int>(kLastVariable); ++v) {
    const auto variable = static_cast<Variable>(v);
    const auto [low, high] = range_of(variable, models);
    if (!(high - low > 1e-6)) continue;
    for (const Carrier carrier : carriers_of(variable)) {
      curves.push_back({{variable, carrier}, low, high, 0.0});
      // Recordings of one robot share no phase of a swing.
      if (variable == Variable::time && models.size() == 1) add_periods(carrier, high - low, curves);
    }
  }
  return curves;
}

}  // namespace odomcalib::calib
