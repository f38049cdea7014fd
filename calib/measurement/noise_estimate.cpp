#include "calib/measurement/noise_estimate.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calib/math/median.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

struct Observation {
  std::span<const SensorPair> pairs;
  std::span<const PairState> states;
  std::vector<Eigen::Vector3d> residuals;  ///< in room axes
};

/// Symmetric matrices, one a row: xx, xy, yy, x yaw, y yaw, yaw yaw.
using Matrices = Eigen::Array<double, Eigen::Dynamic, 6>;

/// Values of pairs, by columns, so that many are judged at a time.
struct Columns {
  Eigen::Array<double, Eigen::Dynamic, 3> residuals;
  Matrices matcher;  ///< covariance the matcher states, in room axes
  Matrices jitter;   ///< what a stamp error of 1 s would add
};

void set_row(Matrices& matrices, Eigen::Index row, const Eigen::Matrix3d& m) {
  matrices.row(row) << m(0, 0), m(1, 0), m(1, 1), m(2, 0), m(2, 1), m(2, 2);
}

/// Columns of evenly spaced pairs where there are more than a scale needs.
Columns columns_of(const Observation& o) {
  const std::size_t step = 1 + (o.pairs.size() - 1) / settings::kMostNoisePairs;
  const auto count = static_cast<Eigen::Index>(1 + (o.pairs.size() - 1) / step);
  Columns columns{decltype(Columns::residuals)(count, 3), Matrices(count, 6), Matrices(count, 6)};
  const NoiseModel matcher_only;
  NoiseModel one_second;
  one_second.matcher_scale = 0.0;
  one_second.stamp_jitter = 1.0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::size_t pair = step * static_cast<std::size_t>(k);
    columns.residuals.row(k) = o.residuals[pair].transpose();
    set_row(columns.matcher, k, base_covariance(o.pairs[pair], o.states[pair], matcher_only));
    set_row(columns.jitter, k, full_covariance(o.pairs[pair], o.states[pair], one_second));
  }
  return columns;
}

/// Some pairs, as many as stay in the fastest memory.
constexpr Eigen::Index kFew = 64;
using Few = Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, kFew, 1>;

/// -2 log likelihood of independent t-distributed pairs; neighbours' correlation does not matter for the
/// scale.
/// By the pivots of each pair's covariance (Golub and Van Loan, Matrix Computations, 4.1: L D L^T).
double misfit(const Columns& o, const NoiseModel& noise) {
  const double matcher = noise.matcher_scale * noise.matcher_scale;
  const double jitter = noise.stamp_jitter * noise.stamp_jitter;
  const double translation = noise.process_translation * noise.process_translation;
  const double rotation = noise.process_rotation * noise.process_rotation;
  double sum = 0.0;
  for (Eigen::Index first = 0; first < o.residuals.rows(); first += kFew) {
    const Eigen::Index count = std::min(kFew, o.residuals.rows() - first);
    const auto covariance = [&](Eigen::Index entry) {
      return matcher * o.matcher.col(entry).segment(first, count) +
             jitter * o.jitter.col(entry).segment(first, count);
    };
    const auto residual = [&](Eigen::Index axis) { return o.residuals.col(axis).segment(first, count); };
    const Few pivot_x = covariance(0) + translation;
    const Few y_on_x = covariance(1) / pivot_x, yaw_on_x = covariance(3) / pivot_x;
    const Few pivot_y = covariance(2) + translation - y_on_x.square() * pivot_x;
    const Few yaw_on_y = (covariance(4) - yaw_on_x * y_on_x * pivot_x) / pivot_y;
    const Few pivot_yaw =
        covariance(5) + rotation - yaw_on_x.square() * pivot_x - yaw_on_y.square() * pivot_y;
    const Few y = residual(1) - y_on_x * residual(0);
    const Few yaw = residual(2) - yaw_on_x * residual(0) - yaw_on_y * y;
    const Few squared = residual(0).square() / pivot_x + y.square() / pivot_y + yaw.square() / pivot_yaw;
    sum += (pivot_x * pivot_y * pivot_yaw).log().sum() +
           (kStudentDof + 3.0) * (1.0 + kStudentConsistency / kStudentDof * squared).log().sum();
  }
  return sum;
}

struct Range {
  double NoiseModel::*member;
  double low, high;  ///< of the search on a logarithmic scale
  bool may_vanish;
};

constexpr std::array<Range, 4> kRanges = {
    {{&NoiseModel::process_rotation, settings::kLeastProcess, settings::kMostProcess, true},
     {&NoiseModel::process_translation, settings::kLeastProcess, settings::kMostProcess, true},
     {&NoiseModel::stamp_jitter, settings::kLeastJitter_s, settings::kMostJitter_s, true},
     {&NoiseModel::matcher_scale, settings::kLeastMatcherScale, settings::kMostMatcherScale, false}}};

/// Golden-section search on the logarithm, and zero where that is as good.
void improve_noise(const Columns& o, const Range& range, NoiseModel& noise) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double a = std::log(range.low);
  double b = std::log(range.high);
  const auto value_at = [&](double log_value) {
    noise.*range.member = std::exp(log_value);
    return misfit(o, noise);
  };
  double c = b - ratio * (b - a);
  double d = a + ratio * (b - a);
  double at_c = value_at(c);
  double at_d = value_at(d);
  while (b - a > settings::kNoiseResolution) {
    if (at_c < at_d) {
      b = d;
      d = c;
      at_d = at_c;
      c = b - ratio * (b - a);
      at_c = value_at(c);
    } else {
      a = c;
      c = d;
      at_c = at_d;
      d = a + ratio * (b - a);
      at_d = value_at(d);
    }
  }
  const double best = value_at((a + b) / 2.0);
  if (!range.may_vanish) return;
  const double found = noise.*range.member;
  noise.*range.member = 0.0;
  // One more parameter must earn its place.
  if (misfit(o, noise) > best + settings::kNoisePresent) noise.*range.member = found;
}

/// Scale of a pair's errors in room axes.
struct Scale {
  Eigen::Vector3d deviation;  ///< without the jitter
  Eigen::Vector3d spread;     ///< with it, in units of that
};

Scale scale_of(const Observation& o, std::size_t k, const NoiseModel& noise) {
  const Eigen::Matrix3d base = base_covariance(o.pairs[k], o.states[k], noise);
  const Eigen::Vector3d variance = base.diagonal();
  return {variance.cwiseSqrt(),
          with_jitter(base, o.states[k], noise).diagonal().cwiseQuotient(variance).cwiseSqrt()};
}

std::array<double, 3> neighbour_correlation(const Observation& o, const NoiseModel& noise) {
  std::array<double, 3> products{};
  std::array<double, 3> weights{};
  Scale scale = scale_of(o, 0, noise);
  for (std::size_t k = 1; k < o.pairs.size(); ++k) {
    const Scale scale_before = std::exchange(scale, scale_of(o, k, noise));
    if (!o.pairs[k].follows_previous) continue;
    const Eigen::Vector3d before = o.residuals[k - 1].cwiseQuotient(scale_before.deviation);
    const Eigen::Vector3d here = o.residuals[k].cwiseQuotient(scale.deviation);
    const Eigen::Vector3d &spread_before = scale_before.spread, &spread_here = scale.spread;
    const Eigen::Vector3d& velocity = o.states[k].begin_velocity;
    const Eigen::Vector3d jitter_before = noise.stamp_jitter * velocity.cwiseQuotient(scale_before.deviation);
    const Eigen::Vector3d jitter_here = noise.stamp_jitter * velocity.cwiseQuotient(scale.deviation);
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double weight = 1.0 / (spread_before(c) * spread_here(c));
      const double a =
          std::clamp(before(c), -settings::kWinsor * spread_before(c), settings::kWinsor * spread_before(c));
      const double b =
          std::clamp(here(c), -settings::kWinsor * spread_here(c), settings::kWinsor * spread_here(c));
      products[static_cast<std::size_t>(c)] += weight * (a * b + jitter_before(c) * jitter_here(c));
      weights[static_cast<std::size_t>(c)] += weight;
    }
  }
  std::array<double, 3> correlation{};
  for (std::size_t c = 0; c < 3; ++c)
    if (weights[c] > 0.0)
      correlation[c] =
          std::clamp(products[c] / weights[c], settings::kLeastCorrelation, settings::kMostCorrelation);
  return correlation;
}

/// Median residual size of whole motions, where there are any: along an open direction the residual is none.
double median_magnitude(const Observation& o, std::initializer_list<Eigen::Index> axes) {
  const bool has_whole =
      std::any_of(o.pairs.begin(), o.pairs.end(), [](const SensorPair& pair) { return !pair.is_partial; });
  std::vector<double> magnitudes;
  for (std::size_t k = 0; k < o.pairs.size(); ++k)
    for (const Eigen::Index axis : axes)
      if (!has_whole || !o.pairs[k].is_partial) magnitudes.push_back(std::abs(o.residuals[k](axis)));
  return math::median_of(std::move(magnitudes));
}

/// The heavy-tailed likelihood is flat far from the truth: the search begins where all spread is process
/// noise.
void begin_at_spread(const Observation& o, NoiseModel& noise) {
  noise.process_translation = math::kMadToSigma * median_magnitude(o, {0, 1});
  noise.process_rotation = math::kMadToSigma * median_magnitude(o, {2});
  noise.stamp_jitter = 0.0;
  noise.matcher_scale = 1.0;
}

Observation observe(std::span<const SensorPair> pairs, std::span<const PairState> states,
                    std::span<const Eigen::Vector3d> residuals) {
  Observation o{pairs, states, {}};
  for (std::size_t k = 0; k < pairs.size(); ++k) o.residuals.push_back(to_room(residuals[k], states[k]));
  return o;
}

}  // namespace

NoiseModel estimate_noise(std::span<const SensorPair> pairs, std::span<const PairState> states,
                          std::span<const Eigen::Vector3d> residuals, const NoiseModel& start) {
  const Observation o = observe(pairs, states, residuals);
  NoiseModel noise = start;
  if (pairs.empty()) return noise;
  begin_at_spread(o, noise);
  const Columns columns = columns_of(o);
  for (int sweep = 0; sweep < settings::kNoiseSweeps; ++sweep)
    for (const Range& range : kRanges) improve_noise(columns, range, noise);
  noise.correlation = neighbour_correlation(o, noise);
  return noise;
}

std::vector<double> squared_distances(std::span<const SensorPair> pairs, std::span<const PairState> states,
                                      std::span<const Eigen::Vector3d> residuals, const NoiseModel& noise) {
  std::vector<double> distances;
  distances.reserve(pairs.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Eigen::LLT<Eigen::Matrix3d> llt(full_covariance(pairs[k], states[k], noise));
    distances.push_back(llt.matrixL().solve(to_room(residuals[k], states[k])).squaredNorm());
  }
  return distances;
}

}  // namespace odomcalib::calib::measurement
