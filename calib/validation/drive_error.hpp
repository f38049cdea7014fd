// The error that a user feels: that of dead reckoning over a metre, over a full turn and over ten seconds,
// before and after calibration, on data not used in the fit.
#pragma once

#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::calib::validation {

/// One model to be judged: what predicts the motion of each fold's data.
struct JudgedModel {
  const estimation::FitResult* fit =
      nullptr;  ///< each fold is predicted with parameters fitted to the others
  std::vector<bool> fixed;
  vehicle::EffectList effects;
};

/// Straight metre (length, heading), full turn (heading), ten seconds open loop (position, heading).
/// Each is sqrt(sum e^2 / sum a^2) over windows with error e and amount a (metres, turns, 1): a systematic
/// error of a metre counts the same whether the robot drove it in one piece or in three. Intervals: bootstrap
/// over blocks of half a minute, 1000 draws, fixed seed. Figures without at least four windows are left
/// out. All three are held against the same motions: places that the wheels of `full`, fitted without the
/// window's fold, carry to its ends.
/// @param nominal wheel radii and track width before calibration; zero: not known, no "before"
/// @param geometry six parameters alone; null when `full` has no effects
/// @param full gives mount, delay of the clocks, noise and outliers for all three
std::vector<DriveError> drive_errors(std::span<const measurement::FitData> data,
                                     const wheels::BaseParameters& nominal, const JudgedModel* geometry,
                                     const JudgedModel& full);

/// How the error of the position grows with the way driven, judged alike: RMS over windows of each length, of
/// a few lengths. Lengths without at least four windows are left out.
std::vector<ErrorGrowth> error_growth(std::span<const measurement::FitData> data,
                                      const wheels::BaseParameters& nominal, const JudgedModel* geometry,
                                      const JudgedModel& full);

/// The error of position over ten seconds open loop among these; null where the drive was too short for it.
const DriveError* open_loop_position(const std::vector<DriveError>& errors);

/// Parameters of `full` with the wheels of `base` and no effect but those of the reference: how odometry
/// with these wheels compares with the same reference.
Eigen::VectorXd with_wheels(const Eigen::VectorXd& full, const vehicle::EffectList& effects,
                            const wheels::BaseParameters& base);

}  // namespace odomcalib::calib::validation
