// One recording of the blind test: solve it, then open the answer and measure on a fresh drive.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calib/selection/rules.hpp"
#include "proto/calibration/calibration.hpp"
#include "tests/sim/effects/blind_case.hpp"

namespace odomcalib::blind {

/// Root mean square, and the upper end of its 95 % interval.
struct BoundedError {
  double rms = 0.0;
  double upper = 0.0;
};

/// Open-loop odometry error over windows of 10 s against the true path, m and rad.
struct DriveError {
  BoundedError position;
  BoundedError heading;
};

/// Evidence that a calibration is judged by.
enum class Judged {
  by_a_fresh_drive,  ///< beside the plain fit and the robot without the effect, too
  by_its_findings,  ///< and lengths alone: takes a third of the time, and enough of a robot without an effect
};

struct Trial {
  sim::BlindAnswer answer;
  std::vector<std::string> named;               ///< effects in the calibration
  std::vector<std::string> aliases;             ///< of all of them
  std::vector<std::string> depends_on;          ///< of what stays unexplained
  std::array<double, 3> sigmas{};               ///< left, right diameter, track: (estimate - truth) / std
  Judged judged = Judged::by_a_fresh_drive;     ///< otherwise what follows, up to the twin, is zero
  std::array<double, 3> plain_sigmas{};         ///< the same of the plain fit
  std::array<double, 3> residual_over_floor{};  ///< plain held-out residual over noise floor: x, y, yaw
  DriveError before;                            ///< fresh drive, plain fit
  DriveError after;                             ///< fresh drive, calibration found
  DriveError twin;                              ///< robot without the effect: plain fit of its recording
  double solve_seconds = 0.0;                   ///< CPU
  bool refused = false;
};

/// Data by which all solutions of one recording are judged.
struct Examination {
  sim::BlindCase drawn;
  Judged judged = Judged::by_a_fresh_drive;  ///< by_its_findings: what follows is empty
  sim::BlindProof proof = {};
  Calibration plain = {};  ///< the six base parameters, no effects
  DriveError before = {}, twin = {};
};
Examination make_examination(std::uint64_t campaign, unsigned number, const sim::BlindOptions& options,
                             Judged judged);

struct Solution {
  Calibration calibration;
  double seconds = 0.0;  ///< CPU
};
/// Solution of the drawn recording.
Solution solution_of(const Examination& examination, const calib::selection::RuleSet& rules);

/// The solution against the truth.
Trial judge(const Examination& examination, const Solution& solution);

/// @param rules all of them but in an ablation
Trial run_trial(std::uint64_t campaign, unsigned number, const sim::BlindOptions& options,
                Judged judged = Judged::by_a_fresh_drive, const calib::selection::RuleSet& rules = {});

/// To five significant digits: no table has more.
double rounded(double value);

/// One line of JSON, and back; rows of several processes are put together before a table is made.
std::string to_json_line(const Trial& trial);
Trial trial_from_json_line(const std::string& line);

}  // namespace odomcalib::blind
