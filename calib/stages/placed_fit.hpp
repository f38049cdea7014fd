// Use of the places of all scans in a map for a fit.
#pragma once

#include "calib/estimation/fit.hpp"
#include "calib/measurement/placement.hpp"
#include "calib/selection/rules.hpp"
#include "calib/selection/search_result.hpp"

namespace odomcalib::calib::stages {

/// Whether errors of the ranges are looked for while scans are placed.
enum class Ranges { believed, traced };

/// @param rules by which errors of the ranges are looked for
measurement::Placement place_every_scan(const estimation::Fit& fit, const measurement::Progress& progress,
                                        Ranges ranges = Ranges::believed,
                                        const selection::RuleSet& rules = {});

/// The one that is known, where it is of the fit's scans, or else a new one.
measurement::Placement placement_of(const estimation::Fit& fit, measurement::Placement known,
                                    const measurement::Progress& progress);

/// From here on effects of the floor know the place, and matches that slide are replaced by places. What
/// depends on either is fitted once more.
/// @param placement of the fit's scans
/// @return a fit that failed as it is
estimation::Fit locate(estimation::Fit fit, const measurement::Placement& placement);

struct RefinedResult {
  selection::SearchResult found;
  bool every_scan_placed = false;  ///< the parameters come from the whole path, not from matches of keyframes
};

/// The same parameters from every scan instead of keyframes. Places are used where they confirm the
/// matches and know better: a map may be wrong as a whole.
/// @param dataset that the result was fitted to
RefinedResult fit_to_every_scan(selection::SearchResult found, const measurement::Dataset& dataset,
                                measurement::Placement placement, const measurement::Progress& progress);

}  // namespace odomcalib::calib::stages
