// Numbers that decide whether the streams of a recording can be what they are called, each once, with its
// unit and its origin (see calib/matching/settings.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <numbers>

#include "calib/matching/settings.hpp"

namespace odomcalib::calib::ingest::settings {

// --- Time stamps -----------------------------------------------------------------------------------------

/// s, intervals at which counts and scans come in a recording. Chosen: robots send both 2 to 500 times a
/// second. The bounds are less than a factor of 1000 apart, so that one unit of time fits at most.
inline constexpr double kShortestInterval_s = 2e-3, kLongestInterval_s = 1.0;
/// s, of scans that come faster than any head turns. Chosen: the fastest 2D lidars send 100 scans a second.
inline constexpr double kFastestScans_s = 3e-3;
/// s, between neighbouring samples of one stream: their clock was set. Chosen: twelve days, which no
/// recording pauses for.
inline constexpr double kClockSet_s = 1e6;
/// Times the usual step, of one that is unlike all others. Chosen, insensitive.
inline constexpr double kUnlikeOthers = 1e3;
/// Time that all beams of a scan take over the time from scan to scan: no head sends a scan before the one
/// before it ends. Chosen: half a turn is left to uneven stamps.
inline constexpr double kLongestSweep = 1.5;

/// The same ratio, of beam times that are in another unit rather than on another clock. Chosen: clocks that
/// run apart by more are none.
inline constexpr double kSweepInOtherUnit = 20.0;
/// Relative difference of the spans of two streams in their units. Chosen: one recorder starts and ends a
/// little later.
inline constexpr double kSameSpan = 0.1;
/// m, of a lidar from the middle of the axle. Chosen: larger robots are not driven by two wheels.
inline constexpr double kFarthestLidar_m = 5.0;
/// s, between neighbouring scans or poses, beyond which the reference was interrupted. Chosen, insensitive.
inline constexpr double kMaxGap_s = 2.0;
/// Interval over the mean one, of samples that come at once. Chosen, insensitive.
inline constexpr double kSentAtOnce = 0.1;

// --- Angles ----------------------------------------------------------------------------------------------

/// Turns that the beams of one scan cover. Chosen: drivers repeat a few beams where turns overlap; what is
/// stretched by a quarter is beyond.
inline constexpr double kMostTurns = 1.15;
/// rad that a scan spans whose sensor sees all round. Chosen: 350 degrees.
inline constexpr double kAllRoundScan_rad = 6.1;
/// Turns, of angles that look like degrees. Chosen, insensitive.
inline constexpr double kTurnsInDegrees = 4.0;

// --- Parts of turns, repeated scans, beams of a wandering head -------------------------------------------

/// Relative difference of the steps from beam to beam of two scans, by rounding. Derived: of single
/// precision.
inline constexpr double kSameStep = 1e-4;
/// Scans that a judgement on the whole stream takes. Chosen, insensitive.
inline constexpr std::size_t kFewestParts = 20;
/// Parts that make a turn, at least: of fewer, a scan is nearly a turn. Chosen, insensitive.
inline constexpr double kFewestPartsOfTurn = 1.7;
/// Share of the scans that go on where the one before ended. Chosen: a part is lost now and then.
inline constexpr double kFollowingParts = 0.8;
/// Readings that make a scan which cannot be equal to another by chance. Chosen: a dozen lengths to the
/// millimetre.
inline constexpr int kReadingsOfScan = 12;
/// m at the rim, between two scans that are equal in every reading: no lidar sees nothing of that. Chosen:
/// several steps of a lidar that reads millimetres.
inline constexpr double kMovedBetween_m = 5e-3;
/// Turns of a robot about one wheel that stands, in a row. Chosen: drives have half a turn of that.
inline constexpr double kMostPivots = 2.0;
/// Poses in a row that a driver sends again. Chosen: of more, the robot stands, unless the wheels turn.
inline constexpr std::size_t kMostRepeats = 3;
/// m at the rim, that wheels turn while a pose is held. Chosen: several times a centimetre, to which poses
/// are rounded now and then.
inline constexpr double kRolledWhileHeld_m = 0.05;
/// Beams by which the number varies while the head runs evenly. Derived: a turn is cut between two beams, so
/// that one more or less fits.
inline constexpr std::size_t kBeamsAtEnds = 1;
/// Share of the scans with the most frequent number of beams, of a head that runs evenly. Chosen: half.
inline constexpr double kUsualNumber = 0.5;
/// Relative difference of the mean number of beams times their step from one turn. Chosen: steps are stated
/// to that.
inline constexpr double kNearlyOneTurn = 0.02;
/// Relative difference of the medians of the number of beams and of their step, between recordings of one
/// lidar. Derived: a head whose speed wanders by that still makes one turn.
inline constexpr double kSameTurn = kNearlyOneTurn;

// --- Ranges ----------------------------------------------------------------------------------------------

/// m, median reading of a recording. Chosen: lidars that measure 80 m see nothing at most bearings; robots
/// that fit on a desk see their walls at 0.2 m.
inline constexpr double kFarthestMedian_m = 60.0, kNearestMedian_m = 0.02;
/// m, where the median reading lies for most robots. Only the unit that is nearest is named. Chosen,
/// insensitive.
inline constexpr double kUsualMedian_m = 2.5;
/// Scans that are looked at, evenly spread. Chosen, insensitive.
inline constexpr std::size_t kScansLookedAt = 200;

/// Standard deviation of the scale of a lidar, relative. Derived (JCGM 100:2008, 4.3.7) from limits of 1 % of
/// the range, as published for triangulating lidars (SLAMTEC, RPLIDAR A1M8 data sheet: up to 3 m); those that
/// measure times of flight are better over long ranges and state limits in cm.
inline constexpr double kLidarScale = 0.01 / std::numbers::sqrt3;

// --- Readings that stand for no return ---------------------------------------------------------------------

/// Share of the readings that are one and the same number. Chosen: a wall shares out over the steps of the
/// range, and moves with the robot.
inline constexpr double kPhantomShare = 0.004;
/// How many times as often as its ten neighbours, one by one, the number comes. Chosen: walls seen squarely
/// from a moving robot make 2 to 3.
inline constexpr double kPhantomPeak = 15.0;
/// Parts of a recording, and in how many the number must stand out. Chosen: a wall at one distance does so
/// while the robot stays there.
inline constexpr std::size_t kPhantomParts = 8, kPhantomPartsNeeded = 6;

/// Share of range_max from which a reading is no surface anyway (matching::far_limit). Derived from there.
inline constexpr double kNearRangeMax = 1.0 - matching::settings::kNoiseAfar;
/// Neighbours on either side. Chosen, insensitive.
inline constexpr std::size_t kPhantomBeside = 5;

// --- Poses -----------------------------------------------------------------------------------------------

/// Share of the largest distance from the first pose, from one pose that is looked at to the next. Chosen:
/// noise of a reference is small against it whatever unit lengths are in.
inline constexpr double kPoseStep = 0.01;
/// Share of the time with scans that poses have to cover, which replace them; of less it is said. Chosen: a
/// recorder starts one of them a little later, and a reference loses sight for a moment; what a robot drives
/// in a fifth of the time may be what a parameter needs.
inline constexpr double kPosesCover = 0.8;
/// Steps that a judgement takes. Chosen, insensitive.
inline constexpr std::size_t kFewestPoseSteps = 30;
/// Share of the way that goes sideways: of poses that may contradict their heading, and of those that follow
/// it. Derived: 0.64 where heading and way have nothing to do with each other; wheels slip by a few per cent,
/// and a marker beside the middle of the axle moves sideways in turns.
inline constexpr double kSidewaysAtLeast = 0.2, kSidewaysAtMost = 0.15;
/// Part of that share that a mistake put right may leave. Chosen: no small gain names a mistake.
inline constexpr double kSidewaysMended = 0.3;
/// Circular variance of the way against the heading as it is given, and how many times that against its
/// negative: of a heading that turns the other way. Derived: 0.06 where lines turn by 10 degrees and back.
/// Measured: at most 1.1 times in 113 recordings whose yaw is right.
inline constexpr double kScatterAtLeast = 0.01, kScatterRatio = 10.0;

// --- Odometry
// --------------------------------------------------------------------------------------------------

/// m and rad, of a step that is looked at. Chosen: numbers with three decimals bend it by a degree at most.
inline constexpr double kOdometryStep_m = 0.02, kOdometryStep_rad = 0.1;
/// Sideways over ahead, of a frame that is turned: half a degree, which makes lengths 0.004 % longer, less
/// than their deviations. Measured: below 0.004 in 16 recordings of other people's robots.
inline constexpr double kTurnedFrame = 0.0087;
/// Standard deviations of that. Chosen, insensitive.
inline constexpr double kPlainlyTurned = 5.0;
/// Share of the way that goes sideways and that no frame explains, of a yaw from elsewhere. Measured: below
/// 0.005 in the same recordings; 0.1 with the yaw of a filter.
inline constexpr double kAsideUnexplained = 0.03;

/// m, to which x and y are rounded where digits were cut off, the largest first, and the share of it that a
/// multiple is off by. Chosen: a digit or half of one; sums of binary fractions.
inline constexpr std::array kRoundings_m = {0.1, 0.05, 0.02, 0.01, 0.005, 0.002};
inline constexpr double kOfARounding = 1e-3;

/// rad, of a step that is part of a turn, and steps of turns to either side. Chosen: a quarter of a turn, in
/// steps as above.
inline constexpr double kTurnOfStep_rad = 0.02;
inline constexpr std::size_t kFewestTurnSteps = 15;
/// Share of these that are turns on the spot, at least. Chosen: most drives have more.
inline constexpr double kTurnsTogether = 0.25;
/// Shares of the track: how far from the frame the centre of a turn on the spot lies at most; how far centres
/// may lie apart; how far beside the axle a frame is told. Derived: half a track is a wheel; chosen: odometry
/// turns on the spot about one point, and wheels that are driven unequally by a tenth shift it by 0.025.
inline constexpr double kNearWheels = 0.6, kTurnsAgree = 0.03, kBesideAxle = 0.05;

// --- Even stamps -----------------------------------------------------------------------------------------

/// Stamps from which a period is looked for. Chosen, insensitive.
inline constexpr std::size_t kFewestStamps = 50;
/// s, jitter up to which stamps are left as they are. Chosen: nothing moves so fast that it mattered.
inline constexpr double kEvenEnough_s = 3e-4;
/// Samples to either side whose middle is taken. Chosen, insensitive.
inline constexpr std::size_t kMiddleReach = 30;
/// Deviations from their median of what belongs to it. Chosen: whatever follows a step is not part of it.
inline constexpr double kMiddleSigmas = 3.0;
/// Samples over which a period is measured. Chosen, insensitive.
inline constexpr std::size_t kPeriodSamples = 100;
/// Mean interval over the usual one, up to which lost samples are counted. Chosen, insensitive.
inline constexpr double kFewLost = 3.0;
/// Spread of the intervals, as a share of the usual one, up to which their number is certain. Chosen,
/// insensitive.
inline constexpr double kCertainCount = 0.2;
/// Times the usual interval: from the first on a sample was held up, and up to the second others follow at
/// once. Chosen, insensitive.
inline constexpr double kHeldUp = 1.5, kFollowsAtOnce = 0.5;
/// s, of jitter that is reported. Chosen, insensitive.
inline constexpr double kReportedJitter_s = 5e-3;

// --- Contest of stamps -----------------------------------------------------------------------------------

/// Rounds in which the errors that count and the share settle each other. Chosen, insensitive.
inline constexpr int kContestRounds = 5;
/// Times the spread, of an error that counts in full. Chosen, insensitive.
inline constexpr double kContestLimit = 2.0;
/// Share of the errors that speaks for even stamps, and deviations that it must be beyond. Chosen, sensitive.
inline constexpr double kEvenShare = 0.5, kEvenSigmas = 3.0;

}  // namespace odomcalib::calib::ingest::settings
