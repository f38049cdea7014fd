// Score test of the lidar's own errors on pairs of scans: does what the two scans disagree about depend on
// bearing, range or incidence? The pose of each pair is projected out, so that only the shape of the room as
// the sensor draws it counts.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/measurement/heading_pairs.hpp"

namespace odomcalib::calib::selection {

/// Normal equations of one pair for the parameters of all candidates, free of the pair's pose.
struct PairScore {
  Eigen::VectorXd gradient;  ///< X'r
  Eigen::MatrixXd gram;      ///< X'X
  double squares = 0.0;      ///< r'r
  std::size_t points = 0;
};

/// One candidate's columns in the normal equations.
struct LidarColumns {
  terms::LidarEffectPtr effect;
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

struct LidarFit {
  Eigen::VectorXd values;  ///< of all accepted columns, in their order
  Eigen::VectorXd
      deviations;  ///< from the scatter of the pairs (sandwich), so correlated errors inside a pair count
};

class LidarScores {
 public:
  LidarScores(const std::vector<measurement::HeadingPair>& pairs,
              const std::vector<terms::LidarEffectPtr>& candidates);

  [[nodiscard]] const std::vector<LidarColumns>& candidates() const { return candidates_; }
  [[nodiscard]] std::size_t pair_count() const { return pairs_.size(); }

  /// Score of one candidate beside those already accepted.
  struct Score {
    double statistic = 0.0;  ///< chi-squared, errors that neighbouring points share taken into account
    Eigen::Index degrees = 0;
    double family_p_value = 1.0;  ///< by sign flips of pairs over all candidates not accepted
  };
  [[nodiscard]] std::vector<Score> score(const std::vector<std::size_t>& accepted) const;

  [[nodiscard]] LidarFit fit(const std::vector<std::size_t>& accepted) const;

  /// Held-out gain of adding a candidate: five folds of pairs, each predicted by the others.
  struct Gain {
    double before = 0.0, after = 0.0;  ///< m, RMS of the distances between the scans
    double z = 0.0;  ///< mean gain per pair, relative to what the pair leaves, in its standard deviations
  };
  [[nodiscard]] Gain held_out(const std::vector<std::size_t>& accepted, std::size_t candidate) const;

 private:
  /// Variance of the whitened distances that the accepted leave.
  [[nodiscard]] double variance(const std::vector<Eigen::Index>& taken) const;
  [[nodiscard]] std::vector<Eigen::Index> columns(const std::vector<std::size_t>& effects) const;

  std::vector<LidarColumns> candidates_;
  std::vector<PairScore> pairs_;
  PairScore total_;                 ///< of all pairs
  double typical_deviation_ = 0.0;  ///< m, of one distance
};

}  // namespace odomcalib::calib::selection
