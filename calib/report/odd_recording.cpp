#include "calib/report/odd_recording.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "calib/math/linear_solve.hpp"
#include "calib/report/settings.hpp"
#include "calib/selection/score.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::report {
namespace {

/// Places in the list of estimates, ascending.
using Group = std::vector<std::size_t>;

std::vector<math::OwnValues> members(const std::vector<math::OwnValues>& all, const Group& group) {
  std::vector<math::OwnValues> some;
  some.reserve(group.size());
  for (const std::size_t k : group) some.push_back(all[k]);
  return some;
}

double q_of(const std::vector<math::OwnValues>& all, const Group& group) {
  return group.size() < 2 ? 0.0 : math::cochran(members(all, group));
}

bool is_homogeneous(const std::vector<math::OwnValues>& all, const Group& group) {
  if (group.size() < 2) return true;
  const auto size = static_cast<std::size_t>(all.front().value.size());
  const double q = q_of(all, group);
  return std::isfinite(q) &&
         !(selection::chi_squared_tail(q, (group.size() - 1) * size) < settings::kApartLevel);
}

Group with_one_more(Group group, std::size_t one) {
  group.insert(std::upper_bound(group.begin(), group.end(), one), one);
  return group;
}

/// Around one estimate, always the nearest next, as far as all are homogeneous.
Group grown_from(const std::vector<math::OwnValues>& all, std::size_t seed) {
  Group group = {seed};
  while (group.size() < all.size()) {
    std::optional<Group> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (std::binary_search(group.begin(), group.end(), k)) continue;
      Group larger = with_one_more(group, k);
      const double q = q_of(all, larger);
      if (q < least) least = q, best = std::move(larger);
    }
    if (!best || !is_homogeneous(all, *best)) break;
    group = std::move(*best);
  }
  return group;
}

Group rest_of(std::size_t size, const Group& group) {
  Group rest;
  for (std::size_t k = 0; k < size; ++k)
    if (!std::binary_search(group.begin(), group.end(), k)) rest.push_back(k);
  return rest;
}

/// The largest groups that are homogeneous.
std::set<Group> largest_groups(const std::vector<math::OwnValues>& all) {
  std::set<Group> found;
  std::size_t most = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    Group group = grown_from(all, k);
    if (group.size() > most) found.clear(), most = group.size();
    if (group.size() == most) found.insert(std::move(group));
  }
  return found;
}

std::pair<std::size_t, std::size_t> most_apart(const std::vector<math::OwnValues>& all) {
  std::pair<std::size_t, std::size_t> found = {0, 1};
  double most = -1.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = i + 1; k < all.size(); ++k)
      if (const double q = q_of(all, {i, k}); q > most) most = q, found = {i, k};
  return found;
}

math::Pool pool_of(const std::vector<math::OwnValues>& all, const Group& group) {
  math::Pool pool(all.front().value.size());
  for (const std::size_t k : group) pool.add(all[k].value, all[k].covariance);
  return pool;
}

/// Something that may have changed: parameters along one direction.
struct Direction {
  std::vector<Eigen::Index> parameters;
  Eigen::VectorXd vector;  ///< per unit of the change
};

std::vector<Direction> directions_of(const std::vector<Eigen::Index>& free, const Eigen::VectorXd& value) {
  std::vector<Direction> all;
  const auto size = static_cast<Eigen::Index>(free.size());
  Eigen::VectorXd wheels = Eigen::VectorXd::Zero(size);
  std::vector<Eigen::Index> both;
  for (Eigen::Index k = 0; k < size; ++k) {
    const Eigen::Index parameter = free[static_cast<std::size_t>(k)];
    all.push_back({{parameter}, Eigen::VectorXd::Unit(size, k)});
    if (parameter != vehicle::kLeftRadius && parameter != vehicle::kRightRadius) continue;
    wheels(k) = value(k);
    both.push_back(parameter);
  }
  if (both.size() == 2) all.push_back({both, wheels});
  return all;
}

/// A difference explained by changes in some directions.
struct Explanation {
  double gain = 0.0;  ///< by what chi-squared falls, less the price of each change
  std::set<Eigen::Index> parameters;
  std::vector<ParameterChange> changes;
};

/// Generalized least squares of the difference in the directions.
std::optional<Explanation> explained_by(const std::vector<Direction>& directions,
                                        const Eigen::VectorXd& apart, const Eigen::MatrixXd& weight,
                                        const std::vector<Eigen::Index>& free) {
  const auto count = static_cast<Eigen::Index>(directions.size());
  Eigen::MatrixXd columns(apart.size(), count);
  std::set<Eigen::Index> named;
  for (Eigen::Index c = 0; c < count; ++c) {
    const Direction& direction = directions[static_cast<std::size_t>(c)];
    for (const Eigen::Index parameter : direction.parameters)
      if (!named.insert(parameter).second) return std::nullopt;  // a wheel alone and both
    columns.col(c) = direction.vector;
  }
  const Eigen::MatrixXd information = columns.transpose() * weight * columns;
  const Eigen::VectorXd right = columns.transpose() * weight * apart;
  const Eigen::VectorXd sizes = math::solve_symmetric(information, right);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(count, count);
  const Eigen::MatrixXd covariance = math::solve_symmetric(information, identity);
  const double price = std::max(price_of_change(), settings::kShareOfChange * apart.dot(weight * apart));
  Explanation found{right.dot(sizes) - static_cast<double>(count) * price, named, {}};
  for (Eigen::Index c = 0; c < count; ++c)
    for (std::size_t k = 0; k < free.size(); ++k) {
      const double part = columns(static_cast<Eigen::Index>(k), c);
      if (part != 0.0)
        found.changes.push_back({free[k], part * sizes(c), sizes(c) / std::sqrt(covariance(c, c))});
    }
  std::stable_sort(found.changes.begin(), found.changes.end(),
                   [](const auto& a, const auto& b) { return std::abs(a.sigmas) > std::abs(b.sigmas); });
  return std::isfinite(found.gain) ? std::optional(found) : std::nullopt;
}

/// Every set of directions, the best first.
std::vector<Explanation> explanations(const math::Pool& odd, const math::Pool& others,
                                      const std::vector<Eigen::Index>& free) {
  const std::vector<Direction> directions = directions_of(free, others.value());
  const Eigen::VectorXd apart = odd.value() - others.value();
  const Eigen::MatrixXd covariance = odd.covariance() + others.covariance();
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(apart.size(), apart.size());
  const Eigen::MatrixXd weight =
      scale.asDiagonal() * math::solve_symmetric(scaled, identity) * scale.asDiagonal();
  std::vector<Explanation> all;
  for (std::size_t set = 1; set < (std::size_t{1} << directions.size()); ++set) {
    std::vector<Direction> some;
    for (std::size_t k = 0; k < directions.size(); ++k)
      if ((set >> k & 1U) != 0) some.push_back(directions[k]);
    if (auto one = explained_by(some, apart, weight, free)) all.push_back(std::move(*one));
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.gain > b.gain; });
  return all;
}

/// The estimate of the group whose difference from the others the fewest changes explain best.
std::size_t oddest(const std::vector<math::OwnValues>& all, const Group& group, const Group& others,
                   const std::vector<Eigen::Index>& free) {
  std::size_t found = group.front();
  double most = -std::numeric_limits<double>::infinity();
  for (const std::size_t k : group) {
    Group without = others;
    std::erase(without, k);
    const auto explained = explanations(pool_of(all, {k}), pool_of(all, without), free);
    if (!explained.empty() && explained.front().gain > most) most = explained.front().gain, found = k;
  }
  return found;
}

struct Groups {
  Group odd, others, neither;
  bool is_decided = false;
};

std::string first_name(const std::vector<math::OwnValues>& all, const Group& group,
                       const std::vector<std::string>& names) {
  std::string first = names[all[group.front()].recording];
  for (const std::size_t k : group) first = std::min(first, names[all[k].recording]);
  return first;
}

/// A group that does not agree with itself is made one recording, and the rest agrees with neither.
void keep_one_of_odd(const std::vector<math::OwnValues>& all, const std::vector<Eigen::Index>& free,
                     Groups& groups) {
  if (groups.is_decided) {
    groups.odd = {oddest(all, groups.odd, groups.others, free)};
  } else {
    const auto [one, other] = most_apart(all);
    groups.odd = {one}, groups.others = {other};
  }
  Group both = groups.others;
  for (const std::size_t k : groups.odd) both = with_one_more(std::move(both), k);
  groups.neither = rest_of(all.size(), both);
}

Groups groups_of(const std::vector<math::OwnValues>& all, const std::vector<Eigen::Index>& free,
                 const std::vector<std::string>& names) {
  const std::set<Group> largest = largest_groups(all);
  Groups groups;
  groups.others = *std::min_element(largest.begin(), largest.end(), [&](const Group& a, const Group& b) {
    return q_of(all, a) < q_of(all, b);
  });
  groups.odd = rest_of(all.size(), groups.others);
  if (groups.odd.empty()) {  // a single parameter, that all others dilute
    groups.odd = {oddest(all, groups.others, groups.others, free)};
    std::erase(groups.others, groups.odd.front());
  }
  groups.is_decided = largest.size() == 1 && 2 * groups.others.size() > all.size();
  if (!is_homogeneous(all, groups.odd)) keep_one_of_odd(all, free, groups);
  if (!groups.is_decided && first_name(all, groups.odd, names) < first_name(all, groups.others, names))
    std::swap(groups.odd, groups.others);
  return groups;
}

std::vector<std::size_t> recordings_of(const std::vector<math::OwnValues>& all, const Group& group) {
  std::vector<std::size_t> numbers;
  numbers.reserve(group.size());
  for (const std::size_t k : group) numbers.push_back(all[k].recording);
  return numbers;
}

bool holds_all(const std::set<Eigen::Index>& a, const std::set<Eigen::Index>& b) {
  return std::includes(a.begin(), a.end(), b.begin(), b.end());
}

}  // namespace

double price_of_change() {
  namespace bm = boost::math;
  return bm::quantile(bm::complement(bm::chi_squared(1.0), settings::kApartLevel));
}

OddRecordings odd_recordings(const std::vector<math::OwnValues>& estimates,
                             const std::vector<Eigen::Index>& free, const std::vector<std::string>& names) {
  const Groups groups = groups_of(estimates, free, names);
  OddRecordings found{recordings_of(estimates, groups.odd),
                      recordings_of(estimates, groups.others),
                      groups.is_decided,
                      recordings_of(estimates, groups.neither),
                      {},
                      {}};
  const std::vector<Explanation> all =
      explanations(pool_of(estimates, groups.odd), pool_of(estimates, groups.others), free);
  if (all.empty()) return found;
  const Explanation& best = all.front();
  found.changes = best.changes;
  for (const Explanation& other : all) {
    if (other.gain < best.gain - price_of_change()) break;
    if (holds_all(other.parameters, best.parameters) || holds_all(best.parameters, other.parameters))
      continue;
    found.as_well = other.changes;
    break;
  }
  return found;
}

}  // namespace odomcalib::calib::report
