// Numbers that decide how the command line waits and how much it shows, each once, with
// its unit and its origin: derived (from what), or chosen (for what reason; where none is given, no
// comparison with other values is known).
#pragma once

#include <chrono>
#include <cstddef>
#include <ctime>
#include <numbers>

namespace odomcalib::cli::settings {

// --- Measuring by hand -----------------------------------------------------------------------------------

/// Repetitions that show a spread: with fewer it is hardly known. Chosen.
inline constexpr std::size_t kFewRepetitions = 3;
/// Deviation over its part that repetitions show. Derived: the root of two, where both parts are equal.
inline constexpr double kWholeOverShown = std::numbers::sqrt2;

// --- Comparison of calibrations -------------------------------------------------------------------------

/// m in a metre, the largest bound of its error. Chosen: beyond it the nominal values are wrong, not worn.
inline constexpr double kMostErrorOfMetre = 0.2;
/// km, the largest that a counter of the robot may say. Chosen: a hundred times what a robot of ten years
/// has.
inline constexpr double kMostOdometer_km = 1e7;

// --- Files of the user's own -----------------------------------------------------------------------------

/// Bytes of a file that export changes. Chosen: a hundred times a large URDF; more is another kind of file.
inline constexpr std::size_t kMostOwnFile_bytes = 16'000'000;
/// Names of two nodes with their namespaces that are compared; longer ones are taken to be of one node.
/// Chosen: far above those of robots.
inline constexpr std::size_t kMostNamesOfNodes = 16;
/// Cosine of the tilt up to which a lidar is level. Chosen: 15 degrees, as where a bag says how it is
/// mounted.
inline constexpr double kLevelLidar = 0.966;

// --- Recordings given together ---------------------------------------------------------------------------

/// s, that one time differs by between two files. Derived: a double has steps of 0.24 us since 1970.
inline constexpr double kSameTime_s = 1e-6;

// --- Inspection of a recording ---------------------------------------------------------------------------

/// m, and counts of a wheel's turn, of a robot of which nobody stated them: what kinds of motion there are
/// hardly depends on them. Chosen: those of the simulated robot.
inline constexpr double kUsualDiameter_m = 0.15, kUsualTrack_m = 0.4, kUsualTicks = 4096.0;
/// Topics that are listed in text. Chosen: a screen of them.
inline constexpr std::size_t kTopicLines = 40;

// --- Words of the report ---------------------------------------------------------------------------------

/// Digits of an effect's value behind the point. Chosen: what its deviation needs.
inline constexpr int kDigits = 3;
/// Sizes from which a sentence has whole numbers, and tenths. Chosen: two digits that count.
inline constexpr double kWholeNumbers = 99.95, kTenths = 0.095;
/// Share of an error that the dimensions alone explain, from which on it is said which way it was off.
/// Chosen: most of it.
inline constexpr double kPlainDirection = 0.5;
/// Times the typical size, of a size that no robot has. Chosen.
inline constexpr double kNever = 1000.0;
/// Stretches of motion from which an interval is printed. Chosen: of fewer a 95 % interval is a guess.
inline constexpr std::size_t kFewestForInterval = 10;
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

/// Defaults of slam_toolbox's matcher: m and rad between two scans, m of the grid, m that its points are
/// smeared by, rad of the fine search. Published: config/mapper_params_online_async.yaml.
inline constexpr double kSlamStep_m = 0.5, kSlamTurn_rad = 0.5;
inline constexpr double kSlamGrid_m = 0.01, kSlamSmear_m = 0.1, kSlamFine_rad = 0.00349;
/// Weight of the square of a distance in its penalty. Published: Mapper.cpp, DISTANCE_PENALTY_GAIN and
/// ANGLE_PENALTY_GAIN.
inline constexpr double kSlamGain = 0.2;
/// m to what a lidar sees. Chosen: rooms; farther walls tell a heading better.
inline constexpr double kSlamRange_m = 3.0;

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
/// Noise of one measured motion between two scans, m and rad: what the live page expects of motion that is
/// not solved yet. Measured: 0.8 mm and 0.03 degrees in simulated rooms, rounded up.
inline constexpr double kPairLength_m = 0.001, kPairHeading_rad = 0.05 * std::numbers::pi / 180.0;
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
