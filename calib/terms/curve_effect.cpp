#include "calib/terms/curve_effect.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/terms/curve.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

/// Relative; rad per m; m per rad.
double typical_size_of(const Curve& curve) {
  if (curve.law.carrier == vehicle::Carrier::yaw_path || concerns_sensor(curve)) return 0.02;
  // What a scan matcher's own bias in one room amounts to is a part of this.
  if (curve.law.variable == vehicle::Variable::heading || curve.law.variable == vehicle::Variable::position)
    return 0.015;
  // An error of the encoder's angle shows in its rate, n times as large for the n-th harmonic.
  if (const auto* wave = basis_as<Harmonics>(curve); wave && wave->only > 0) return 5e-3 * wave->only;
  const bool per_turn =
      curve.law.carrier == vehicle::Carrier::turn_path || curve.law.carrier == vehicle::Carrier::turn_side;
  return per_turn ? 1e-3 : 5e-3;
}

double strength_of(const Curve& curve) { return curve.strong ? 6.0 : 1.0; }

class CurveEffect final : public StepEffect<CurveEffect> {
 public:
  explicit CurveEffect(const Curve& curve) : curve_(curve) {}
  [[nodiscard]] std::string name() const override {
    return "curve of " + to_string(curve_.law.variable) + " on " + to_string(curve_.law.carrier);
  }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    std::vector<vehicle::EffectParameter> list;
    for (std::size_t k = 0; k < function_count(curve_); ++k) {
      std::string name(1, 'c');
      list.push_back({name.append(std::to_string(k + 1)), "1", typical_size(), -largest_size(),
                      largest_size(), 0.0, prior(k)});
    }
    return list;
  }
  [[nodiscard]] std::vector<std::vector<double>> expected_zeros() const override {
    const auto* splines = basis_as<Splines>(curve_);
    if (!splines) return {};
    return splines->penalty(strength(), typical_size(), function_count(curve_));
  }
  [[nodiscard]] vehicle::Storage storage() const override {
    if (is_the_lidars(curve_)) return vehicle::Storage::driver;
    return is_of_one_drive(curve_) ? vehicle::Storage::nowhere : vehicle::Storage::host;
  }
  /// Wheels that changed with time begin the next drive as they ended this one.
  [[nodiscard]] bool carries_over() const override {
    return curve_.law.variable == vehicle::Variable::time && !is_the_lidars(curve_) &&
           !basis_as<Cycle>(curve_);
  }
  /// A head that sways moves sideways too, which looks like a base that does: odometry must not follow it.
  [[nodiscard]] bool excludes(const vehicle::Law& law) const override {
    return concerns_sensor(curve_) &&
           (law.carrier == vehicle::Carrier::turn_side || law.carrier == vehicle::Carrier::sideways);
  }

  template <typename T>
  void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) const {
    const std::span<const vehicle::Carrier> carriers = acts_on(curve_);
    for (std::size_t part = 0; part < carriers.size(); ++part) {
      const BasisValues functions = functions_in(curve_, c, part);
      T f(0.0);
      for (std::size_t k = 0; k < functions.size(); ++k) f += p[k] * functions[k];
      carry(carriers[part], c, f, step);
    }
  }

 private:
  [[nodiscard]] double typical_size() const { return typical_size_of(curve_); }
  /// Just after a reversal or a stop a wheel may lose a good part of its travel; otherwise no robot is that
  /// bad.
  [[nodiscard]] double largest_size() const {
    if (basis_as<FadingSince>(curve_)) return 100.0 * typical_size();
    return (curve_.strong ? 60.0 : 20.0) * typical_size();
  }
  [[nodiscard]] double strength() const { return strength_of(curve_); }
  /// Wide for any real defect, narrow enough that what this drive does not show is not made up: a curve must
  /// do no harm in other drives.
  [[nodiscard]] double prior(std::size_t function) const {
    const double usual = 4.0 * typical_size();
    if (const auto* fading = basis_as<FadingSince>(curve_))
      return std::min(fading->prior(function, usual), largest_size());
    const auto* turn_path = basis_as<TurnPath>(curve_);
    return (turn_path ? turn_path->prior(function, usual) : usual) * strength();
  }

  Curve curve_;
};

/// Of the value and its neighbours.
double mean_about(std::span<const double> values, std::size_t k) {
  const std::size_t first = k > 0 ? k - 1 : 0, end = std::min(k + 2, values.size());
  double sum = 0.0;
  for (const double value : values.subspan(first, end - first)) sum += value;
  return sum / static_cast<double>(end - first);
}

}  // namespace

std::vector<Curve> as_rough_as(const Curve& curve, std::span<const double> coefficients) {
  const auto* splines = basis_as<Splines>(curve);
  const std::size_t count = splines ? splines->roughness.size() : 0;
  std::vector<double> bends;
  for (std::size_t k = 0; k < count; ++k)
    bends.push_back(std::abs(coefficients[k] - 2.0 * coefficients[k + 1] + coefficients[k + 2]) /
                    (strength_of(curve) * typical_size_of(curve)));
  std::vector<Curve> shapes;
  for (const double least : kRoughness) {
    if (count == 0 || least == kRoughness.back()) break;
    Splines rough = *splines;
    for (std::size_t k = 0; k < count; ++k) rough.roughness[k] = std::hypot(least, mean_about(bends, k));
    shapes.push_back(on_basis(curve, std::move(rough)));
  }
  return shapes;
}

std::shared_ptr<const vehicle::Effect> make_curve_effect(const Curve& curve) {
  return std::make_shared<CurveEffect>(curve);
}

}  // namespace odomcalib::calib::terms
