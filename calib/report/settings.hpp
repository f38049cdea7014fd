// Numbers that decide about the verdict, each once, with its unit and its origin (see
// calib/matching/settings.hpp).
#pragma once

#include <cstddef>

namespace odomcalib::calib::report::settings {

// --- Lengths -----------------------------------------------------------------------------------------------

/// Relative deviation of a length that is no calibration any more, and of one to warn of. Chosen,
/// insensitive.
inline constexpr double kMaxRelativeDeviation = 0.03;
inline constexpr double kWarnRelativeDeviation = 0.005;
/// Estimate over nominal value, of what cannot be the length that it is called. Chosen, sensitive.
inline constexpr double kPlausibleLow = 0.5, kPlausibleHigh = 2.0;
/// Relative difference from the nominal value to warn of. Chosen, insensitive.
inline constexpr double kWarnChange = 0.10;
/// Difference between the changes of the three lengths, as a share of their change, up to which they change
/// by one factor. Measured: 0.00002 to 0.002 where yaw of the odometry was a gyro's; chance makes it of one
/// in some hundred robots whose nominal lengths err by 1 % each.
inline constexpr double kOneFactor = 0.02;
/// Relative, of a scan matcher's metre; it depends on the room. Measured: 0.02 % over simulated rooms
/// (tests/integration/accuracy_test.cpp).
inline constexpr double kMatcherScale = 2e-4;
/// rad, between the headings of a drive that hardly turns. Chosen: 20 degrees.
inline constexpr double kFewHeadings_rad = 0.35;
/// m, that places in a room err by for as long as the lidar looks the same way. Chosen as matching's
/// kBeamFloor_m: unevenness of walls, and what wheels and rays are rounded to.
inline constexpr double kErrorOfOneHeading_m = 1e-3;
/// Relative deviation of a length that more driving hardly improves. Chosen: scan matching in one room is no
/// better.
inline constexpr double kGoodEnough = 5e-4;

// --- Pairs of scans or poses
// --------------------------------------------------------------------------------

/// Share of the pairs that matched: of fewer the rest may say something else. Chosen, insensitive.
inline constexpr double kFewestMatched = 0.1, kWarnMatched = 0.5;
/// The same where most pairs that matched leave a direction open. Chosen: each says less.
inline constexpr double kFewestMatchedInPart = 0.5;
/// Pairs that a word about wires, gears, units or lost counts needs. Chosen: fewer, and a few failed matches
/// say the same.
inline constexpr double kFewestForCause = 20.0;
/// Share of the beams that met something, below which it is said. Chosen: half of the room.
inline constexpr double kFewReadings = 0.5;
/// Share of the pairs that contradict all others by more than five deviations, of a recording that a second
/// look is worth. Measured: below 0.1 % in sound simulated recordings, 1 to 5 % in real ones.
inline constexpr double kManyContradict = 0.1;
/// The same, of a fit that describes one part of the recording and not the other. Chosen, insensitive.
inline constexpr double kTooManyContradict = 0.25;

// --- What was left out -------------------------------------------------------------------------------------

/// Share of the samples, or of the intervals between counts, that a recording lost: to warn of, and of which
/// less is left than was lost. Measured: 0 in 166 of 167 simulated and real recordings (one has every fifth
/// sample twice, which loses nothing), 0.5 % of the scans in the other; 9 to 50 % of scans that a driver
/// sends again, 16 % of counts between zeros of a second program, 92 to 96 % where all intervals are broken
/// or stamps are in whole seconds. The first is twice what a good drive loses; the second, of wheels alone,
/// is chosen: more is lost than left.
inline constexpr double kWarnLeftOut = 0.01, kMostLeftOut = 0.5;
/// Share of the scans without counts, and of what the wheels turned without scans, that is told. Chosen: a
/// recorder starts one of them a little later; what a robot drives in a fifth of the time may be what a
/// parameter needs.
inline constexpr double kOneSided = 0.2;

// --- Figures of what odometry is off by
// ---------------------------------------------------------------------

/// Times the noise: most of the error has another cause. Chosen, sensitive.
inline constexpr double kWarnResidual = 2.0;
/// Times the nominal values' error, of an error that has not become smaller. Chosen, insensitive.
inline constexpr double kNoBetter = 1.0;
/// Share of a count's step at the rim, and m, that poses are off by over ten seconds which are computed of
/// the wheels. Derived: those of counts agree to rounding, those of anything else are off by some steps;
/// kRounding_m is what numbers with five decimals are rounded to. Measured: 3 um, and above 1.5 mm in real
/// recordings.
inline constexpr double kShareOfStep = 0.2;
inline constexpr double kRounding_m = 1e-5;
/// Times the noise, of an error with the nominal values that there was something to gain from. Chosen: 1.2 is
/// what a metre of the MinesRover recordings shows.
inline constexpr double kWorthGaining = 1.2;
/// m per metre, rad per metre and rad per turn, of odometry that is still off whatever the noise is. Chosen:
/// two per cent, a degree, two degrees.
inline constexpr double kMetreOff_m = 0.02, kMetreOff_rad = 0.0175, kTurnOff_rad = 0.035;

// --- Agreement
// ----------------------------------------------------------------------------------------------

/// Deviations, and share of the length, by which the closed form and the joint fit differ. Measured: 1.3
/// deviations and 0.1 % in sound simulated recordings; 2 deviations in real ones.
inline constexpr double kEstimatorsApart = 6.0, kEstimatorsApartShare = 0.005;
/// Runs test, standard normal, of residuals that come in long rows of one sign. Measured: -2.8 to 4 in sound
/// recordings.
inline constexpr double kTooFewRuns = -5.0;
/// Residuals that the runs test needs. Chosen, insensitive.
inline constexpr double kFewestForRuns = 10.0;

/// Share of the residual's systematic part that has no name: most of it. Chosen, insensitive.
inline constexpr double kMostUnexplained = 0.5;

// --- Signs that add up -------------------------------------------------------------------------------------

/// Times the rules' own limits, summed over different rules. Measured: at most 5.2 in 167 simulated and real
/// recordings that a person may use (a motion capture square of optiodom; 5.0 with a mast that sways, 3.9
/// with a loose wheel, below 3.2 in all but five); 6.6 and more of steered wheels that nothing else refuses
/// (track width off by 10 to 31 %; a car in a bag: 8.2), 10.5 and more of scans whose clock is set by 0.5
/// s, 8.2 and more of the wheels of a trailer. The number is in the middle of 5.2 and 6.6. Not parted by it:
/// one wheel that loses a fifth of its counts now and then (5.3 to 9.9), or slips by a fifth for half of the
/// drive (3.6 to 7.5), which may be accepted with warnings.
inline constexpr double kMostSigns = 5.8;
/// Largest weight of a single sign: one alone never refuses. Chosen, insensitive.
inline constexpr double kHeaviestSign = 4.0;

// --- Several recordings ----------------------------------------------------------------------------------

/// Level of the test of homogeneity. Chosen: one in a thousand sets of recordings of one robot is taken for
/// several.
inline constexpr double kApartLevel = 1e-3;
/// Share of chi-squared between an odd recording and the others that one change more has to explain to be
/// named. Chosen: a tyre changed by 1 % makes 300 and more, errors of a recording's own deviations some 15.
inline constexpr double kShareOfChange = 0.1;
/// Share of a length, m and rad of the lidar's place: differences beyond are refused, smaller ones widen the
/// deviations. Chosen: the first is what the verdict warns of where a length is not known better.
inline constexpr double kLengthApart = kWarnRelativeDeviation, kMountApart_m = 0.01, kMountApart_rad = 0.02;

// --- Pictures --------------------------------------------------------------------------------------------

/// Poses of a path, and pairs. Chosen, sensitive.
inline constexpr std::size_t kMostPathPoints = 600, kMostSamples = 300;
/// Scans that are laid on each other, and beams of each. Chosen: what an eye can tell apart.
inline constexpr std::size_t kOverlaidScans = 8, kOverlaidBeams = 150;
/// Bins of a histogram of residuals, and deviations at which it ends. Chosen, sensitive.
inline constexpr std::size_t kHistogramBins = 20;
inline constexpr double kHistogramEnd = 5.0;

// --- Homogeneity -----------------------------------------------------------------------------------------

/// Relative deviation of each length that one recording must determine alone to be compared with others.
/// Chosen, insensitive.
inline constexpr double kKnownAlone = 0.02;

// --- Outlier cause ---------------------------------------------------------------------------------------

/// Squared ratio of distances, to the places and to the wheels' motion, from which the wheels are at fault.
/// Derived: half as far.
inline constexpr double kNearPlaces = 0.25;
/// m and rad, of a pair at rest. Chosen, insensitive.
inline constexpr double kAtRest = 0.01;
/// Outliers whose mean is reported as a cause, and deviations of that mean from zero. Chosen, sensitive.
inline constexpr double kFewestOfCause = 5.0, kClearCause = 4.0;

// --- Outlier trace ---------------------------------------------------------------------------------------

/// Outlying events that are traced; fewer have everything in common. Chosen, insensitive.
inline constexpr std::size_t kFewestEvents = 5;
/// Share of all pairs that outliers must be to be traced. Chosen, insensitive.
inline constexpr double kFewestOutliers = 0.015;
/// Family-wise level of a covariate of the outliers. Derived: no draw of kOutlierDraws is above.
inline constexpr double kOutlierLevel = 0.001;
/// Share of the best gain from which a covariate may as well be the one. Chosen, sensitive.
inline constexpr double kAsGood = 0.8;
/// Slices of each coordinate of a place; their square is the number of bins of any other covariate. Chosen,
/// untried.
inline constexpr std::size_t kPlaceSlices = 4;
/// Times the usual share of events, above which a bin belongs to the range that is reported. Chosen, untried.
inline constexpr double kUnusualShare = 2.0;
/// Covariates named of outliers. Chosen, insensitive.
inline constexpr std::size_t kMostNamed = 3;
/// Random permutations; the finest p-value is 1 / (1 + draws). Chosen, sensitive.
inline constexpr int kOutlierDraws = 999;

// --- Residual trace --------------------------------------------------------------------------------------

/// Gain of the correlation ratio that a division must bring. Chosen, sensitive.
inline constexpr double kWorthDividing = 0.1;
/// Gain of the correlation ratio that a less simple covariate must bring. Chosen, insensitive.
inline constexpr double kWorthChanging = 0.02;
/// rad; a reversal farther back is forgotten. Chosen, sensitive.
inline constexpr double kFarBack = 20.0;
/// Index in vehicle::kPlays of the play by which a wheel's reversal is drawn: so much of it goes by until it
/// is taken up. Chosen, sensitive.
inline constexpr std::size_t kUsualPlay = 9;
/// Bins over a covariate, and points of the picture. Chosen, sensitive.
inline constexpr std::size_t kTraceBins = 16, kMostTracePoints = 300;
/// m and rad, of a motion that a residual is divided by; smaller ones are left out of the picture. Chosen,
/// sensitive.
inline constexpr double kLeastDividingWay_m = 0.03, kLeastDividingTurn_rad = 0.05;

}  // namespace odomcalib::calib::report::settings
