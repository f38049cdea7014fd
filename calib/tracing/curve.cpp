#include "calib/tracing/curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace odomcalib::calib {
namespace {

constexpr std::size_t kDegrees = 4;
constexpr std::size_t kHarmonics = 3;
constexpr double kMoving = 0.01;  ///< m/s of either wheel; standing still shows nothing

constexpr std::array kVariables = {Variable::left_speed,
                                   Variable::right_speed,
                                   Variable::speed,
                                   Variable::turn_rate,
                                   Variable::lateral_acceleration,
                                   Variable::left_acceleration,
                                   Variable::right_acceleration,
                                   Variable::left_phase,
                                   Variable::right_phase,
                                   Variable::time,
                                   Variable::heading,
                                   Variable::since_reversal};
constexpr std::array kCarriers = {Carrier::left_travel, Carrier::right_travel, Carrier::both_travel,
                                  Carrier::track, Carrier::sideways};

/// A wheel's own variables act on that wheel; a pair that no mechanism links only adds false alarms.
bool sensible(Variable variable, Carrier carrier) {
  switch (variable) {
    case Variable::left_speed:
    case Variable::left_acceleration:
    case Variable::left_phase:
      return carrier == Carrier::left_travel;
    case Variable::right_speed:
    case Variable::right_acceleration:
    case Variable::right_phase:
      return carrier == Carrier::right_travel;
    case Variable::lateral_acceleration:
      return carrier == Carrier::sideways || carrier == Carrier::track;
    default:
      return true;
  }
}

class CurveEffect final : public Effect {
 public:
  explicit CurveEffect(const Curve& curve) : curve_(curve) {}
  [[nodiscard]] std::string name() const override {
    return "curve of " + to_string(curve_.variable) + " on " + to_string(curve_.carrier);
  }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    std::vector<EffectParameter> list;
    for (std::size_t k = 0; k < basis(curve_, curve_.low).size(); ++k) {
      std::string name(1, 'c');
      list.push_back({name.append(std::to_string(k + 1)), "1", 5e-3, -0.5, 0.5});
    }
    return list;
  }
  void apply(const StepContext& c, std::span<const double> p, WheelStep<double>& step) const override {
    act(c, p, step);
  }
  void apply(const StepContext& c, std::span<const Jet> p, WheelStep<Jet>& step) const override {
    act(c, p, step);
  }

 private:
  template <typename T>
  void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) const {
    const std::vector<double> functions = basis(curve_, value_of(curve_.variable, c));
    T f(0.0);
    for (std::size_t k = 0; k < functions.size(); ++k) f += p[k] * functions[k];
    switch (curve_.carrier) {
      case Carrier::left_travel:
        step.left *= 1.0 + f;
        break;
      case Carrier::right_travel:
        step.right *= 1.0 + f;
        break;
      case Carrier::both_travel:
        step.left *= 1.0 + f;
        step.right *= 1.0 + f;
        break;
      case Carrier::track:
        step.track *= 1.0 + f;
        break;
      case Carrier::sideways:
        step.side += f * (c.speed * c.dt);
        break;
    }
  }
  Curve curve_;
};

/// 0.5 and 99.5 % quantiles of the variable while the wheels turn; equal when it does not vary.
std::pair<double, double> range_of(Variable variable, std::span<const DriveModel* const> models) {
  std::vector<double> values;
  for (const DriveModel* model : models)
    for (const StepContext& c : model->context())
      if (std::max(std::abs(c.left_speed), std::abs(c.right_speed)) > kMoving)
        values.push_back(value_of(variable, c));
  if (values.size() < 200) return {0.0, 0.0};
  const auto at = [&](double share) {
    const auto nth =
        values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  };
  const double low = at(0.005);
  return {low, at(0.995)};
}

std::vector<double> raw_basis(const Curve& curve, double z) {
  std::vector<double> functions;
  if (is_angle(curve.variable)) {
    for (std::size_t k = 1; k <= kHarmonics; ++k) {
      functions.push_back(std::cos(static_cast<double>(k) * z));
      functions.push_back(std::sin(static_cast<double>(k) * z));
    }
    return functions;
  }
  const double x = std::clamp(2.0 * (z - curve.low) / (curve.high - curve.low) - 1.0, -1.0, 1.0);
  double before = 1.0;
  double here = x;
  for (std::size_t n = 1; n <= kDegrees; ++n) {
    functions.push_back(here);
    const double order = static_cast<double>(n);
    const double next =
        ((2.0 * order + 1.0) * x * here - order * before) / (order + 1.0);  // Bonnet's recursion
    before = here;
    here = next;
  }
  return functions;
}

}  // namespace

std::string to_string(Variable variable) {
  static constexpr const char* kNames[] = {
      "left_speed",        "right_speed",        "speed",      "turn_rate",   "lateral_acceleration",
      "left_acceleration", "right_acceleration", "left_phase", "right_phase", "time",
      "heading",           "since_reversal"};
  return kNames[static_cast<std::size_t>(variable)];
}

std::string to_string(Carrier carrier) {
  static constexpr const char* kNames[] = {"left_travel", "right_travel", "both_travel", "track", "sideways"};
  return kNames[static_cast<std::size_t>(carrier)];
}

bool belongs_to_the_place(Variable variable) {
  return variable == Variable::time || variable == Variable::heading;
}

bool is_angle(Variable variable) {
  return variable == Variable::left_phase || variable == Variable::right_phase ||
         variable == Variable::heading;
}

double value_of(Variable variable, const StepContext& c) {
  switch (variable) {
    case Variable::left_speed:
      return c.left_speed;
    case Variable::right_speed:
      return c.right_speed;
    case Variable::speed:
      return c.speed;
    case Variable::turn_rate:
      return c.turn_rate;
    case Variable::lateral_acceleration:
      return c.speed * c.turn_rate;
    case Variable::left_acceleration:
      return c.left_acceleration;
    case Variable::right_acceleration:
      return c.right_acceleration;
    case Variable::left_phase:
      return c.left_angle;
    case Variable::right_phase:
      return c.right_angle;
    case Variable::time:
      return c.t;
    case Variable::heading:
      return c.heading;
    case Variable::since_reversal:
      return std::min(c.since_reversal, 0.5);
  }
  return 0.0;
}

std::vector<double> basis(const Curve& curve, double z) {
  std::vector<double> functions = raw_basis(curve, z);
  if (is_angle(curve.variable) || curve.variable == Variable::time) return functions;
  // Zero at rest: the base parameters keep their meaning of slow, steady motion.
  const std::vector<double> at_rest = raw_basis(curve, 0.0);
  for (std::size_t k = 0; k < functions.size(); ++k) functions[k] -= at_rest[k];
  return functions;
}

std::shared_ptr<const Effect> make_curve_effect(const Curve& curve) {
  return std::make_shared<CurveEffect>(curve);
}

std::vector<Curve> candidate_curves(std::span<const DriveModel* const> models) {
  std::vector<Curve> curves;
  for (const Variable variable : kVariables) {
    const auto [low, high] = range_of(variable, models);
    if (!(high - low > 1e-6)) continue;
    for (const Carrier carrier : kCarriers)
      if (sensible(variable, carrier)) curves.push_back({variable, carrier, low, high});
  }
  return curves;
}

}  // namespace odomcalib::calib
