// How far odometry errs by chance, as the filters that come after it take it.
#pragma once

#include <string>

#include "proto/calibration/calibration.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// Parameters of nav2's AMCL: alpha1 to alpha4 with the steps that they hold for. Errors: format, where the
/// file states no noise. Formulas: docs/user/library.md.
Result<std::string> amcl_yaml(const Calibration& calibration, const std::string& where);
/// Covariances of odometry for robot_localization, as diff_drive_controller publishes them. Errors as above.
Result<std::string> robot_localization_yaml(const Calibration& calibration, const std::string& where);
/// Penalties of slam_toolbox's matcher for leaving odometry, with the steps and the grid that they hold
/// for. Errors as above.
Result<std::string> slam_toolbox_yaml(const Calibration& calibration, const std::string& where);

}  // namespace odomcalib::cli
