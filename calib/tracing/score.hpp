// Score tests: would this candidate explain part of the residual? One linear solve per candidate at the
// current fit.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "calib/estimators/joint.hpp"

namespace odomcalib::calib {

struct Score {
  std::size_t candidate = 0;  ///< index into the candidates
  double statistic =
      0.0;  ///< T ~ chi-squared with `degrees` under "nothing missing"; expected drop of -2 log L
  std::size_t degrees = 0;
  double p_value = 1.0;         ///< of this candidate alone
  double family_p_value = 1.0;  ///< of the largest among all candidates, by sign flips of blocks
  double unabsorbed = 0.0;  ///< share of the candidate's signature that the fitted parameters cannot absorb
};

struct ScoreTable {
  std::vector<Score> scores;    ///< in the order of the candidates
  Eigen::MatrixXd correlation;  ///< largest canonical correlation of each pair of projected signatures
};

/// Upper tail of the chi-squared distribution.
double chi_squared_tail(double statistic, std::size_t degrees);

/// Tests every candidate effect (at zero) on top of the fitted model.
/// Family-wise significance: block scores of 5 s get random signs (Rademacher), 1999 draws with a fixed seed;
/// the largest statistic of each draw is compared, so that correlation between candidates, heavy tails and
/// what autocorrelation is left are respected.
ScoreTable score_candidates(std::span<const FitData> data, const EffectList& effects, const FitResult& fit,
                            const std::vector<bool>& fixed, const EffectList& candidates);

}  // namespace odomcalib::calib
