#include "calib/terms/smooth_term_effect.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/terms/effects/step_effect.hpp"
#include "calib/terms/smooth_term.hpp"

namespace odomcalib::calib::terms {
namespace {

/// Relative; rad per m; m per rad.
double typical_size_of(const SmoothTerm& smooth) {
  if (smooth.dependence.channel == vehicle::Channel::yaw_path || concerns_sensor(smooth)) return 0.02;
  // The size includes a scan matcher's own bias in one room.
  if (smooth.dependence.covariate == vehicle::Covariate::heading ||
      smooth.dependence.covariate == vehicle::Covariate::position)
    return 0.015;
  // An error of the encoder's angle shows in its rate, n times as large for the n-th harmonic.
  if (const auto* wave = basis_as<Harmonics>(smooth); wave && wave->only > 0) return 5e-3 * wave->only;
  const bool per_turn = smooth.dependence.channel == vehicle::Channel::turn_path ||
                        smooth.dependence.channel == vehicle::Channel::turn_side;
  return per_turn ? 1e-3 : 5e-3;
}

double strength_of(const SmoothTerm& smooth) { return smooth.strong ? 6.0 : 1.0; }

/// Just after a reversal or a stop a wheel may lose a good part of its travel; otherwise no robot is that
/// bad.
double largest_size_of(const SmoothTerm& smooth) {
  if (basis_as<FadingSince>(smooth)) return 100.0 * typical_size_of(smooth);
  return (smooth.strong ? 60.0 : 20.0) * typical_size_of(smooth);
}

/// Wide for any real defect, narrow enough that what this drive does not show is not made up: a smooth term
/// must do no harm in other drives.
double prior_of(const SmoothTerm& smooth, std::size_t function) {
  const double usual = 4.0 * typical_size_of(smooth);
  if (const auto* fading = basis_as<FadingSince>(smooth))
    return std::min(fading->prior(function, usual), largest_size_of(smooth));
  const auto* turn_path = basis_as<TurnPath>(smooth);
  return (turn_path ? turn_path->prior(function, usual) : usual) * strength_of(smooth);
}

std::vector<vehicle::EffectParameter> coefficients_of(const SmoothTerm& smooth) {
  const double largest = largest_size_of(smooth);
  std::vector<vehicle::EffectParameter> list;
  for (std::size_t k = 0; k < function_count(smooth); ++k)
    list.push_back({.name = "c" + std::to_string(k + 1),
                    .unit = "1",
                    .scale = typical_size_of(smooth),
                    .lower = -largest,
                    .upper = largest,
                    .prior = prior_of(smooth, k)});
  return list;
}

std::vector<std::vector<double>> expected_zeros_of(const SmoothTerm& smooth) {
  const auto* splines = basis_as<Splines>(smooth);
  if (!splines) return {};
  return splines->penalty(strength_of(smooth), typical_size_of(smooth), function_count(smooth));
}

/// A head that sways moves sideways too, which looks like a base that does: odometry must not follow it.
std::vector<vehicle::Channel> excluded_channels_of(const SmoothTerm& smooth) {
  if (!concerns_sensor(smooth)) return {};
  return {vehicle::Channel::turn_side, vehicle::Channel::sideways};
}

vehicle::Storage storage_of(const SmoothTerm& smooth) {
  if (belongs_to_lidar(smooth)) return vehicle::Storage::driver;
  return is_of_one_drive(smooth) ? vehicle::Storage::nowhere : vehicle::Storage::host;
}

/// Wheels that changed with time begin the next drive as they ended this one.
bool is_carried_over(const SmoothTerm& smooth) {
  return smooth.dependence.covariate == vehicle::Covariate::time && !belongs_to_lidar(smooth) &&
         !basis_as<Cycle>(smooth);
}

vehicle::EffectRow row_of(const SmoothTerm& smooth) {
  return {.name = "curve of " + to_string(smooth.dependence.covariate) + " on " +
                  to_string(smooth.dependence.channel),
          .parameters = coefficients_of(smooth),
          .expected_zeros = expected_zeros_of(smooth),
          .excluded_channels = excluded_channels_of(smooth),
          .storage = storage_of(smooth),
          .carries_over = is_carried_over(smooth),
          .covariates = groups_of(smooth.dependence.covariate)};
}

class SmoothTermEffect final : public StepEffect<SmoothTermEffect> {
 public:
  explicit SmoothTermEffect(const SmoothTerm& smooth) : StepEffect(row_of(smooth)), smooth_(smooth) {}

  template <typename T>
  void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) const {
    const std::span<const vehicle::Channel> channels = acts_on(smooth_);
    for (std::size_t part = 0; part < channels.size(); ++part) {
      const BasisValues functions = functions_in(smooth_, c, part);
      T f(0.0);
      for (std::size_t k = 0; k < functions.size(); ++k) f += p[k] * functions[k];
      carry(channels[part], c, f, step);
    }
  }

 private:
  SmoothTerm smooth_;
};

/// Mean of the value and its neighbours.
double mean_about(std::span<const double> values, std::size_t k) {
  const std::size_t first = k > 0 ? k - 1 : 0, end = std::min(k + 2, values.size());
  double sum = 0.0;
  for (const double value : values.subspan(first, end - first)) sum += value;
  return sum / static_cast<double>(end - first);
}

}  // namespace

std::vector<SmoothTerm> as_rough_as(const SmoothTerm& smooth, std::span<const double> coefficients) {
  const auto* splines = basis_as<Splines>(smooth);
  const std::size_t count = splines ? splines->roughness.size() : 0;
  std::vector<double> bends;
  for (std::size_t k = 0; k < count; ++k)
    bends.push_back(std::abs(coefficients[k] - 2.0 * coefficients[k + 1] + coefficients[k + 2]) /
                    (strength_of(smooth) * typical_size_of(smooth)));
  std::vector<SmoothTerm> shapes;
  for (const double least : kRoughness) {
    if (count == 0 || least == kRoughness.back()) break;
    Splines rough = *splines;
    for (std::size_t k = 0; k < count; ++k) rough.roughness[k] = std::hypot(least, mean_about(bends, k));
    shapes.push_back(on_basis(smooth, std::move(rough)));
  }
  return shapes;
}

std::shared_ptr<const vehicle::Effect> make_smooth_term_effect(const SmoothTerm& smooth) {
  return std::make_shared<SmoothTermEffect>(smooth);
}

}  // namespace odomcalib::calib::terms
