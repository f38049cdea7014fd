// Whether several recordings are of one robot in one state: the parameters of each alone, and Cochran's test
// of their homogeneity with the covariance of each (W. G. Cochran, Biometrics 10, 1954).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/report/odd_recording.hpp"
#include "calib/selection/fitted_model.hpp"

namespace odomcalib::calib::report {

/// Base parameters of one recording alone: radii, track width, lidar pose; m, m, m, m, m, rad.
struct OwnEstimate {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;  ///< with the error of the recording's own metre
  double freedom = 0.0;        ///< pairs beyond the parameters: of the covariance
};

struct Homogeneity {
  /// Per recording; none where it does not determine all lengths alone, to kKnownAlone.
  std::vector<std::optional<OwnEstimate>> own;
  /// Per recording (row) and base parameter: own value less that of all others together, without those that
  /// are known to be odd, in deviations of that difference, as many as of a normal distribution are as
  /// unlikely (Student, Biometrika 6, 1908); 0 where either does not determine it.
  Eigen::MatrixXd sigmas;
  Eigen::MatrixXd differences;  ///< the same in the parameter's unit
  double p_value = 1.0;         ///< of Cochran's Q and of the largest of the sigmas, the smaller (Bonferroni)
  std::size_t recording = 0;    ///< of the largest of the sigmas
  Eigen::Index parameter = 0;
  std::optional<OddRecordings> odd;  ///< where chance does not explain the differences, at kApartLevel
  /// Variances between recordings, of each base parameter, by moments (R. DerSimonian and N. Laird,
  /// Controlled Clinical Trials 7, 1986): about their own mean, or about the value of all together where
  /// that is more; 0 where chance explains the differences.
  Eigen::VectorXd between;
};

/// @param metre relative deviation of the metre of each recording's reference
/// @param names of the recordings: of two that differ alike the later in the alphabet comes first, whatever
/// the order of the files
/// @return nullopt where fewer than two recordings determine anything alone
std::optional<Homogeneity> homogeneity(const selection::FitTask& task, const selection::FittedModel& model,
                                       double metre, const std::vector<std::string>& names);

}  // namespace odomcalib::calib::report
