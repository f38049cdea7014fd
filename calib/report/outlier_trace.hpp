// Pairs of scans that no model in the search explains: a fit leaves them out, so that no score sees them.
// Their common features say what the robot, the floor or a clock did there.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/vehicle/channel.hpp"
#include "proto/calibration/members.hpp"

namespace odomcalib::calib::report {

/// Whether pairs that a fit leaves out are failed matches or motion that the wheels know nothing of: a map of
/// the whole recording knows where their scans were taken.
struct OutlierCause {
  std::size_t placed = 0;     ///< outliers of which the map knows both scans
  std::size_t confirmed = 0;  ///< of these, matches that the map confirms against the wheels
  /// Mean of what the robot came and turned farther than its wheels did in the confirmed ones, the way they
  /// went, m and rad; 0 where either sign may be by chance.
  double farther = 0.0;
  double turned_farther = 0.0;
};

OutlierCause cause_of_outliers(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                               const estimation::FitResult& fit);

struct OutlierTrace {
  std::size_t outliers = 0;  ///< pairs beyond the limit of a fit
  std::size_t pairs = 0;     ///< all
  std::vector<vehicle::Covariate>
      depends_on;                 ///< that single out these pairs, the best first; empty: none does
  double p_value = 1.0;           ///< of the best of all covariates, by permutation
  double begin = 0.0, end = 0.0;  ///< s, of what goes with time: when
  OutlierCause cause;             ///< filled by cause_of_outliers, where scans lie in a map
  bool of_poses = false;          ///< the reference, not of scans
};

/// nullopt when so few pairs are left out that noise and single bad matches account for them. Neighbours
/// share a scan, so that of two outliers in a row one counts.
std::optional<OutlierTrace> trace_outliers(std::span<const measurement::FitData> data,
                                           const estimation::FitResult& fit);

/// One sentence for a person.
std::string to_text(const OutlierTrace& trace);
/// As the calibration file has it.
OutlierReport entry_of(const OutlierTrace& trace);

}  // namespace odomcalib::calib::report
