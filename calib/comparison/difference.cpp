#include "calib/comparison/difference.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numeric>

#include "calib/comparison/settings.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/se2.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::calib::comparison {
namespace {

double two_sided(double deviations) { return std::erfc(std::abs(deviations) / std::sqrt(2.0)); }

/// Units of the parameters differ by orders of magnitude, so the correlation matrix is decomposed.
/// Directions that were not measured count for nothing.
JointTest squared_distance(const Eigen::VectorXd& apart, const Eigen::MatrixXd& covariance) {
  JointTest test;
  if (apart.size() == 0) return test;
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const auto [values, vectors] = math::eigensystem(scale.asDiagonal() * covariance * scale.asDiagonal());
  const Eigen::VectorXd along = vectors.transpose() * scale.cwiseProduct(apart);
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (!(values(k) > settings::kNoInformation * values(values.size() - 1))) continue;
    test.statistic += along(k) * along(k) / values(k);
    ++test.freedom;
  }
  return test;
}

JointTest with_p_value(JointTest test) {
  namespace bm = boost::math;
  if (test.freedom == 0 || !std::isfinite(test.statistic)) return test;
  const bm::chi_squared distribution(static_cast<double>(test.freedom));
  test.p_value = bm::cdf(bm::complement(distribution, test.statistic));
  return test;
}

/// Replaces the p-value of each alone by that among all.
void adjust(std::vector<Change>& changes) {
  std::vector<std::size_t> order(changes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return changes[a].p_value < changes[b].p_value; });
  double least = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    double& p = changes[order[k]].p_value;
    least = std::max(least, std::min(1.0, static_cast<double>(order.size() - k) * p));
    p = least;
  }
}

Change change_of(const std::string& name, const Quantity& before, const Quantity& after) {
  Change change{name, before.unit, before.value, after.value, std::hypot(before.std, after.std)};
  change.p_value = two_sided(change.deviations());
  return change;
}

const EffectResult* find_effect(const Calibration& calibration, const std::string& name) {
  for (const EffectResult& effect : calibration.effects)
    if (effect.name == name) return &effect;
  return nullptr;
}

/// Those that have a deviation in both.
void compare_effect(const EffectResult& before, const EffectResult& after, std::vector<Change>& changes) {
  for (const auto& [name, was] : before.parameters)
    for (const auto& [same, is] : after.parameters) {
      const bool known = was.std > 0.0 && is.std > 0.0 && std::isfinite(was.value + is.value);
      if (same == name && known) changes.push_back(change_of(before.name + ": " + name, was, is));
    }
}

void compare_effects(const Calibration& before, const Calibration& after, Difference& found) {
  for (const EffectResult& effect : before.effects)
    if (const EffectResult* same = find_effect(after, effect.name))
      compare_effect(effect, *same, found.effects);
    else
      found.went.push_back(effect.name);
  for (const EffectResult& effect : after.effects)
    if (find_effect(before, effect.name) == nullptr) found.came.push_back(effect.name);
  adjust(found.effects);
}

/// Counts are turned into metres by the mean diameter, and into turns by it over the track width: what a
/// state says of that factor, with its relative deviation.
std::optional<Estimate> factor_of(const State& state, bool of_turns) {
  const auto left = state.find(BaseQuantity::left_wheel_diameter),
             right = state.find(BaseQuantity::right_wheel_diameter);
  const auto track = state.find(BaseQuantity::track_width);
  if (!left || !right || (of_turns && !track)) return std::nullopt;
  double factor = 0.5 * (state.value(*left) + state.value(*right));
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(state.value.size());  // of its logarithm
  gradient(*left) = gradient(*right) = 0.5 / factor;
  if (of_turns) {
    gradient(*track) = -1.0 / state.value(*track);
    factor /= state.value(*track);
  }
  return Estimate{factor, std::sqrt(std::max(0.0, gradient.dot(state.covariance * gradient)))};
}

/// Too much in a unit of it, to first order in the deviations.
std::optional<Estimate> too_much(const State& was, const State& is, bool of_turns) {
  const auto before = factor_of(was, of_turns), after = factor_of(is, of_turns);
  if (!before || !after) return std::nullopt;
  const double unit = of_turns ? 2.0 * math::kPi : 1.0;
  return Estimate{unit * (before->value / after->value - 1.0), unit * std::hypot(before->std, after->std)};
}

Urgency urgency_of(const Calibration& newest, const std::optional<Difference>& since_last) {
  if (newest.verdict == Verdict::refused) return Urgency::refused;
  if (since_last && since_last->is_change()) return Urgency::changed;
  return newest.verdict == Verdict::accepted ? Urgency::none : Urgency::warnings;
}

double size_of(const Difference& difference) {
  const double metre = difference.metre_error ? std::abs(difference.metre_error->value) : 0.0;
  const double turn =
      difference.turn_error ? std::abs(difference.turn_error->value) / (2.0 * math::kPi) : 0.0;
  return std::max(metre, turn);
}

}  // namespace

bool Change::is_change() const { return p_value < settings::kChangedLevel; }

bool JointTest::is_change() const { return p_value < settings::kChangedLevel; }

bool Difference::is_change() const {
  return joint.is_change() ||
         std::any_of(parameters.begin(), parameters.end(), [](const Change& one) { return one.is_change(); });
}

Difference difference(const Calibration& before, const Calibration& after) {
  const std::vector<State> states = comparable({state_of(before), state_of(after)});
  const State &was = states[0], &is = states[1];
  const Eigen::MatrixXd covariance = was.covariance + is.covariance;
  Difference found;
  found.metre = metre_of(states);
  found.joint = with_p_value(squared_distance(is.value - was.value, covariance));
  for (std::size_t k = 0; k < was.names.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    Change change{was.names[k], was.units[k], was.value(at), is.value(at), std::sqrt(covariance(at, at))};
    change.p_value = two_sided(change.deviations());
    found.parameters.push_back(std::move(change));
  }
  adjust(found.parameters);
  found.metre_error = too_much(was, is, false);
  found.turn_error = too_much(was, is, true);
  compare_effects(before, after, found);
  return found;
}

JointTest homogeneity(std::span<const Calibration* const> calibrations) {
  std::vector<State> all;
  for (const Calibration* calibration : calibrations) all.push_back(state_of(*calibration));
  all = comparable(std::move(all));
  JointTest sum;
  if (all.empty()) return sum;
  // Each against the pooled estimate of those before it: the squares add up to Cochran's Q.
  Eigen::VectorXd pooled = all.front().value;
  Eigen::MatrixXd covariance = all.front().covariance;
  for (std::size_t k = 1; k < all.size(); ++k) {
    const Eigen::VectorXd apart = all[k].value - pooled;
    const Eigen::MatrixXd both = covariance + all[k].covariance;
    const JointTest step = squared_distance(apart, both);
    sum.statistic += step.statistic;
    sum.freedom += step.freedom;
    const Eigen::MatrixXd gain = math::solve_symmetric(both, covariance).transpose();
    pooled += gain * apart;
    covariance -= gain * covariance;
  }
  return with_p_value(sum);
}

const char* name_of(Urgency urgency) {
  switch (urgency) {
    case Urgency::refused:
      return "refused";
    case Urgency::changed:
      return "changed";
    case Urgency::warnings:
      return "warnings";
    case Urgency::none:
      break;
  }
  return "fine";
}

bool RobotStanding::is_before(const RobotStanding& other) const {
  return urgency != other.urgency ? urgency < other.urgency : size > other.size;
}

RobotStanding standing_of(const Calibration& newest, std::span<const Calibration* const> usable) {
  RobotStanding standing;
  if (usable.size() > 1) {
    standing.since_last = difference(*usable[usable.size() - 2], *usable.back());
    standing.size = size_of(*standing.since_last);
  }
  standing.urgency = urgency_of(newest, standing.since_last);
  return standing;
}

}  // namespace odomcalib::calib::comparison
