// The recordings that differ from the others where several do not agree, and what differs: the fewest changes
// that explain the disagreement.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "calib/math/pooled_estimates.hpp"

namespace odomcalib::calib::report {

/// Difference of one parameter, where the parameters that are not named stay the same.
struct ParameterChange {
  Eigen::Index parameter = 0;
  double difference = 0.0;  ///< of the odd recordings less the others, in the parameter's unit
  double sigmas = 0.0;      ///< the same in its deviations
};

/// Recordings in two groups; numbers are those of the recordings.
struct OddRecordings {
  std::vector<std::size_t> odd, others;
  /// Whether the others are more than half of all and the only such group whose estimates are homogeneous.
  /// Otherwise nothing says which of the two groups is odd.
  bool is_decided = false;
  std::vector<std::size_t> neither;      ///< recordings that agree with neither group
  std::vector<ParameterChange> changes;  ///< the largest first
  std::vector<ParameterChange> as_well;  ///< others that explain the difference as well; may be empty
};

/// By what chi-squared falls with one parameter more by chance, at kApartLevel.
double price_of_change();

/// The largest group of homogeneous estimates against the rest, and the fewest parameters whose change
/// explains the rest: a further one is named where it lowers chi-squared by more than chance does at the
/// level of the test of homogeneity, and by kShareOfChange. Both wheels by the same share are one change:
/// load, or a pair of tyres.
/// @param estimates at least two, of the parameters `free`
/// @param names of all recordings: they decide what is alike otherwise, whatever the order of the files
OddRecordings odd_recordings(const std::vector<math::OwnValues>& estimates,
                             const std::vector<Eigen::Index>& free, const std::vector<std::string>& names);

}  // namespace odomcalib::calib::report
