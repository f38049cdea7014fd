// Whether pairs that a fit leaves out are failed matches or motion that the wheels know nothing of: a map of
// the whole recording knows where their scans were taken.
#pragma once

#include <cstddef>
#include <span>

#include "calib/estimation/joint.hpp"

namespace odomcalib::calib::report {

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

}  // namespace odomcalib::calib::report
