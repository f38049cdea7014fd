// Members that the calibration file gained after its first version: each is absent where there is nothing to
// say. Numbers are in SI units and radians.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace odomcalib {

/// A smooth term as the file has it: its basis is told by the members that are not zero. The initial values
/// are those that files of earlier versions mean where they state none.
struct SmoothTermEntry {
  std::string variable, carrier;  ///< names of the covariate and of the channel
  double low = 0.0, high = 0.0;   ///< range of the covariate, in its unit
  double period = 0.0;
  std::vector<double> mean;  ///< of each function, subtracted from it
  int harmonic = 0, knots = 4, degree = 4;
  double moment = 0.0, fading = 0.0;  ///< s
  std::size_t memory = 1;
  std::array<double, 2> wave{};
  bool constant = false, patches = false, with_motion = false;
  std::vector<double> coefficients;
  std::string law_of;  ///< named effect whose function it completes, or empty
};

/// An error of the lidar without a name; reported, not applied.
struct LidarCurve {
  std::string variable;
  bool law_of_a_name = false, corrected = false;
  double held_out_before = 0.0, held_out_after = 0.0;
  std::vector<std::pair<std::string, double>> coefficients;
};

/// Pairs that contradict all others and were left out of the fit.
struct OutlierReport {
  std::size_t outliers = 0, pairs = 0;
  std::vector<std::string> depends_on;  ///< names of covariates, the best first
  double p_value = 1.0;
  std::size_t placed = 0, confirmed = 0;       ///< pairs
  double farther = 0.0, turned_farther = 0.0;  ///< m, rad
};

/// Standard deviation that a metre rolled adds by chance, along one axis.
struct AxisNoise {
  double value = 0.0;
  std::string unit;
};
struct ContactNoise {
  AxisNoise forward, sideways, yaw;
};

/// Times that were replaced, s; zero where those given were right.
struct StampTimes {
  double ticks = 0.0, scans = 0.0;
  double time_increment = 0.0;   ///< assumed between beams
  std::optional<double> clocks;  ///< standard deviation between recordings, where they differ
};

/// A gyro against the rotation of the robot.
struct GyroResult {
  std::string file;
  std::size_t used = 0;                                ///< intervals
  double scale = 1.0, scale_std = -1.0;                ///< what it reads over what the robot turned
  double bias = 0.0;                                   ///< rad/s
  double offset = 0.0;                                 ///< s, its stamps less those of the lidar
  std::optional<std::string> left_out = std::nullopt;  ///< why
};

/// A term that was tried, and what came of it.
struct ConsideredTerm {
  std::string candidate;
  double statistic = 0.0, p_value = 1.0;
  std::string outcome;
};

struct EstimateAlone {
  double value = 0.0, std = 0.0;
};
struct ClockAlone {
  double offset = 0.0, std = 0.0;  ///< s
};
/// One of several recordings by itself.
struct RecordingAlone {
  std::string file, robot_id;
  std::optional<std::vector<std::pair<std::string, EstimateAlone>>> parameters;  ///< none: not determined
  std::optional<ClockAlone> clock;
  std::vector<std::pair<std::string, double>> deviation;  ///< from the others, in standard deviations
};

struct FarthestParameter {
  std::string recording, parameter;
  double sigmas = 0.0;
};
/// Whether several recordings are of one robot in one state.
struct HomogeneityTest {
  double p_value = 1.0;
  FarthestParameter worst;
};

/// Settings that a reader of the file must know to repeat the run.
struct SolveSettings {
  std::string version;
  std::optional<std::vector<std::string>> effects;
  std::string scale, sensor;
  std::optional<int> rounds;                   ///< of the closed form, where they are not the usual ones
  std::optional<double> cut;                   ///< share that each cuts, the same
  std::optional<bool> same_robot, same_lidar;  ///< somebody said so, whatever the names; absent: nobody
  std::string place, note;
};

/// Errors of odometry against the lidar on fresh motion, root mean squares over the moves.
struct DriveErrors {
  double straight_metre_length = 0.0;   ///< m per metre of a straight
  double straight_metre_heading = 0.0;  ///< rad per metre of a straight
  double full_turn_heading = 0.0;       ///< rad per full turn on the spot

  bool operator==(const DriveErrors&) const = default;
};
struct ErrorEntry {
  std::string code, what, where, remedy;
};
/// Whether fresh motion has proven the values.
struct ProofEntry {
  std::string outcome;  ///< stored, not_stored, taken_back or in_doubt
  DriveErrors before;
  std::optional<DriveErrors> after;
  std::optional<ErrorEntry> error;
};

struct ProposedValue {
  double value = 0.0, std = -1.0;
  std::string unit;
  double in_force = 0.0;  ///< during the motion
};
struct MoveError {
  double value = 0.0, std = -1.0;
  double spread = -1.0;  ///< of one repetition
};
/// Lengths that moves by hand propose.
struct ProposalEntry {
  std::string method;       ///< straight, spin or square
  std::string measured_by;  ///< lidar or tape
  std::size_t used = 0, left_out = 0;
  bool settled = false;
  std::vector<std::pair<std::string, ProposedValue>> parameters;
  std::vector<std::pair<std::string, MoveError>> errors;  ///< E_s, E_d, E_b
  std::vector<std::string> remarks;
};

}  // namespace odomcalib
