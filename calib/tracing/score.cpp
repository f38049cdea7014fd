#include "calib/tracing/score.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

namespace odomcalib::calib {
namespace {

constexpr double kBlockSeconds = 5.0;
constexpr int kDraws = 1999;
constexpr unsigned kSeed = 20210601;
constexpr double kClip = 3.5;    ///< sigma; one bad match must not decide
constexpr double kGauge = 1e-6;  ///< share of a signature that counts as fully absorbed
constexpr double kRidge = 1e-9;

/// First whitened row of each block of kBlockSeconds, and the end.
std::vector<Eigen::Index> block_borders(std::span<const FitData> data) {
  std::vector<Eigen::Index> borders;
  Eigen::Index row = 0;
  for (const FitData& d : data) {
    double begin = -1e300;
    for (const SensorPair& pair : d.pairs) {
      if (pair.interval.begin > begin + kBlockSeconds) {
        borders.push_back(row);
        begin = pair.interval.begin;
      }
      row += 3;
    }
  }
  borders.push_back(row);
  return borders;
}

/// Columns of each candidate, made for as many at a time as one sweep of automatic derivatives carries.
std::vector<Eigen::MatrixXd> candidate_columns(std::span<const FitData> data, const EffectList& effects,
                                               const FitResult& fit, const EffectList& candidates) {
  std::vector<Eigen::MatrixXd> columns;
  for (std::size_t first = 0; first < candidates.size();) {
    EffectList sweep;
    std::size_t parameters = 0;
    for (std::size_t k = first; k < candidates.size(); ++k) {
      parameters += candidates[k]->parameters().size();
      if (parameters > kJetSize && !sweep.empty()) break;
      sweep.push_back(candidates[k]);
    }
    const Eigen::MatrixXd all = whitened_columns(data, effects, fit, sweep);
    Eigen::Index column = 0;
    for (const auto& candidate : sweep) {
      const auto size = static_cast<Eigen::Index>(candidate->parameters().size());
      columns.emplace_back(all.middleCols(column, size));
      column += size;
    }
    first += sweep.size();
  }
  return columns;
}

/// Orthonormal basis of the candidate's columns after projection; rank-deficient directions are left out.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns, double scale) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  Eigen::Index rank = 0;
  const auto& r = qr.matrixR();
  while (rank < columns.cols() && std::abs(r(rank, rank)) > std::sqrt(kGauge) * scale) ++rank;
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), rank);
}

/// Sums of rows within blocks: column b holds basis^T r of block b.
Eigen::MatrixXd block_scores(const Eigen::MatrixXd& basis, const Eigen::VectorXd& residual,
                             const std::vector<Eigen::Index>& borders) {
  Eigen::MatrixXd scores(basis.cols(), static_cast<Eigen::Index>(borders.size()) - 1);
  for (std::size_t b = 0; b + 1 < borders.size(); ++b) {
    const Eigen::Index rows = borders[b + 1] - borders[b];
    scores.col(static_cast<Eigen::Index>(b)) =
        basis.middleRows(borders[b], rows).transpose() * residual.segment(borders[b], rows);
  }
  return scores;
}

/// -log10 of the tail probability, finite for any statistic.
double significance(double statistic, Eigen::Index degrees) {
  return -std::log10(std::max(chi_squared_tail(statistic, static_cast<std::size_t>(degrees)), 1e-300));
}

std::vector<double> largest_of_draws(const std::vector<Eigen::MatrixXd>& scores, double variance) {
  std::mt19937 engine(kSeed);
  std::vector<double> largest;
  largest.reserve(kDraws);
  const Eigen::Index blocks = scores.empty() ? 0 : scores.front().cols();
  Eigen::VectorXd signs(blocks);
  for (int draw = 0; draw < kDraws; ++draw) {
    for (Eigen::Index b = 0; b < blocks; ++b) signs(b) = (engine() & 1U) != 0U ? 1.0 : -1.0;
    double best = 0.0;
    for (const Eigen::MatrixXd& s : scores)
      if (s.rows() > 0) best = std::max(best, significance((s * signs).squaredNorm() / variance, s.rows()));
    largest.push_back(best);
  }
  std::sort(largest.begin(), largest.end());
  return largest;
}

/// Regularised lower incomplete gamma by series, upper by continued fraction (Abramowitz and
/// Stegun 6.5.29, 6.5.31).
double upper_gamma(double a, double x) {
  if (x <= 0.0) return 1.0;
  const double front = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a;
    double sum = term;
    for (int n = 1; n < 500 && term > sum * 1e-16; ++n) sum += term *= x / (a + n);
    return 1.0 - front * sum;
  }
  double b = x + 1.0 - a;
  double c = 1e300;
  double d = 1.0 / b;
  double h = d;
  for (int n = 1; n < 500; ++n) {
    const double an = -n * (n - a);
    b += 2.0;
    d = 1.0 / (an * d + b);
    c = b + an / c;
    const double delta = d * c;
    h *= delta;
    if (std::abs(delta - 1.0) < 1e-15) break;
  }
  return front * h;
}

}  // namespace

double chi_squared_tail(double statistic, std::size_t degrees) {
  if (degrees == 0) return 1.0;
  return upper_gamma(static_cast<double>(degrees) / 2.0, statistic / 2.0);
}

ScoreTable score_candidates(std::span<const FitData> data, const EffectList& effects, const FitResult& fit,
                            const std::vector<bool>& fixed, const EffectList& candidates) {
  ScoreTable table;
  Eigen::MatrixXd fitted = fit.whitened_jacobian;
  for (Eigen::Index k = 0; k < fitted.cols(); ++k) {
    if (fixed[static_cast<std::size_t>(k)]) fitted.col(k).setZero();
    const double norm = fitted.col(k).norm();
    if (norm > 0.0) fitted.col(k) /= norm;
  }
  const Eigen::MatrixXd normal =
      fitted.transpose() * fitted + kRidge * Eigen::MatrixXd::Identity(fitted.cols(), fitted.cols());
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(normal);
  const Eigen::VectorXd residual = fit.whitened_residual.cwiseMax(-kClip).cwiseMin(kClip);
  const double variance = residual.squaredNorm() / std::max(static_cast<double>(residual.size()), 1.0);
  const auto borders = block_borders(data);

  std::vector<Eigen::MatrixXd> bases;
  std::vector<Eigen::MatrixXd> scores;
  for (const Eigen::MatrixXd& raw : candidate_columns(data, effects, fit, candidates)) {
    const Eigen::MatrixXd projected = raw - fitted * ldlt.solve(fitted.transpose() * raw);
    const double scale = raw.norm();
    bases.push_back(scale > 0.0 ? orthonormal(projected, scale) : Eigen::MatrixXd(raw.rows(), 0));
    scores.push_back(block_scores(bases.back(), residual, borders));
    Score score;
    score.candidate = table.scores.size();
    score.degrees = static_cast<std::size_t>(bases.back().cols());
    score.statistic = scores.back().rowwise().sum().squaredNorm() / variance;
    score.p_value = chi_squared_tail(score.statistic, score.degrees);
    score.unabsorbed = scale > 0.0 ? projected.squaredNorm() / raw.squaredNorm() : 0.0;
    table.scores.push_back(score);
  }
  const auto largest = largest_of_draws(scores, variance);
  for (Score& score : table.scores) {
    const double own = significance(score.statistic, static_cast<Eigen::Index>(score.degrees));
    const auto above = largest.end() - std::lower_bound(largest.begin(), largest.end(), own);
    score.family_p_value = (1.0 + static_cast<double>(above)) / (1.0 + kDraws);
  }
  const auto n = static_cast<Eigen::Index>(bases.size());
  table.correlation = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const Eigen::MatrixXd overlap =
          bases[static_cast<std::size_t>(i)].transpose() * bases[static_cast<std::size_t>(j)];
      const double largest_value =
          overlap.size() == 0 ? 0.0 : Eigen::JacobiSVD<Eigen::MatrixXd>(overlap).singularValues()(0);
      table.correlation(i, j) = table.correlation(j, i) = std::min(largest_value, 1.0);
    }
  return table;
}

}  // namespace odomcalib::calib
