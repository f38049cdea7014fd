// When one measurement or model is better than another, and when an estimate counts as present. Values only:
// what is compared is an argument. Numbers: calib/validation/settings.hpp.
#pragma once

#include <optional>
#include <span>

#include "calib/validation/held_out.hpp"

namespace odomcalib::calib::validation {

/// The held-out residual is clearly lower in all three components together: the product of the ratios of
/// their bounded RMS, where an outlier counts as what is just none, so that fewer outliers are better. False
/// when either is unknown.
bool is_clearly_better(const std::optional<HeldOut>& before, const std::optional<HeldOut>& after);

/// The held-out RMS without outliers is higher than tolerated in any one component. True when it was known
/// before and is not any more; false when it was not known before.
bool is_worse(const std::optional<HeldOut>& before, const std::optional<HeldOut>& after);

/// Probability of `after` being better by chance: likelihood ratio of normal errors with the bounded RMS of
/// each, pairs of `after` counted, against a chi-squared distribution with one degree of freedom. 1 when it
/// is not better.
double p_value_of(const HeldOut& before, const HeldOut& after);

/// One parameter; the variance in the square of the value's unit.
struct Estimate {
  double value = 0.0, variance = 0.0;
};

/// The estimate is significantly different from zero and larger than what is negligible.
bool is_plain(const Estimate& estimate, double negligible = 0.0);

/// The estimate is not significantly different from zero, or negligible.
bool is_idle(const Estimate& estimate, double negligible);

/// Where on the base a reference is mounted.
struct MountingOffset {
  Estimate x, y, yaw;  ///< m, m, rad
};

/// The motion determines all of the place, and any component of it is plain.
bool is_mounted_elsewhere(const MountingOffset& mounting);

/// The chain of matches drifts from the places in the map by more than independent errors do.
/// @param drift of the chain, standard deviations (measurement::drift_of_matches)
bool is_sliding(double drift);

/// The same parameter by two methods from the same data.
struct Comparison {
  Estimate before, after;
  bool adds_to_gain = false;  ///< a parameter for whose sake the other method is used
};

/// Both estimates agree: the square of their difference against the sum of their variances.
bool agrees(const Estimate& one, const Estimate& other);

/// All parameters agree, and those that add to the gain are better known: the logarithms of the ratios of
/// their variances, before to after, have a sum above zero. What either does not estimate (no variance) does
/// not count.
bool confirms_and_knows_better(std::span<const Comparison> parameters);

}  // namespace odomcalib::calib::validation
