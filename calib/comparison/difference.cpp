#include "calib/comparison/difference.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "calib/comparison/settings.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/se2.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/vehicle/settings.hpp"
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
void adjust(std::vector<double*> p_values) {
  std::sort(p_values.begin(), p_values.end(), [](const double* a, const double* b) { return *a < *b; });
  double least = 0.0;
  for (std::size_t k = 0; k < p_values.size(); ++k) {
    least = std::max(least, std::min(1.0, static_cast<double>(p_values.size() - k) * *p_values[k]));
    *p_values[k] = least;
  }
}

void adjust(std::vector<Change>& changes) {
  std::vector<double*> p_values(changes.size());
  std::transform(changes.begin(), changes.end(), p_values.begin(),
                 [](Change& change) { return &change.p_value; });
  adjust(std::move(p_values));
}

Change change_of(const std::string& name, const Quantity& before, const Quantity& after) {
  Change change{name, before.unit, before.value, after.value, std::hypot(before.std, after.std)};
  change.p_value = two_sided(change.deviations());
  return change;
}

/// Length of a vector that is known by two components.
Quantity length_of(const Quantity& one, const Quantity& other) {
  Quantity length{std::hypot(one.value, other.value), -1.0, one.unit};
  if (one.std > 0.0 && other.std > 0.0 && length.value > 0.0)
    length.std = std::hypot(one.value * one.std, other.value * other.std) / length.value;
  return length;
}

bool has_deviation(const Quantity& quantity) { return quantity.std > 0.0 && std::isfinite(quantity.std); }

/// Those that have a deviation.
std::vector<EffectValue> known_values(const EffectResult& effect) {
  std::vector<EffectValue> values = effect_values(effect);
  std::erase_if(values, [](const EffectValue& value) { return !has_deviation(value.quantity); });
  return values;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Effects that exist once per wheel share their name: those of different wheels have no value in common.
bool is_same_effect(const EffectResult& one, const EffectResult& other) {
  if (one.name != other.name) return false;
  const auto values = effect_values(one), others = effect_values(other);
  if (values.empty() || others.empty()) return true;
  return std::any_of(values.begin(), values.end(), [&](const EffectValue& value) {
    return std::any_of(others.begin(), others.end(),
                       [&](const EffectValue& same) { return same.name == value.name; });
  });
}

const EffectResult* find_effect(const Calibration& calibration, const EffectResult& effect) {
  for (const EffectResult& one : calibration.effects)
    if (is_same_effect(one, effect)) return &one;
  return nullptr;
}

/// A place or a scan matcher moves an effect by so much from drive to drive; 0 of what is not known.
double negligible_size(const std::string& effect, const std::string& parameter) {
  for (const auto& known : terms::find_effects(effect))
    for (const vehicle::EffectParameter& own : known->parameters())
      if (own.name == parameter) return vehicle::settings::kNegligibleShare * own.scale;
  if (const terms::LidarEffectPtr known = terms::find_lidar_effect(effect))
    for (const terms::LidarParameter& own : known->parameters())
      if (own.name == parameter) return own.negligible;
  return 0.0;
}

/// The p-value is that of so large a difference where the true one does not matter.
Change change_of(const EffectValue& was, const EffectValue& is) {
  Change change = change_of(was.name, was.quantity, is.quantity);
  const double beyond = std::abs(change.difference()) - was.negligible;
  change.p_value = beyond > 0.0 ? two_sided(beyond / change.std) : 1.0;
  return change;
}

void compare_effect(const EffectResult& before, const EffectResult& after, std::vector<Change>& changes) {
  for (const EffectValue& was : known_values(before))
    for (const EffectValue& is : known_values(after))
      if (is.name == was.name) changes.push_back(change_of(was, is));
}

/// Whether the other calibration may describe the same by an effect of another name.
bool has_alias_in(const Calibration& other, const EffectResult& effect) {
  return std::any_of(other.effects.begin(), other.effects.end(), [&](const EffectResult& one) {
    return contains(effect.aliases, one.name) || contains(one.aliases, effect.name);
  });
}

/// Whether the other calibration's data pointed to it, and something else spoke against it.
bool was_considered_in(const Calibration& other, const EffectResult& effect) {
  return std::any_of(other.considered.begin(), other.considered.end(),
                     [&](const ConsideredTerm& term) { return term.candidate == effect.name; });
}

/// The estimate that the other calibration did not state is smaller than what it finds, and has the deviation
/// that this size says.
double p_of_chance(const Quantity& found, double smallest) {
  const double std = std::hypot(found.std, smallest / settings::kDeviationsOfDetectable);
  return 0.5 * std::erfc((std::abs(found.value) - smallest) / (std * std::sqrt(2.0)));
}

LoneEffect lone(const EffectResult& effect, const Calibration& other) {
  LoneEffect found{.name = effect.name};
  if (has_alias_in(other, effect) || was_considered_in(other, effect)) return found;
  for (const Detectable& entry : other.detectable) {
    if (entry.effect != effect.name || !entry.smallest || !(*entry.smallest > 0.0)) continue;
    for (EffectValue& value : known_values(effect)) {
      if (!contains(value.shown_by, entry.parameter)) continue;
      const double p = p_of_chance(value.quantity, *entry.smallest);
      if (found.smallest && p >= found.p_value) continue;
      found.value = std::move(value);
      found.smallest = entry.smallest;
      found.p_value = p;
    }
  }
  return found;
}

std::vector<LoneEffect> in_one_only(const Calibration& one, const Calibration& other) {
  std::vector<LoneEffect> found;
  for (const EffectResult& effect : one.effects)
    if (find_effect(other, effect) == nullptr) found.push_back(lone(effect, other));
  return found;
}

void compare_effects(const Calibration& before, const Calibration& after, Difference& found) {
  for (const EffectResult& effect : before.effects)
    if (const EffectResult* same = find_effect(after, effect)) compare_effect(effect, *same, found.effects);
  found.came = in_one_only(after, before);
  found.went = in_one_only(before, after);
  found.has_effects =
      !before.effects.empty() || !after.effects.empty() || !before.curves.empty() || !after.curves.empty();
  std::vector<double*> p_values;
  for (Change& change : found.effects) p_values.push_back(&change.p_value);
  for (auto* lone_ones : {&found.came, &found.went})
    for (LoneEffect& effect : *lone_ones)
      if (effect.smallest) p_values.push_back(&effect.p_value);
  adjust(std::move(p_values));
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

bool LoneEffect::is_change() const { return p_value < settings::kChangedLevel; }

bool Difference::has_changed_effect() const {
  const auto is_change = [](const auto& one) { return one.is_change(); };
  return std::any_of(effects.begin(), effects.end(), is_change) ||
         std::any_of(came.begin(), came.end(), is_change) || std::any_of(went.begin(), went.end(), is_change);
}

bool Difference::is_change() const {
  return joint.is_change() || has_changed_effect() ||
         std::any_of(parameters.begin(), parameters.end(), [](const Change& one) { return one.is_change(); });
}

std::vector<EffectValue> effect_values(const EffectResult& effect) {
  std::vector<EffectValue> values;
  const QuantityList& all = effect.parameters;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto& [name, quantity] = all[k];
    const double negligible = negligible_size(effect.name, name);
    if (!std::isfinite(quantity.value)) continue;
    const std::string stem = name.substr(0, name.rfind('_') + 1);
    const std::string next = k + 1 < all.size() ? all[k + 1].first : "";
    const bool of_turn = name == stem + "cos" && next == stem + "sin";
    const bool of_place = !stem.empty() && name == stem + "x" && next == stem + "y";
    if ((of_turn || of_place) && std::isfinite(all[k + 1].second.value)) {
      // A wheel turns through all phases; a floor may have been driven in one direction alone.
      values.push_back({effect.name + ": " + stem + "size", length_of(quantity, all[k + 1].second),
                        of_turn ? std::vector{name, next} : std::vector<std::string>{}, negligible});
      ++k;
    } else {
      values.push_back({effect.name + ": " + name, quantity, {name}, negligible});
    }
  }
  return values;
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
