// Numbers that decide how the command line waits, what it calls proven and how much it shows, each once, with
// its unit and its origin: derived (from what), or chosen (for what reason; where none is given, no
// comparison with other values is known).
#pragma once

#include <chrono>
#include <cstddef>
#include <ctime>
#include <numbers>

namespace odomcalib::cli::settings {

// --- Proof of a calibration by a fresh motion ------------------------------------------------------------

/// What a comparison of scans at rest cannot tell: m over a metre, rad over a turn. Chosen: two to three
/// times the largest error after a calibration in simulated campaigns, and below what a wheel of 0.3 % makes.
inline constexpr double kLengthNoise_m = 0.002, kHeadingNoise_rad = 0.1 * std::numbers::pi / 180.0;

// --- Measuring by hand -----------------------------------------------------------------------------------

/// Repetitions that show a spread: with fewer it is hardly known. Chosen.
inline constexpr std::size_t kFewRepetitions = 3;
/// Deviation over its part that repetitions show. Derived: the root of two, where both parts are equal.
inline constexpr double kWholeOverShown = std::numbers::sqrt2;

// --- Words of the report ---------------------------------------------------------------------------------

/// Share of a pattern in the residual from which on the variable is said to be what it depends on. Chosen.
inline constexpr double kDependsOn = 0.5;

// --- Summary ----------------------------------------------------------------------------------------------

/// Lines of a result that is no longer than a screen, and reasons of many that stand in it. Chosen.
inline constexpr std::ptrdiff_t kSummaryLines = 40;
inline constexpr std::size_t kSummaryReasons = 3;
/// Lines on what was left out, and the share from which it is more than a trace. Chosen: one in a hundred
/// changes no result that is worth having.
inline constexpr std::size_t kLeftOutLines = 3;
inline constexpr double kTrace = 0.01;

// --- Columns and progress --------------------------------------------------------------------------------

/// Columns of a line where no terminal says how many it has. Chosen: those of a terminal as it opens.
inline constexpr std::size_t kTextColumns = 80;
/// Columns below which nothing is narrowed further. Chosen: a table's first column and one more.
inline constexpr std::size_t kFewestColumns = 40;
/// s, of what ends sooner no progress is shown. Chosen: people begin to wonder.
inline constexpr double kQuiet_s = 2.0;
/// s between plain lines of progress where no terminal replaces them. Chosen: a log stays readable.
inline constexpr double kPlainLine_s = 10.0;
/// s and share of a step from which on the rest of it can be told. Chosen.
inline constexpr double kKnownAfter_s = 1.0, kKnownAfterShare = 0.02;
/// Between two looks at the clock while nothing reports progress. Chosen.
inline constexpr std::chrono::milliseconds kTick{500};

// --- Waiting for the daemon ------------------------------------------------------------------------------

/// Between two looks. Chosen: people notice no delay, and the daemon no load.
inline constexpr std::chrono::milliseconds kLookAgain{250};
/// In which the daemon answers one question. Chosen.
inline constexpr std::chrono::milliseconds kAnswerOfDaemon{5000};
/// s, usual and longest. Chosen: devices are opened within two seconds; a day.
inline constexpr double kUsualWait_s = 30.0, kLongestWait_s = 86400.0;

// --- A motion's lease ------------------------------------------------------------------------------------

/// Between renewals. Derived: a quarter of the lease's 120 ms.
inline constexpr std::chrono::milliseconds kRenewal{30};
/// Priority among real-time processes while a motion runs. Chosen.
inline constexpr int kPriority = 5;

// --- Exported noise --------------------------------------------------------------------------------------

/// m and rad between two updates of AMCL. Published: defaults of nav2 (update_min_d, update_min_a).
inline constexpr double kAmclStep_m = 0.25, kAmclTurn_rad = 0.2;
/// m/s of the rims and 1/s that the variances of velocities are stated for. Chosen: an indoor robot, and the
/// rate at which ros2_control publishes odometry by default.
inline constexpr double kSpeedOfNoise = 0.5, kRateOfNoise = 50.0;

// --- Live view -------------------------------------------------------------------------------------------

/// Between two looks at the daemon. Derived: the period of its progress.
inline constexpr std::chrono::milliseconds kLiveTurn{200};
/// Turns between tables of parameters, and between tries to reach a daemon that went away. Chosen: a second.
inline constexpr int kTurnsPerTable = 5, kTurnsPerTry = 5;
/// ms in which the daemon answers. Chosen.
inline constexpr int kAnswerWithin_ms = 1000;
/// Answers without a message before it is said that none arrive. Chosen: two seconds.
inline constexpr int kPatience = 10;
/// Messages taken in a turn. Chosen: some seconds of them; a flood does not keep the page from its turn.
inline constexpr int kMostMessages = 500;
/// Points of a path. Chosen: about the width of the picture in px.
inline constexpr std::size_t kMostPoints = 800;
/// m between them, doubled whenever there are too many. Chosen.
inline constexpr double kSpacing_m = 0.01;
/// Beams of a scan. Chosen: half a degree of a full turn.
inline constexpr std::size_t kMostBeams = 720;
/// Connections to the page, and threads that serve them. Chosen: a few browsers, with room for those that
/// hang; one that hangs delays nobody.
inline constexpr std::ptrdiff_t kMostConnections = 16;
inline constexpr std::size_t kThreads = 8;
/// s for a request or an answer to go through, on loopback. Chosen.
inline constexpr std::time_t kConnectionPatience_s = 2;

}  // namespace odomcalib::cli::settings
