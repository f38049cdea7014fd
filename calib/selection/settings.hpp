// Numbers that decide what is added to the model, each once, with its unit and its origin. An origin is one
// of: derived (from what), published (source), measured (where), chosen (for the reason that is given; where
// none is given, no comparison with other values is known).
#pragma once

#include <array>
#include <cstddef>

namespace odomcalib::calib::selection::settings {

// --- Parts of a recording that are drawn, left out or given a sign together --------------------------------

/// s, of pairs that get one sign in the score test. Chosen.
inline constexpr double kScoreBlock_s = 5.0;
/// s, of pairs whose held-out gain is resampled together. Chosen.
inline constexpr double kGainBlock_s = 10.0;
/// s, of pairs that belong to one fold. Chosen.
inline constexpr double kFoldBlock_s = 20.0;
/// s, of evaluation windows that are resampled together. Chosen.
inline constexpr double kWindowBlock_s = 30.0;
/// Parts of a recording that are left out in turn. Chosen.
inline constexpr std::size_t kFolds = 5;

// --- Robustness ------------------------------------------------------------------------------------------

/// Standard deviations at which a whitened residual is cut, so that one bad match does not decide. Chosen.
inline constexpr double kClip = 3.5;
/// Robust weight from which a pair counts in evaluation windows and in pictures. Chosen.
inline constexpr double kTrustedWeight = 0.3;

// --- Significance ----------------------------------------------------------------------------------------

/// Random draws of signs; the finest family-wise p-value is 1 / (1 + draws). Chosen.
inline constexpr int kSignDraws = 1999;
/// Bonferroni's bound below which no draws are needed. Chosen: far below any level used.
inline constexpr double kDecisive = 1e-12;
/// Family-wise level of named effects, and of smooth terms that must be worthwhile. Chosen: a nominal 1 %
/// test exceeds 1 % of robots in many campaigns. With kSignDraws no draw may be above.
inline constexpr double kNamedLevel = 0.0009;
/// Family-wise level of any other smooth term. Chosen; with kSignDraws at most four draws may be above.
inline constexpr double kUnnamedLevel = 0.0025;
/// Family-wise level of clock effects. Chosen: a delay hardly shows in odometry and cannot spoil it.
inline constexpr double kClockLevel = 0.003;
/// Family-wise level at which the data outside a fold must point to a candidate that all data have chosen.
/// Chosen.
inline constexpr double kFoldLevel = 0.05;

// --- Gain on held-out data -------------------------------------------------------------------------------

/// Largest share of the open-loop error that a candidate may leave where scan matching, or the place in a
/// scripted drive, has a bias of its own. Chosen: less is not worth a model.
inline constexpr double kWorthwhile = 0.95;
/// The same for any other smooth term that odometry uses. Chosen.
inline constexpr double kUseful = 0.97;
/// Ratio of errors above which, beyond its 95 % interval, a recording is spoilt. Chosen.
inline constexpr double kTolerated = 1.05;
/// Evaluation windows; fewer say nothing. Chosen.
inline constexpr std::size_t kFewestWindows = 10;
/// Deviations by which the logarithm of a ratio of errors must lie below zero where the interval does not
/// tell. Derived: 90 % quantile of the normal distribution, one side. The level is chosen.
inline constexpr double kPlainGain = 1.282;
/// Share of the squared open-loop error beyond noise that smooth terms without a name must explain together.
/// Derived: what explains less leaves more unexplained than it explains.
inline constexpr double kLeastExplained = 0.5;

// --- Comparisons of measurements and models (criterion.hpp) -----------------------------------------------

/// Product of the three ratios of bounded held-out RMS, after to before, of what is clearly better. Chosen: 5
/// % in all.
inline constexpr double kClearlyBetter = 0.95;
/// Ratio of held-out RMS, after to before, in any one component. Chosen: 5 % is left to chance.
inline constexpr double kToleratedRms = 1.05;
/// Standard deviations from zero of an estimate that is present. Chosen: of normal errors 6 in 100 000 are
/// larger.
inline constexpr double kSignificance = 4.0;
/// Standard deviations of the difference within which two estimates agree. Chosen as kSignificance.
inline constexpr double kAgreement = 4.0;
/// Standard deviations that chained matches drift from the places in the map. Measured: rooms with walls
/// enough mostly stay below 1.5 (docs/developer/the-mathematics.md).
inline constexpr double kSliding = 2.0;
/// s, of a time offset that is negligible. Chosen: what a careful driver leaves.
inline constexpr double kNegligibleOffset_s = 3e-3;
/// m and rad, of the place of a reference's marker. Chosen: more than anybody measures with a tape.
inline constexpr double kNegligibleMounting_m = 5e-4, kNegligibleMounting_rad = 2e-3;
/// m and rad, largest standard deviations of a place that the motion determines. Chosen: ten times what is
/// negligible.
inline constexpr double kKnownMounting_m = 5e-3, kKnownMounting_rad = 2e-2;

// --- Detectable ------------------------------------------------------------------------------------------

/// Two-sided test at kNamedLevel among about a hundred candidates that are not alike, and nine of ten
/// found. Chosen.
inline constexpr double kDetectableQuantiles = 4.4 + 1.28;

// --- Drive error -----------------------------------------------------------------------------------------

/// Windows of a kind from which its error is reported. Chosen.
inline constexpr std::size_t kFewestOfAKind = 4;
/// Blocks from which an error's interval is drawn. Derived: of three only ten different draws exist, of one
/// only itself.
inline constexpr std::size_t kFewestBlocks = 4;
/// m, ways over which the error of the position is followed. Chosen: what a block of 20 s can hold.
inline constexpr std::array kWays_m = {0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};

// --- Equivalent models -----------------------------------------------------------------------------------

/// Expected gap of -2 log L that separates two candidates. Chosen.
inline constexpr double kSeparable = 10.0;
/// Share of a smooth term's statistic that one of another covariate explains when either may be meant.
/// Chosen.
inline constexpr double kMostOfStatistic = 0.6;
/// Canonical correlation that counts as indistinguishable. Chosen.
inline constexpr double kAlias = 0.9;

// --- Evaluation window -----------------------------------------------------------------------------------

/// s, of open-loop driving. Chosen.
inline constexpr double kHorizon_s = 10.0;
/// rad/m, of a motion that counts as straight; more is a curve. Chosen.
inline constexpr double kStraightest = 0.15;
/// m/rad, of a motion that counts as a turn on the spot; more is an arc. Chosen.
inline constexpr double kOnTheSpot = 0.08;
/// m and rad; a pair at rest belongs to any kind. Chosen.
inline constexpr double kStanding = 0.004;
/// m; on less, noise of the reference dominates. Chosen.
inline constexpr double kShortestStraight_m = 0.25;
/// rad, of a turn that is judged. Chosen.
inline constexpr double kSmallestTurn_rad = 0.6;

// --- Fitted model ----------------------------------------------------------------------------------------

/// 95 % quantile of chi-squared with three degrees of freedom. Derived.
inline constexpr double kChiSquared95Of3 = 7.815;
/// Factor on the noise from which it is widened. Chosen.
inline constexpr double kToleratedExcess = 1.3;

// --- Held out --------------------------------------------------------------------------------------------

/// Pairs from which a held-out residual is stated. Chosen.
inline constexpr std::size_t kFewestHeldOut = 50;
/// sigma; a failed match says nothing about the wheels. Chosen.
inline constexpr double kGrossError = 6.0;

// --- Homogeneity -----------------------------------------------------------------------------------------

/// Relative deviation of each length that one recording must determine alone to be compared with others.
/// Chosen.
inline constexpr double kKnownAlone = 0.02;

// --- Hyperparameter selection ----------------------------------------------------------------------------

/// Share of all that a function spans from which a rise or fall counts as a bend. Chosen.
inline constexpr double kPlainBend = 0.25;
/// Bends of a function. Chosen: a peak or a step has fewer.
inline constexpr int kMostBends = 3;
/// Rounds in which hyperparameters and noise settle each other. Chosen.
inline constexpr int kShapeRounds = 3;
/// Decrease of -2 log L that a parameter needs when what it belongs to has passed cross-validation.
/// Published: Akaike, IEEE Trans. Autom. Control 19, 1974.
inline constexpr double kAkaike = 2.0;

// --- Change point -----------------------------------------------------------------------------------------

/// Moments tried to either side of the best in a round, and rounds, each with steps as many times smaller.
/// Chosen.
inline constexpr int kMomentsEachWay = 2, kMomentRounds = 4;

// --- Hyperparameters -------------------------------------------------------------------------------------

/// Share of the motion in which an effect is absent, or of the other sign, when zero is known. Chosen.
inline constexpr double kQuietShare = 0.1;

// --- Lidar evidence --------------------------------------------------------------------------------------

/// Pairs of scans with other headings, of all recordings together. Chosen.
inline constexpr std::size_t kMostHeadingPairs = 120;

// --- Lidar score -----------------------------------------------------------------------------------------

/// Least share of a direction's signature that poses must leave. Chosen.
inline constexpr double kVisible = 1e-3;

// --- Lidar trace -----------------------------------------------------------------------------------------

/// Sign flips of fewer cannot be significant. Chosen.
inline constexpr std::size_t kFewestHeadingPairs = 25;
/// Terms of the lidar. Chosen.
inline constexpr std::size_t kMostLidarFindings = 2;
/// Family-wise level of terms of the lidar. Chosen.
inline constexpr double kLidarLevel = 0.001;
/// 95 % quantile of the normal distribution, both sides. Derived.
inline constexpr double kNormal95 = 1.960;

// --- Outlier cause ---------------------------------------------------------------------------------------

/// Squared ratio of distances, to the places and to the wheels' motion, from which the wheels are at fault.
/// Derived: half as far.
inline constexpr double kNearPlaces = 0.25;
/// m and rad, of a pair at rest. Chosen.
inline constexpr double kAtRest = 0.01;
/// Outliers whose mean is reported as a cause, and deviations of that mean from zero. Chosen.
inline constexpr double kFewestOfCause = 5.0, kClearCause = 4.0;

// --- Outlier trace ---------------------------------------------------------------------------------------

/// Outlying events that are traced; fewer have everything in common. Chosen.
inline constexpr std::size_t kFewestEvents = 5;
/// Share of all pairs that outliers must be to be traced. Chosen.
inline constexpr double kFewestOutliers = 0.015;
/// Family-wise level of a covariate of the outliers. Derived: no draw of kOutlierDraws is above.
inline constexpr double kOutlierLevel = 0.001;
/// Share of the best gain from which a covariate may as well be the one. Chosen.
inline constexpr double kAsGood = 0.8;
/// Slices of each coordinate of a place; their square is the number of bins of any other covariate. Chosen.
inline constexpr std::size_t kPlaceSlices = 4;
/// Times the usual share of events, above which a bin belongs to the range that is reported. Chosen.
inline constexpr double kUnusualShare = 2.0;
/// Covariates named of outliers. Chosen.
inline constexpr std::size_t kMostNamed = 3;
/// Random permutations; the finest p-value is 1 / (1 + draws). Chosen.
inline constexpr int kOutlierDraws = 999;

// --- Plausibility ----------------------------------------------------------------------------------------

/// Share of a bound from which a prior holds a size back. Chosen.
inline constexpr double kNearBound = 0.6;
/// Times what ticks hide that a sway has to be. Chosen.
inline constexpr double kAboveTicks = 2.0;
/// Deviation of a length, relative, that spoils nothing: a millimetre in a metre. Chosen.
inline constexpr double kNegligibleLengthStd = 1e-3;
/// Share of a length by which a smooth term may not move it. Chosen.
inline constexpr double kMaxLengthShift = 0.25;
/// Level of the Wald test of a term that is still needed. Chosen: the usual 5 %.
inline constexpr double kNeededLevel = 0.05;
/// Times a length's deviation without the term, above which the term spoils the length: a term that
/// nothing can correct, and any other. Chosen.
inline constexpr double kWidenedByNowhere = 10.0, kWidenedByCorrection = 3.0;

// --- Range scale -----------------------------------------------------------------------------------------

/// Scans of a recording, evenly, in which the lengths of the ranges are looked at. Chosen.
inline constexpr std::size_t kScansOfScale = 50;
/// Share of a range over which its error's slope is taken, to either side. Chosen.
inline constexpr double kHalfStep = 0.05;

// --- Range trace -----------------------------------------------------------------------------------------

/// Readings that no longer seem outliers show some more of the error. Chosen.
inline constexpr int kRangePasses = 4;
/// m, change of an error of the ranges that no longer matters. Chosen.
inline constexpr double kRangeSettled_m = 1e-4;
/// Standard deviations of the mean gain on scans that were not used. Chosen.
inline constexpr double kHeldOutZ = 2.5;
/// Standard deviations of an error of the ranges. Chosen as kSignificance.
inline constexpr double kClearRangeError = 4.0;

// --- Residual trace --------------------------------------------------------------------------------------

/// Gain of the correlation ratio that a division must bring. Chosen.
inline constexpr double kWorthDividing = 0.1;
/// Gain of the correlation ratio that a less simple covariate must bring. Chosen.
inline constexpr double kWorthChanging = 0.02;
/// rad; a reversal farther back is forgotten. Chosen.
inline constexpr double kFarBack = 20.0;
/// Index in vehicle::kPlays of the play by which a wheel's reversal is drawn: so much of it goes by until it
/// is taken up. Chosen.
inline constexpr std::size_t kUsualPlay = 9;
/// Bins over a covariate, and points of the picture. Chosen.
inline constexpr std::size_t kTraceBins = 16, kMostTracePoints = 300;
/// m and rad, of a motion that a residual is divided by; smaller ones are left out of the picture. Chosen.
inline constexpr double kLeastDividingWay_m = 0.03, kLeastDividingTurn_rad = 0.05;

// --- Rolling waves ---------------------------------------------------------------------------------------

/// m; less than a pair of scans is long. Chosen.
inline constexpr double kShortestRolling_m = 0.2;
/// m; what changes slower may be anything. Chosen.
inline constexpr double kLongestRolling_m = 1.5;
/// Cycles over the whole way between two waves that are tried. Derived: half the resolution of a Fourier
/// transform.
inline constexpr double kRollingStep = 0.5;
/// Waves tried; the shortest are left out where there would be more. Chosen: time.
inline constexpr double kMostRolling = 3000;
/// Steps of kRollingStep, between waves that are tried about the best. Chosen.
inline constexpr double kFineRollingStep = 0.1;
/// Waves that count as tried for each step of kRollingStep. Chosen.
inline constexpr double kTriedPerRollingStep = 3.0;
/// Probability of a peak as high anywhere, in noise. Chosen.
inline constexpr double kDecisivePeak = 1e-4;

// --- Search ----------------------------------------------------------------------------------------------

/// Share of the pairs that a usual effect does not touch much. Chosen.
inline constexpr double kNoiseShare = 0.95;
/// Named terms. Chosen.
inline constexpr std::size_t kMostFindings = 3;
/// Smooth terms without a name. Chosen.
inline constexpr std::size_t kMostSmooths = 4;
/// Additions and candidates that failed cross-validation, together. Chosen: time.
inline constexpr int kMostSteps = 12;
/// Gauss-Newton steps of a fit. Chosen.
inline constexpr int kMostSearchIterations = 24;
/// Share of what a name explains from which a small delay explains it as well. Chosen.
inline constexpr double kClockShareOfName = 0.9;
/// Family-wise p-value above which a wave is not scored again. Chosen: time.
inline constexpr double kHopelessWave = 0.05;

// --- Search round ----------------------------------------------------------------------------------------

/// Units of BIC within which two candidates may both be meant. Chosen; 6 to 10 are called strong evidence
/// by Kass and Raftery, J. Am. Stat. Assoc. 90, 1995.
inline constexpr double kAmbiguity = 6.0;
/// Share of a smooth term's statistic that a name with that dependence must reach. Chosen.
inline constexpr double kSameDependence = 0.5;
/// Candidates refitted jointly per step. Chosen.
inline constexpr std::size_t kRefits = 4;
/// Share of what a freer term explains with which a name is certain. Chosen.
inline constexpr double kNameShareOfSmooth = 0.9;

// --- Window errors ---------------------------------------------------------------------------------------

/// m, of travel over which an error of the heading counts as one of the position. Chosen.
inline constexpr double kHeadingLever_m = 0.5;

}  // namespace odomcalib::calib::selection::settings
