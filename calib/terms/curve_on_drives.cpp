#include "calib/terms/curve_on_drives.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace odomcalib::calib::terms {
namespace {

constexpr double kMoving = 0.01;  ///< m/s of either wheel; standing still shows nothing

/// How much motion of the carrier an interval holds.
double amount(vehicle::Carrier carrier, const vehicle::StepContext& c) {
  switch (carrier) {
    case vehicle::Carrier::left_travel:
    case vehicle::Carrier::left_path:
      return std::abs(c.left_delta);
    case vehicle::Carrier::right_travel:
    case vehicle::Carrier::right_path:
      return std::abs(c.right_delta);
    case vehicle::Carrier::track:
    case vehicle::Carrier::turn_path:
    case vehicle::Carrier::turn_side:
      return std::abs(c.turn_rate) * c.dt;
    default:
      return std::abs(c.speed) * c.dt;
  }
}

bool is_at_rest(const vehicle::StepContext& c) {
  return std::abs(c.left_speed) <= kMoving && std::abs(c.right_speed) <= kMoving;
}

/// The curve's functions in an interval on each of its carriers, with how much motion they act on.
template <typename Visit>
void for_each_part(const Curve& curve, const vehicle::StepContext& c, const Visit& visit) {
  const std::span<const vehicle::Carrier> carriers = acts_on(curve);
  for (std::size_t part = 0; part < carriers.size(); ++part)
    visit(part, functions_of(curve, c, part), amount(carriers[part], c));
}

/// Each of the curve's values in an interval, with how much motion it acts on.
template <typename Visit>
void for_each_value(const Curve& curve, std::span<const double> coefficients, const vehicle::StepContext& c,
                    const Visit& visit) {
  for_each_part(curve, c, [&](std::size_t /*part*/, const BasisValues& functions, double weight) {
    visit(std::inner_product(functions.begin(), functions.end(), coefficients.begin(), 0.0), weight);
  });
}

}  // namespace

std::pair<double, double> range_of(vehicle::Variable variable,
                                   std::span<const vehicle::DriveModel* const> models, std::size_t memory) {
  std::vector<double> values;
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context()) {
      if (is_at_rest(c)) continue;
      values.push_back(value_of(variable, c, memory));
      if (variable == vehicle::Variable::position) values.push_back(c.y);
      if (variable == vehicle::Variable::wheel_speed) values.push_back(c.right_speed);
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

bool goes_both_ways(std::span<const vehicle::DriveModel* const> models) {
  constexpr double kLeast = 0.2;  // of the way
  double ahead = 0.0, back = 0.0;
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context())
      (c.speed > 0.0 ? ahead : back) += std::abs(c.speed) * c.dt;
  return std::min(ahead, back) > kLeast * (ahead + back);
}

bool may_be_centred(const Curve& curve) {
  return !is_bump(curve) && signed_counterpart(curve.law.carrier) == curve.law.carrier;
}

Curve as_of_the_drive(Curve curve, std::span<const vehicle::DriveModel* const> models) {
  const bool ends_as_it_is = is_bump(curve) || basis_as<Decay>(curve);
  const auto* waves = basis_as<Harmonics>(curve);
  const bool has_constant = waves && waves->constant;
  const bool has_mean = belongs_to_the_place(curve.law.variable) && !has_constant && !ends_as_it_is;
  return has_mean ? centred(std::move(curve), models) : curve;
}

Curve centred(Curve curve, std::span<const vehicle::DriveModel* const> models) {
  std::vector<double> sum(function_count(curve), 0.0), total(sum.size(), 1e-12);
  curve.mean.clear();
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context())
      for_each_part(curve, c, [&](std::size_t part, const BasisValues& functions, double weight) {
        for (std::size_t k = 0; k < sum.size(); ++k) {
          sum[k] += weight * functions[k];
          if (belongs_to(curve, k, part)) total[k] += weight;
        }
      });
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] /= total[k];
  curve.mean = std::move(sum);
  return curve;
}

double spread_of(const Curve& curve, std::span<const double> coefficients,
                 std::span<const vehicle::DriveModel* const> models) {
  double sum = 0.0, total = 0.0;
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context())
      for_each_value(curve, coefficients, c, [&](double f, double weight) {
        sum += weight * f * f;
        total += weight;
      });
  return std::sqrt(sum / std::max(total, 1e-12));
}

double half_span_of(const Curve& curve, std::span<const double> coefficients,
                    std::span<const vehicle::DriveModel* const> models) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context()) {
      if (is_at_rest(c)) continue;
      for_each_value(curve, coefficients, c, [&](double f, double /*motion*/) {
        low = std::min(low, f);
        high = std::max(high, f);
      });
    }
  return std::max(0.0, 0.5 * (high - low));
}

bool leaves_mean_to_wheels(const Curve& curve, std::span<const vehicle::DriveModel* const> models) {
  return curve.law == vehicle::Law{vehicle::Variable::heading, vehicle::Carrier::yaw_path} &&
         !goes_both_ways(models);
}

}  // namespace odomcalib::calib::terms
