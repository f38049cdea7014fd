#include "calib/terms/smooth_term_on_drives.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "calib/terms/settings.hpp"

namespace odomcalib::calib::terms {
namespace {

/// How much motion of the channel an interval holds.
double amount(vehicle::Channel channel, const vehicle::StepContext& c) {
  switch (channel) {
    case vehicle::Channel::left_travel:
    case vehicle::Channel::left_path:
      return std::abs(c.left_delta);
    case vehicle::Channel::right_travel:
    case vehicle::Channel::right_path:
      return std::abs(c.right_delta);
    case vehicle::Channel::track:
    case vehicle::Channel::turn_path:
    case vehicle::Channel::turn_side:
      return std::abs(c.turn_rate) * c.dt;
    default:
      return std::abs(c.speed) * c.dt;
  }
}

bool is_at_rest(const vehicle::StepContext& c) {
  return std::abs(c.left_speed) <= settings::kMoving && std::abs(c.right_speed) <= settings::kMoving;
}

/// The smooth term's functions in an interval on each of its channels, with how much motion they act on.
template <typename Visit>
void for_each_part(const SmoothTerm& smooth, const vehicle::StepContext& c, const Visit& visit) {
  const std::span<const vehicle::Channel> channels = acts_on(smooth);
  for (std::size_t part = 0; part < channels.size(); ++part)
    visit(part, functions_of(smooth, c, part), amount(channels[part], c));
}

/// Each of the smooth term's values in an interval, with how much motion it acts on.
template <typename Visit>
void for_each_value(const SmoothTerm& smooth, std::span<const double> coefficients,
                    const vehicle::StepContext& c, const Visit& visit) {
  for_each_part(smooth, c, [&](std::size_t /*part*/, const BasisValues& functions, double weight) {
    visit(std::inner_product(functions.begin(), functions.end(), coefficients.begin(), 0.0), weight);
  });
}

}  // namespace

std::pair<double, double> range_of(vehicle::Covariate covariate,
                                   std::span<const vehicle::DriveModel* const> models, std::size_t memory) {
  std::vector<double> values;
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context()) {
      if (is_at_rest(c)) continue;
      values.push_back(value_of(covariate, c, memory));
      if (covariate == vehicle::Covariate::position) values.push_back(c.y);
      if (covariate == vehicle::Covariate::wheel_speed) values.push_back(c.right_speed);
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
  double ahead = 0.0, back = 0.0;
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context())
      (c.speed > 0.0 ? ahead : back) += std::abs(c.speed) * c.dt;
  return std::min(ahead, back) > settings::kLeastOfWay * (ahead + back);
}

bool may_be_centred(const SmoothTerm& smooth) {
  return !is_bump(smooth) && signed_counterpart(smooth.dependence.channel) == smooth.dependence.channel;
}

SmoothTerm as_of_the_drive(SmoothTerm smooth, std::span<const vehicle::DriveModel* const> models) {
  const bool ends_as_it_is = is_bump(smooth) || basis_as<Decay>(smooth);
  const auto* waves = basis_as<Harmonics>(smooth);
  const bool has_constant = waves && waves->constant;
  const bool has_mean = belongs_to_the_place(smooth.dependence.covariate) && !has_constant && !ends_as_it_is;
  return has_mean ? centred(std::move(smooth), models) : smooth;
}

SmoothTerm centred(SmoothTerm smooth, std::span<const vehicle::DriveModel* const> models) {
  std::vector<double> sum(function_count(smooth), 0.0), total(sum.size(), 1e-12);
  smooth.mean.clear();
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context())
      for_each_part(smooth, c, [&](std::size_t part, const BasisValues& functions, double weight) {
        for (std::size_t k = 0; k < sum.size(); ++k) {
          sum[k] += weight * functions[k];
          if (belongs_to(smooth, k, part)) total[k] += weight;
        }
      });
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] /= total[k];
  smooth.mean = std::move(sum);
  return smooth;
}

double spread_of(const SmoothTerm& smooth, std::span<const double> coefficients,
                 std::span<const vehicle::DriveModel* const> models) {
  double sum = 0.0, total = 0.0;
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context())
      for_each_value(smooth, coefficients, c, [&](double f, double weight) {
        sum += weight * f * f;
        total += weight;
      });
  return std::sqrt(sum / std::max(total, 1e-12));
}

double half_span_of(const SmoothTerm& smooth, std::span<const double> coefficients,
                    std::span<const vehicle::DriveModel* const> models) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const vehicle::DriveModel* model : models)
    for (const vehicle::StepContext& c : model->context()) {
      if (is_at_rest(c)) continue;
      for_each_value(smooth, coefficients, c, [&](double f, double /*motion*/) {
        low = std::min(low, f);
        high = std::max(high, f);
      });
    }
  return std::max(0.0, 0.5 * (high - low));
}

bool leaves_mean_to_wheels(const SmoothTerm& smooth, std::span<const vehicle::DriveModel* const> models) {
  return smooth.dependence == vehicle::Dependence{vehicle::Covariate::heading, vehicle::Channel::yaw_path} &&
         !goes_both_ways(models);
}

}  // namespace odomcalib::calib::terms
