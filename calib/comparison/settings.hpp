// Numbers that decide what is called a change between calibrations, each once, with its unit and its origin
// (see calib/matching/settings.hpp).
#pragma once

namespace odomcalib::calib::comparison::settings {

/// Level of the joint test of "nothing changed", of the single parameters together (Holm), of the effects
/// together (Holm), and of a slope.
/// Chosen: one false alarm in a hundred comparisons.
inline constexpr double kChangedLevel = 0.01;
/// Confidence level of intervals. Chosen: what reports state everywhere.
inline constexpr double kIntervalLevel = 0.95;
/// Share of the largest eigenvalue of a correlation matrix below which a direction counts as not measured:
/// rounding. Chosen, insensitive.
inline constexpr double kNoInformation = 1e-9;
/// Deviations of an estimate that the smallest detectable size of an effect is, or more where a smaller one
/// would not matter to odometry. Derived: kDetectableQuantiles of calib/selection/settings.hpp.
inline constexpr double kDeviationsOfDetectable = 4.4 + 1.28;

}  // namespace odomcalib::calib::comparison::settings
