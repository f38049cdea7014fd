#include "calib/ingest/stamp_contest.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "calib/ingest/settings.hpp"
#include "calib/math/median.hpp"

namespace odomcalib::calib::ingest {

/// Least squares with what lies beyond `limit` of the line of share `near` cut down to it (Huber, Ann. Math.
/// Stat. 35, 1964).
StampContest::Share StampContest::share(double limit, double near) const {
  double product = 0.0, square = 0.0, variance = 0.0;
  const auto weight_of = [&](const Error& e) {
    const double residual = std::abs(e.given - near * e.difference);
    return residual > limit ? limit / residual : 1.0;
  };
  for (const Error& e : errors_) {
    product += weight_of(e) * e.given * e.difference;
    square += weight_of(e) * e.difference * e.difference;
  }
  if (!(square > 0.0)) return {0.0, std::numeric_limits<double>::infinity()};
  const double value = product / square;
  for (const Error& e : errors_)
    variance += std::pow(weight_of(e) * e.difference * (e.given - value * e.difference), 2);
  return {value, std::sqrt(variance) / square};
}

double StampContest::spread(double share) const {
  std::vector<double> residuals;
  residuals.reserve(errors_.size());
  for (const Error& e : errors_) residuals.push_back(e.given - share * e.difference);
  return math::deviation_about(0.0, std::move(residuals));
}

bool StampContest::is_for_even() const {
  if (errors_.empty()) return false;
  Share found{0.5, 0.0};
  for (int round = 0; round < settings::kContestRounds; ++round)
    found = share(settings::kContestLimit * spread(found.value), found.value);
  return found.value - settings::kEvenSigmas * found.deviation > settings::kEvenShare;
}

}  // namespace odomcalib::calib::ingest
