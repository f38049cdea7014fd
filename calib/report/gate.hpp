// The quality gate: may this calibration be written to a robot, and if not, why?
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/calibration/calibration.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::report {

struct GateResult {
  Verdict verdict = Verdict::refused;
  std::vector<std::string> reasons;
  std::string next_step = {};  ///< of the first of the reasons; empty where there is none
};

/// Recordings that disagree about the robot.
struct Disagreement {
  bool refuses = false;  ///< by more than wider deviations could stand for
  std::string reason;
};

/// Samples of one stream of a recording that nothing was made of.
struct Loss {
  double share = 0.0;      ///< of the stream
  std::string text;        ///< what, how many, when and why
  bool of_wheels = false;  ///< not of the reference
};

/// The evidence that the values stand on.
struct VerdictEvidence {
  bool converged = true;
  std::size_t matched = 0;           ///< pairs of scans, where the values come from these
  std::size_t unmatched = 0;         ///< pairs that gave no motion
  std::vector<std::string> remarks;  ///< what else a user should know: sentences
  /// Base quantities with the deviations that the motion leaves, without what is unknown of the effects;
  /// empty: those of the calibration.
  QuantityList measured = {};
  std::vector<DriveError> drive_errors = {};
  std::vector<ResidualAxis> axes = {};  ///< of the residual, with their runs tests
  std::size_t outliers = 0, pairs = 0;  ///< pairs that contradict all others, of all
  std::vector<Loss> losses = {};        ///< of streams that lost any
  std::optional<Disagreement> recordings_apart = std::nullopt;
  bool of_poses = false;                      ///< the reference is poses of the base
  MotionSource motion = MotionSource::ticks;  ///< what told the motion of the wheels
  /// Motion that was hardly driven: classical::missing_motion.
  std::optional<std::string> missing_motion = std::nullopt;
  std::size_t partial = 0;              ///< of the matched pairs, those that leave a direction open
  std::size_t stood = 0;                ///< pairs left out: the wheels turned and the robot stood
  std::size_t too_thin = 0;             ///< of the unmatched, those with too few readings beside each other
  std::size_t readings = 0, beams = 0;  ///< of a scan, medians: beams that met something, of all
};

/// Odometry over ten seconds errs by plainly more than the reference and the wheels' noise make of it.
bool odometry_is_off(const std::vector<DriveError>& errors);

/// Every rule of the table in verdict_rules.hpp, in its order: refused if one refuses, for its reasons alone;
/// accepted with warnings if one warns.
GateResult judge(const Calibration& calibration, const VerdictEvidence& evidence);

/// The next step after an error that refuses a calibration.
std::string next_after(const Error& error);

/// Why a calibration failed, where the recording itself shows it: only of what was refused or fits badly.
/// Where a mistake in the recordings is likelier than a bad drive, each recording is looked at without the
/// wheels (estimation/first_look.hpp). Where that names a mistake, the calibration is refused for it, and has
/// no value of the fit that it spoilt; otherwise it stays as it is.
Calibration explained(std::span<const Recording> recordings, Calibration calibration);

}  // namespace odomcalib::calib::report
