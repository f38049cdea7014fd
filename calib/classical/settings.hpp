// Numbers that decide which factor a length has in it, and which moves show a length, each once, with its
// unit and its origin (see calib/matching/settings.hpp).
#pragma once

#include "calib/math/se2.hpp"

namespace odomcalib::calib::classical::settings {

/// Ratio of an estimated and a nominal length that still is a measurement of the same thing, and its inverse.
/// Chosen: beyond the 10 % that the gate warns of, below the smallest factor of the table (1.5).
inline constexpr double kSameLength = 1.2;
/// Relative deviation of a ratio from a factor of the table, and of ratios that are alike. Derived: nominal
/// values are right to 10 %, and neighbouring factors of the table are 27 % apart at least.
inline constexpr double kSameFactor = 0.12;
/// Ratio, or its inverse, of both diameters from which a gear is named where the table knows nothing, and of
/// the track from which its value is said to be wrong. Chosen, insensitive.
inline constexpr double kGearFactor = 2.0;
/// Ratio of angles, or speeds, to those of the wheels from which they are counts. Chosen: encoders have more
/// than 600 counts a turn with their gear, and gears of robots that are bought are mostly below 1 : 100.
inline constexpr double kCountsFactor = 100.0;
/// Ratio, or its inverse, by which the encoders of two wheels count unlike each other. Chosen, sensitive.
inline constexpr double kUnlikeCounts = 2.0;

// --- Straight and spin -----------------------------------------------------------------------------------

/// rad, by which a stretch may turn that still counts as straight. Chosen, sensitive.
inline constexpr double kStraightYaw_rad = 0.02;
/// m in all, of straight motion that shows a diameter. Chosen, insensitive.
inline constexpr double kLeastTravel_m = 0.3;
/// m and rad, of a pair of scans that shows a ratio. Chosen, sensitive.
inline constexpr double kLeastPairTravel_m = 0.02, kLeastPairTurn_rad = 0.03;
/// Travel over rotation, in units of the track width, of a turn that still is on the spot. Chosen, sensitive.
inline constexpr double kSpinLever = 0.1;
/// Robust deviations of a pair that is left out. Chosen, sensitive.
inline constexpr double kGrossPair = 5.0;

// --- Rest to rest ----------------------------------------------------------------------------------------

/// m, of a straight move. Chosen: below it errors at rest weigh too much.
inline constexpr double kLeastDistance_m = 0.2;
/// rad, by which a straight move may turn. Chosen: a robot that turns about a wheel that stands turns by more
/// on kLeastDistance_m, up to a track width of 0.8 m.
inline constexpr double kMostYaw_rad = 0.5;
/// rad, of a turn on the spot. Chosen: a quarter of a turn.
inline constexpr double kLeastTurn_rad = math::kPi / 2.0;
/// Share of a side; a drive that ends farther from its start is no square. Chosen: as far as one ends whose
/// four turns are each off by 10 degrees.
inline constexpr double kFarEnd = 0.5;
/// Error of the common scale of diameters that a straight metre gave, by either reference: relative. Derived:
/// of kLidarAtRest and kTapeAndMark the place, over a metre.
inline constexpr double kDiametersOfStraight = 3e-4;

// --- Missing motion --------------------------------------------------------------------------------------

/// Share of what the wheels rolled together, of rolling against each other, or the reverse, or of either that
/// is not in a fixed proportion to the other: below it a motion is missing. Chosen: a circle whose radius is
/// five track widths has it.
inline constexpr double kHardlyAny = 0.1;

// --- Motion for each parameter ---------------------------------------------------------------------------

/// m of straight lines and rad of turns in each direction that show the lengths, and the lidar's place, well.
/// Chosen: what docs/user/motions.md asks for.
inline constexpr double kEnoughStraight_m = 1.0, kEnoughTurn_rad = 2.0 * math::kPi,
                        kEnoughTurnForLidar_rad = math::kPi;
/// s without motion that is a stop. Chosen: scans of a lidar with two turns a second are sharp then.
inline constexpr double kStop_s = 0.5;
/// m/s, of a rim that stands. Chosen: angles of a driver that filters them creep.
inline constexpr double kStanding_m_s = 0.002;

// --- Closed form -----------------------------------------------------------------------------------------

/// Condition of the rotation's equations above which they cannot separate the two wheels. Published: the
/// authors' code.
inline constexpr double kMostConditionOfRotation = 75.0;

// --- Signs -----------------------------------------------------------------------------------------------

/// rad from its nominal value, of a lidar's yaw that is a fault of its own. Chosen: 20 degrees.
inline constexpr double kFarYaw_rad = math::kPi / 9.0;
/// Motions that a word about wires needs. Chosen: with fewer, two or three failed matches say the same.
inline constexpr std::size_t kFewestForSigns = 20;
/// Share of what is left of the rotation with the wires as they are, that other wires may leave. Chosen:
/// exchanged sides leave all of it, and put right only noise.
inline constexpr double kLeftByWires = 0.5;
/// Deviations by which lengths stand clear of zero, on either side. Chosen, insensitive.
inline constexpr double kClearOfZero = 5.0;
/// Share of what the wheels rolled, of a reference that stood. Chosen: a turn of four times the counts is
/// more, and has its own message.
inline constexpr double kHardlyMoved = 0.15;

// --- Linear -----------------------------------------------------------------------------------------------

/// Condition of A^T A up to which LDLT and normal equations keep eight digits of an exact problem. Chosen
/// for these eight digits, which tests/unit/calib/classical/linear_test.cpp asks for.
inline constexpr double kMostConditionOfNormal = 1e6;

}  // namespace odomcalib::calib::classical::settings
