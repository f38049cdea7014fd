// Score tests: would this candidate explain part of the residual? One linear solve per candidate at the
// current fit.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/selection/candidate.hpp"
#include "calib/selection/fitted_model.hpp"
#include "calib/validation/window_errors.hpp"

namespace odomcalib::calib::selection {

struct Score {
  double statistic =
      0.0;  ///< T ~ chi-squared with `degrees` under "nothing missing"; expected drop of -2 log L
  std::size_t degrees = 0;
  double p_value = 1.0;            ///< of this candidate alone
  double family_p_value = 1.0;     ///< of the largest among all candidates, by sign flips of blocks
  std::vector<double> deviations;  ///< of each parameter alone beside the fitted ones; infinite if absorbed
  double unabsorbed = 0.0;  ///< share of the candidate's signature that the fitted parameters cannot absorb
};

/// One bad match must not decide.
Eigen::VectorXd clipped(const Eigen::VectorXd& whitened);

/// Upper tail of the chi-squared distribution.
double chi_squared_tail(double statistic, std::size_t degrees);
/// -log10 of that, finite for any statistic.
double significance(double statistic, Eigen::Index degrees);

/// Score tests (Rao 1948) of every candidate, at its start, on top of the fitted model.
/// Family-wise significance: block scores of 5 s get random signs (Rademacher), 1999 draws with a fixed seed;
/// the largest significance of each draw is compared, so that correlation between candidates, heavy tails and
/// what autocorrelation is left are respected.
/// The memory kept for a candidate does not grow with its columns: of more than a thousand a few are looked
/// at again, and theirs are made again.
class ScoreTable {
 public:
  /// @param task, model must outlive the table. It keeps the candidates: the search may give one another
  /// shape meanwhile, which has no score.
  ScoreTable(const FitTask& task, const FittedModel& model, const std::vector<Candidate>& candidates);

  [[nodiscard]] const std::vector<Score>& scores() const { return scores_; }  ///< in the candidates' order
  /// Largest canonical correlation of a candidate's projected signature and that of each of the others.
  [[nodiscard]] std::vector<double> correlations(std::size_t candidate,
                                                 const std::vector<std::size_t>& others) const;
  /// Whether any of these passes the family-wise level without the data of each fold.
  [[nodiscard]] validation::FoldFlags selected_without(const std::vector<std::size_t>& candidates,
                                                       double level) const;

 private:
  void take(std::size_t candidate, const Eigen::MatrixXd& raw, const Eigen::MatrixXd& projected);
  [[nodiscard]] double family_p_value(double statistic, std::size_t degrees) const;
  /// Visits the orthonormal basis of each, 3 n x degrees, with its position in the list.
  void for_each_basis(const std::vector<std::size_t>& candidates,
                      const std::function<void(std::size_t, const Eigen::MatrixXd&)>& visit) const;

  const FitTask& task_;
  const FittedModel& model_;
  std::vector<Candidate> candidates_;
  Eigen::VectorXd residual_;
  double variance_ = 1.0;
  std::vector<Eigen::Index> borders_;          ///< first row of each block, and the end
  std::vector<std::size_t> block_folds_;       ///< fold of each block
  std::vector<Eigen::MatrixXd> block_scores_;  ///< degrees x blocks
  std::vector<double> largest_;                ///< significance of the best candidate in each draw, ascending
  std::vector<Score> scores_;
};

}  // namespace odomcalib::calib::selection
