#include "calib/selection/score.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "calib/math/linear_solve.hpp"
#include "calib/math/settings.hpp"
#include "calib/selection/candidate_columns.hpp"
#include "calib/selection/settings.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

constexpr unsigned kFlipSeed = 20210601;
constexpr double kGauge = 1e-6;  ///< share of a signature that counts as fully absorbed
constexpr double kRidge = 1e-9;

struct Blocks {
  std::vector<Eigen::Index> borders;
  std::vector<std::size_t> folds;
};

/// Blocks of kBlock_s, none across a recording or a fold.
Blocks blocks_of(std::span<const measurement::FitData> data) {
  const std::vector<std::size_t> folds = validation::folds_of(data);
  Blocks blocks;
  std::size_t k = 0;
  for (const measurement::FitData& d : data) {
    double begin = -1e300;
    for (const measurement::SensorPair& pair : d.pairs) {
      const bool other_fold = !blocks.folds.empty() && blocks.folds.back() != folds[k];
      if (pair.interval.begin > begin + math::settings::kBlock_s || other_fold) {
        blocks.borders.push_back(static_cast<Eigen::Index>(3 * k));
        blocks.folds.push_back(folds[k]);
        begin = pair.interval.begin;
      }
      ++k;
    }
  }
  blocks.borders.push_back(static_cast<Eigen::Index>(3 * k));
  return blocks;
}

/// Orthonormal basis of the candidate's columns after projection; rank-deficient directions are left out.
/// @param scale size of the columns before it
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns, double scale) {
  if (!(scale > 0.0)) return {columns.rows(), 0};
  return math::orthonormal_basis(columns, std::sqrt(kGauge) * scale);
}

/// Sums of rows within blocks: column b holds basis^T r of block b.
Eigen::MatrixXd block_scores(const Eigen::MatrixXd& basis, const Eigen::VectorXd& residual,
                             const std::vector<Eigen::Index>& borders) {
  Eigen::MatrixXd scores(basis.cols(), static_cast<Eigen::Index>(borders.size()) - 1);
  if (scores.size() == 0) return scores;
  for (std::size_t b = 0; b + 1 < borders.size(); ++b) {
    const Eigen::Index rows = borders[b + 1] - borders[b];
    scores.col(static_cast<Eigen::Index>(b)) =
        basis.middleRows(borders[b], rows).transpose() * residual.segment(borders[b], rows);
  }
  return scores;
}

/// One draw of signs a column.
Eigen::MatrixXd draws_of_signs(Eigen::Index blocks) {
  std::mt19937 engine(kFlipSeed);
  Eigen::MatrixXd signs(blocks, settings::kSignDraws);
  for (Eigen::Index draw = 0; draw < signs.cols(); ++draw)
    for (Eigen::Index b = 0; b < blocks; ++b) signs(b, draw) = (engine() & 1U) != 0U ? 1.0 : -1.0;
  return signs;
}

/// Scores of candidates of equal degrees below each other, and the largest statistic of each draw among those
/// before them. Many at a time, since a product with a matrix costs a fraction of one with each vector.
class EqualDegrees {
 public:
  explicit EqualDegrees(Eigen::Index degrees) : degrees_(degrees) {}

  void add(const Eigen::MatrixXd& scores, const Eigen::MatrixXd& signs) {
    if (scores_.rows() == 0) scores_.resize(kTogether * degrees_, signs.rows());
    scores_.middleRows(degrees_ * waiting_, degrees_) = scores;
    if (++waiting_ == kTogether) judge(signs);
  }
  void judge(const Eigen::MatrixXd& signs) {
    if (best_.size() == 0) best_ = Eigen::RowVectorXd::Zero(signs.cols());
    const Eigen::MatrixXd sums = scores_.topRows(degrees_ * waiting_) * signs;
    for (Eigen::Index k = 0; k < waiting_; ++k)
      best_ = best_.cwiseMax(sums.middleRows(degrees_ * k, degrees_).colwise().squaredNorm());
    waiting_ = 0;
  }
  /// Squared sum of scores of each draw.
  [[nodiscard]] const Eigen::RowVectorXd& best() const { return best_; }

 private:
  static constexpr Eigen::Index kTogether = 64;
  Eigen::Index degrees_, waiting_ = 0;
  Eigen::MatrixXd scores_;
  Eigen::RowVectorXd best_;
};

/// The largest significance over all candidates of each draw of signs. Candidates of equal degrees are
/// compared by their statistic, which spares most of the tail probabilities.
std::vector<double> largest_of_draws(const std::vector<Eigen::MatrixXd>& scores, double variance) {
  const Eigen::MatrixXd signs = draws_of_signs(scores.empty() ? 0 : scores.front().cols());
  std::map<Eigen::Index, EqualDegrees> by_degrees;
  for (const Eigen::MatrixXd& s : scores)
    if (s.rows() > 0) by_degrees.try_emplace(s.rows(), s.rows()).first->second.add(s, signs);
  for (auto& [degrees, candidates] : by_degrees) candidates.judge(signs);
  std::vector<double> largest(settings::kSignDraws, 0.0);
  for (std::size_t draw = 0; draw < largest.size(); ++draw)
    for (const auto& [degrees, candidates] : by_degrees)
      largest[draw] =
          std::max(largest[draw],
                   significance(candidates.best()(static_cast<Eigen::Index>(draw)) / variance, degrees));
  std::sort(largest.begin(), largest.end());
  return largest;
}

/// The fit's own columns, normalised; projecting on what they leave is one solve per candidate.
class Projection {
 public:
  Projection(const estimation::FitResult& fit, const std::vector<bool>& fixed)
      : fitted_(fit.whitened_jacobian) {
    for (Eigen::Index k = 0; k < fitted_.cols(); ++k) {
      if (fixed[static_cast<std::size_t>(k)]) fitted_.col(k).setZero();
      const double norm = fitted_.col(k).norm();
      if (norm > 0.0) fitted_.col(k) /= norm;
    }
    ldlt_.compute(fitted_.transpose() * fitted_ +
                  kRidge * Eigen::MatrixXd::Identity(fitted_.cols(), fitted_.cols()));
  }
  [[nodiscard]] Eigen::MatrixXd rest(const Eigen::MatrixXd& columns) const {
    return columns - fitted_ * ldlt_.solve(fitted_.transpose() * columns);
  }

 private:
  Eigen::MatrixXd fitted_;
  Eigen::LDLT<Eigen::MatrixXd> ldlt_;
};

}  // namespace

Eigen::VectorXd clipped(const Eigen::VectorXd& whitened) {
  return whitened.cwiseMax(-validation::settings::kClip).cwiseMin(validation::settings::kClip);
}

double chi_squared_tail(double statistic, std::size_t degrees) {
  if (degrees == 0 || !(statistic > 0.0)) return 1.0;
  return boost::math::gamma_q(static_cast<double>(degrees) / 2.0, std::min(statistic, 1e6) / 2.0);
}

double significance(double statistic, Eigen::Index degrees) {
  return -std::log10(std::max(chi_squared_tail(statistic, static_cast<std::size_t>(degrees)), 1e-300));
}

ScoreTable::ScoreTable(const FitTask& task, const FittedModel& model,
                       const std::vector<Candidate>& candidates)
    : task_(task),
      model_(model),
      candidates_(candidates),
      residual_(clipped(model.fit.whitened_residual)),
      block_scores_(candidates.size()),
      scores_(candidates.size()) {
  variance_ = residual_.squaredNorm() / std::max(static_cast<double>(residual_.size()), 1.0);
  Blocks blocks = blocks_of(task.data);
  borders_ = std::move(blocks.borders);
  block_folds_ = std::move(blocks.folds);
  const Projection projection(model.fit, task.fixed(model.effects));
  for_each_candidate(task.data, model.effects, model.fit, candidates,
                     [&](std::size_t k, const Eigen::MatrixXd& raw) { take(k, raw, projection.rest(raw)); });
  largest_ = largest_of_draws(block_scores_, variance_);
  for (Score& score : scores_) score.family_p_value = family_p_value(score.statistic, score.degrees);
}

void ScoreTable::take(std::size_t candidate, const Eigen::MatrixXd& raw, const Eigen::MatrixXd& projected) {
  const double scale = raw.norm();
  const Eigen::MatrixXd basis = orthonormal(projected, scale);
  block_scores_[candidate] = block_scores(basis, residual_, borders_);
  Score& score = scores_[candidate];
  score.degrees = static_cast<std::size_t>(basis.cols());
  score.statistic = block_scores_[candidate].rowwise().sum().squaredNorm() / variance_;
  score.p_value = chi_squared_tail(score.statistic, score.degrees);
  for (Eigen::Index k = 0; k < raw.cols(); ++k) {
    const double left = projected.col(k).squaredNorm();
    score.deviations.push_back(left > kGauge * raw.col(k).squaredNorm()
                                   ? std::sqrt(variance_ / left)
                                   : std::numeric_limits<double>::infinity());
  }
  score.unabsorbed = scale > 0.0 ? projected.squaredNorm() / raw.squaredNorm() : 0.0;
}

double ScoreTable::family_p_value(double statistic, std::size_t degrees) const {
  const double own = significance(statistic, static_cast<Eigen::Index>(degrees));
  // Random signs keep the size of block scores, so that beside a large effect every draw is large and the
  // effect itself hardly stands out. Bonferroni's bound on the model's tail probability, far beyond any
  // doubt, needs no draws.
  const double bound = chi_squared_tail(statistic, degrees) * static_cast<double>(block_scores_.size());
  if (bound < settings::kDecisive) return 1.0 / (1.0 + settings::kSignDraws);
  const auto above = largest_.end() - std::lower_bound(largest_.begin(), largest_.end(), own);
  return (1.0 + static_cast<double>(above)) / (1.0 + settings::kSignDraws);
}

void ScoreTable::for_each_basis(const std::vector<std::size_t>& candidates,
                                const std::function<void(std::size_t, const Eigen::MatrixXd&)>& visit) const {
  if (candidates.empty()) return;
  std::vector<Candidate> wanted;
  wanted.reserve(candidates.size());
  for (const std::size_t k : candidates) wanted.push_back(candidates_[k]);
  const Projection projection(model_.fit, task_.fixed(model_.effects));
  for_each_candidate(task_.data, model_.effects, model_.fit, wanted,
                     [&](std::size_t position, const Eigen::MatrixXd& raw) {
                       visit(position, orthonormal(projection.rest(raw), raw.norm()));
                     });
}

std::vector<double> ScoreTable::correlations(std::size_t candidate,
                                             const std::vector<std::size_t>& others) const {
  if (others.empty()) return {};
  Eigen::MatrixXd own;
  for_each_basis({candidate}, [&](std::size_t, const Eigen::MatrixXd& basis) { own = basis; });
  std::vector<double> found(others.size());
  for_each_basis(others, [&](std::size_t position, const Eigen::MatrixXd& basis) {
    const Eigen::MatrixXd overlap = own.transpose() * basis;
    if (overlap.size() == 0) return;
    found[position] = std::min(math::singular_values(overlap)(0), 1.0);
  });
  return found;
}

validation::FoldFlags ScoreTable::selected_without(const std::vector<std::size_t>& candidates,
                                                   double level) const {
  validation::FoldFlags selected{};
  for_each_basis(candidates, [&](std::size_t position, const Eigen::MatrixXd& basis) {
    if (basis.size() == 0) return;
    const std::size_t candidate = candidates[position];
    for (std::size_t fold = 0; fold < validation::kFolds; ++fold) {
      Eigen::VectorXd score = Eigen::VectorXd::Zero(basis.cols());
      Eigen::MatrixXd gram = kRidge * Eigen::MatrixXd::Identity(basis.cols(), basis.cols());
      for (std::size_t b = 0; b + 1 < borders_.size(); ++b) {
        if (block_folds_[b] == fold) continue;
        const auto rows = basis.middleRows(borders_[b], borders_[b + 1] - borders_[b]);
        score += block_scores_[candidate].col(static_cast<Eigen::Index>(b));
        gram.noalias() += rows.transpose() * rows;
      }
      const double statistic = score.dot(math::solve_symmetric(gram, score)) / variance_;
      selected[fold] |= family_p_value(statistic, scores_[candidate].degrees) <= level;
    }
  });
  return selected;
}

}  // namespace odomcalib::calib::selection
