#include "calib/terms/curve_effect.hpp"

#include <algorithm>
#include <cmath>

#include "calib/terms/basis.hpp"
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
  if (curve.harmonic > 0) return 5e-3 * curve.harmonic;
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
    for (std::size_t k = 0; k < basis_size(curve_); ++k) {
      std::string name(1, 'c');
      list.push_back({name.append(std::to_string(k + 1)), "1", typical_size(), -largest_size(),
                      largest_size(), 0.0, prior(k)});
    }
    return list;
  }
  [[nodiscard]] std::vector<std::vector<double>> expected_zeros() const override {
    std::vector<std::vector<double>> differences;
    for (std::size_t k = 0; k < curve_.roughness.size(); ++k) {
      const double weight = 1.0 / (curve_.roughness[k] * strength() * typical_size());
      differences.emplace_back(basis_size(curve_), 0.0);
      differences.back()[k] = differences.back()[k + 2] = weight;
      differences.back()[k + 1] = -2.0 * weight;
    }
    return differences;
  }
  [[nodiscard]] vehicle::Storage storage() const override {
    if (is_the_lidars(curve_)) return vehicle::Storage::driver;
    return is_of_one_drive(curve_) ? vehicle::Storage::nowhere : vehicle::Storage::host;
  }
  /// Wheels that changed with time begin the next drive as they ended this one.
  [[nodiscard]] bool carries_over() const override {
    return curve_.law.variable == vehicle::Variable::time && !is_the_lidars(curve_) && curve_.period == 0.0;
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
    if (is_distance_since(curve_.law.variable)) return 100.0 * typical_size();
    return (curve_.strong ? 60.0 : 20.0) * typical_size();
  }
  [[nodiscard]] double strength() const { return strength_of(curve_); }
  /// Wide for any real defect, narrow enough that what this drive does not show is not made up: a curve must
  /// do no harm in other drives.
  [[nodiscard]] double prior(std::size_t function) const {
    // Where turns of one speed cannot tell which, each radian leaves the same way.
    const bool is_refinement = curve_.law.carrier == vehicle::Carrier::turn_path && function > 0;
    const double usual = (is_refinement ? 1.0 : 4.0) * typical_size();
    if (!is_distance_since(curve_.law.variable)) return usual * strength();
    // What is lost between one knot and the next is as much everywhere, the way between them half as long.
    return std::min(std::ldexp(usual, kFadeKnots - 1 - static_cast<int>(function)), largest_size());
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
  const std::size_t count = curve.roughness.size();
  std::vector<double> bends;
  for (std::size_t k = 0; k < count; ++k)
    bends.push_back(std::abs(coefficients[k] - 2.0 * coefficients[k + 1] + coefficients[k + 2]) /
                    (strength_of(curve) * typical_size_of(curve)));
  std::vector<Curve> shapes;
  for (const double least : kRoughness) {
    if (count == 0 || least == kRoughness.back()) break;
    shapes.push_back(curve);
    for (std::size_t k = 0; k < count; ++k)
      shapes.back().roughness[k] = std::hypot(least, mean_about(bends, k));
  }
  return shapes;
}

std::shared_ptr<const vehicle::Effect> make_curve_effect(const Curve& curve) {
  return std::make_shared<CurveEffect>(curve);
}

}  // namespace odomcalib::calib::terms
