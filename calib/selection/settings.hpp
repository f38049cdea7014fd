// Numbers that decide what is added to the model, each once, with its unit and its origin (see
// calib/matching/settings.hpp).
#pragma once

#include <array>
#include <cstddef>

namespace odomcalib::calib::selection::settings {

// --- Significance ----------------------------------------------------------------------------------------

/// Random draws of signs; the finest family-wise p-value is 1 / (1 + draws). Chosen, insensitive.
inline constexpr int kSignDraws = 1999;
/// Bonferroni's bound below which no draws are needed. Chosen: far below any level used.
inline constexpr double kDecisive = 1e-12;
/// Family-wise level of named effects, and of smooth terms where the reference is too broken to show a gain.
/// Chosen: a nominal 1 % test exceeds 1 % of robots in many campaigns. With kSignDraws no draw may be above.
inline constexpr double kNamedLevel = 0.0009;
/// Family-wise level of smooth terms. Chosen; with kSignDraws at most four draws may be above.
inline constexpr double kUnnamedLevel = 0.0025;
/// Family-wise level of clock effects. Chosen: a delay hardly shows in odometry and cannot spoil it.
inline constexpr double kClockLevel = 0.003;
/// Family-wise level at which the data outside a fold must point to a candidate that all data have chosen.
/// Chosen, insensitive.
inline constexpr double kFoldLevel = 0.05;

// --- Gain on held-out data -------------------------------------------------------------------------------

/// Ratio of errors above which, beyond its 95 % interval, a recording is spoilt. Chosen, sensitive.
inline constexpr double kTolerated = 1.05;
/// Evaluation windows; fewer say nothing. Chosen, sensitive.
inline constexpr std::size_t kFewestWindows = 10;
/// Share of the squared open-loop error beyond noise that smooth terms without a name must explain together.
/// Derived: what explains less leaves more unexplained than it explains.
inline constexpr double kLeastExplained = 0.5;

// --- Detectable ------------------------------------------------------------------------------------------

/// Two-sided test at kNamedLevel among about a hundred candidates that are not alike, and nine of ten
/// found. Chosen, sensitive.
inline constexpr double kDetectableQuantiles = 4.4 + 1.28;

// --- Equivalent models -----------------------------------------------------------------------------------

/// Expected gap of -2 log L that separates two candidates. Chosen, insensitive.
inline constexpr double kSeparable = 10.0;
/// Share of a smooth term's statistic that one of another covariate explains when either may be meant.
/// Chosen, insensitive.
inline constexpr double kMostOfStatistic = 0.6;
/// Canonical correlation that counts as indistinguishable. Chosen, insensitive.
inline constexpr double kAlias = 0.9;

// --- Fitted model ----------------------------------------------------------------------------------------

/// 95 % quantile of chi-squared with three degrees of freedom. Derived.
inline constexpr double kChiSquared95Of3 = 7.815;
/// Factor on the noise from which it is widened. Chosen, insensitive.
inline constexpr double kToleratedExcess = 1.3;

// --- Hyperparameter selection ----------------------------------------------------------------------------

/// Share of all that a function spans from which a rise or fall counts as a bend. Chosen, insensitive.
inline constexpr double kPlainBend = 0.25;
/// Bends of a function. Chosen: a peak or a step has fewer.
inline constexpr int kMostBends = 3;
/// Rounds in which hyperparameters and noise settle each other. Chosen, insensitive.
inline constexpr int kShapeRounds = 3;
/// Decrease of -2 log L that a parameter needs when what it belongs to has passed cross-validation.
/// Published: Akaike, IEEE Trans. Autom. Control 19, 1974.
inline constexpr double kAkaike = 2.0;

// --- Change point -----------------------------------------------------------------------------------------

/// Moments tried to either side of the best in a round, and rounds, each with steps as many times smaller.
/// Chosen, sensitive.
inline constexpr int kMomentsEachWay = 2, kMomentRounds = 4;

// --- Hyperparameters -------------------------------------------------------------------------------------

/// Share of the motion in which an effect is absent, or of the other sign, when zero is known. Chosen,
/// insensitive.
inline constexpr double kQuietShare = 0.1;

// --- Lidar score -----------------------------------------------------------------------------------------

/// Least share of a direction's signature that poses must leave. Chosen, insensitive.
inline constexpr double kVisible = 1e-3;

// --- Lidar trace -----------------------------------------------------------------------------------------

/// Sign flips of fewer cannot be significant. Chosen, insensitive.
inline constexpr std::size_t kFewestHeadingPairs = 25;
/// Terms of the lidar. Chosen, insensitive.
inline constexpr std::size_t kMostLidarFindings = 2;
/// Family-wise level of terms of the lidar. Chosen, insensitive.
inline constexpr double kLidarLevel = 0.001;

// --- Plausibility ----------------------------------------------------------------------------------------

/// Share of a bound from which a prior holds a size back. Chosen, sensitive.
inline constexpr double kNearBound = 0.6;
/// Times what ticks hide that a sway has to be. Chosen, insensitive.
inline constexpr double kAboveTicks = 2.0;
/// Deviation of a length, relative, that spoils nothing: a millimetre in a metre. Chosen, insensitive.
inline constexpr double kNegligibleLengthStd = 1e-3;
/// Share of a length by which a smooth term may not move it. Chosen, insensitive.
inline constexpr double kMaxLengthShift = 0.25;
/// Level of the Wald test of a term that is still needed. Chosen: the usual 5 %.
inline constexpr double kNeededLevel = 0.05;
/// Times a length's deviation without the term, above which the term spoils the length: a term that
/// nothing can correct, and any other. Chosen, insensitive.
inline constexpr double kWidenedByNowhere = 10.0, kWidenedByCorrection = 3.0;

// --- Range scale -----------------------------------------------------------------------------------------

/// Scans of a recording, evenly, in which the lengths of the ranges are looked at. Chosen, insensitive.
inline constexpr std::size_t kScansOfScale = 50;
/// Share of a range over which its error's slope is taken, to either side. Chosen, insensitive.
inline constexpr double kHalfStep = 0.05;

// --- Range trace -----------------------------------------------------------------------------------------

/// Readings that no longer seem outliers show some more of the error. Chosen, insensitive.
inline constexpr int kRangePasses = 4;
/// m, change of an error of the ranges that no longer matters. Chosen, insensitive.
inline constexpr double kRangeSettled_m = 1e-4;
/// Standard deviations of the mean gain on scans that were not used. Chosen, insensitive.
inline constexpr double kHeldOutZ = 2.5;

// --- Rolling waves ---------------------------------------------------------------------------------------

/// m; less than a pair of scans is long. Chosen, insensitive.
inline constexpr double kShortestRolling_m = 0.2;
/// m; what changes slower may be anything. Chosen, insensitive.
inline constexpr double kLongestRolling_m = 1.5;
/// Cycles over the whole way between two waves that are tried. Derived: half the resolution of a Fourier
/// transform.
inline constexpr double kRollingStep = 0.5;
/// Waves tried; the shortest are left out where there would be more. Chosen: time.
inline constexpr double kMostRolling = 3000;
/// Steps of kRollingStep, between waves that are tried about the best. Chosen, insensitive.
inline constexpr double kFineRollingStep = 0.1;
/// Waves that count as tried for each step of kRollingStep. Chosen, insensitive.
inline constexpr double kTriedPerRollingStep = 3.0;
/// Probability of a peak as high anywhere, in noise. Chosen, insensitive.
inline constexpr double kDecisivePeak = 1e-4;

// --- Search ----------------------------------------------------------------------------------------------

/// Share of the pairs that a usual effect does not touch much. Chosen, insensitive.
inline constexpr double kNoiseShare = 0.95;
/// Named terms. Chosen, insensitive.
inline constexpr std::size_t kMostFindings = 3;
/// Smooth terms without a name. Chosen, insensitive.
inline constexpr std::size_t kMostSmooths = 4;
/// Additions and candidates that failed cross-validation, together. Chosen: time.
inline constexpr int kMostSteps = 12;
/// Gauss-Newton steps of a fit. Chosen, insensitive.
inline constexpr int kMostSearchIterations = 24;
/// Share of what a name explains from which a small delay explains it as well. Chosen, insensitive.
inline constexpr double kClockShareOfName = 0.9;

// --- Search round ----------------------------------------------------------------------------------------

/// Units of BIC within which two candidates may both be meant. Chosen; 6 to 10 are called strong evidence
/// by Kass and Raftery, J. Am. Stat. Assoc. 90, 1995.
inline constexpr double kAmbiguity = 6.0;
/// Share of a smooth term's statistic that a name with that dependence must reach. Chosen, sensitive.
inline constexpr double kSameDependence = 0.5;
/// Candidates refitted jointly per step. Chosen, insensitive.
inline constexpr std::size_t kRefits = 4;
/// Share of what a freer term explains with which a name is certain. Chosen, sensitive.
inline constexpr double kNameShareOfSmooth = 0.9;

}  // namespace odomcalib::calib::selection::settings
