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

/// Whether the term has a mean that belongs to the place or the day.
bool has_mean(const SmoothTerm& smooth) {
  const bool ends_as_it_is = is_bump(smooth) || basis_as<Decay>(smooth);
  const auto* waves = basis_as<Harmonics>(smooth);
  const bool has_constant = waves && waves->constant;
  return belongs_to_the_place(smooth.dependence.covariate) && !has_constant && !ends_as_it_is;
}

/// Means of a smooth term's functions over the motion of its channels.
class Means {
 public:
  explicit Means(std::size_t functions) : sum_(functions, 0.0), total_(functions, 1e-12) {}

  void add(const SmoothTerm& smooth, const BasisValues& functions, std::size_t part, double weight) {
    for (std::size_t k = 0; k < sum_.size(); ++k) {
      sum_[k] += weight * functions[k];
      if (belongs_to(smooth, k, part)) total_[k] += weight;
    }
  }
  [[nodiscard]] std::vector<double> values() const {
    std::vector<double> means = sum_;
    for (std::size_t k = 0; k < means.size(); ++k) means[k] /= total_[k];
    return means;
  }

 private:
  std::vector<double> sum_, total_;
};

/// How many from the first on have the same functions.
std::size_t count_same_functions(std::span<const SmoothTerm> smooths) {
  std::size_t count = 1;
  while (count < smooths.size() && differ_in_channel_only(smooths.front(), smooths[count])) ++count;
  return count;
}

/// @param alike smooth terms with the same functions
void add_interval(std::span<const SmoothTerm> alike, const vehicle::StepContext& c, std::span<Means> means) {
  for (std::size_t part = 0; part < acts_on(alike.front()).size(); ++part) {
    const BasisValues functions = functions_of(alike.front(), c, part);
    for (std::size_t k = 0; k < alike.size(); ++k)
      means[k].add(alike[k], functions, part, amount(acts_on(alike[k])[part], c));
  }
}

/// Smooth terms about their means, some intervals of all of them at a time: an hour's intervals are more than
/// fast memory holds, and its smooth terms are hundreds.
std::vector<SmoothTerm> all_centred(std::vector<SmoothTerm> smooths,
                                    std::span<const vehicle::DriveModel* const> models) {
  constexpr std::size_t kIntervals = 16;
  std::vector<Means> means;
  std::vector<std::size_t> alike;
  for (SmoothTerm& smooth : smooths) {
    smooth.mean.clear();
    means.emplace_back(function_count(smooth));
  }
  for (std::size_t k = 0; k < smooths.size(); k += alike.back())
    alike.push_back(count_same_functions(std::span<const SmoothTerm>(smooths).subspan(k)));
  for (const vehicle::DriveModel* model : models) {
    const std::span<const vehicle::StepContext> context = model->context();
    for (std::size_t begin = 0; begin < context.size(); begin += kIntervals) {
      std::size_t first = 0;
      for (const std::size_t count : alike) {
        for (const auto& c : context.subspan(begin, std::min(kIntervals, context.size() - begin)))
          add_interval(std::span<const SmoothTerm>(smooths).subspan(first, count), c,
                       std::span<Means>(means).subspan(first, count));
        first += count;
      }
    }
  }
  for (std::size_t k = 0; k < smooths.size(); ++k) smooths[k].mean = means[k].values();
  return smooths;
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

SmoothTerm centred(SmoothTerm smooth, std::span<const vehicle::DriveModel* const> models) {
  return all_centred({std::move(smooth)}, models).front();
}

SmoothTerm as_of_the_drive(SmoothTerm smooth, std::span<const vehicle::DriveModel* const> models) {
  return has_mean(smooth) ? centred(std::move(smooth), models) : smooth;
}

std::vector<SmoothTerm> as_of_the_drive(std::vector<SmoothTerm> smooths,
                                        std::span<const vehicle::DriveModel* const> models) {
  std::vector<SmoothTerm> with_mean;
  for (const SmoothTerm& smooth : smooths)
    if (has_mean(smooth)) with_mean.push_back(smooth);
  with_mean = all_centred(std::move(with_mean), models);
  auto next = with_mean.begin();
  for (SmoothTerm& smooth : smooths)
    if (has_mean(smooth)) smooth = std::move(*next++);
  return smooths;
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
