// Reports of the service on itself, as `odomcalibctl status`, `check` and `params get` show them.
#pragma once

#include "daemon/service/parts/robot_parts.hpp"
#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

/// @param task that runs, or null
std::string activity(const RobotParts& parts, const Task* task);
/// The activity, and which devices are missing: for systemd's STATUS.
std::string one_line(const RobotParts& parts, const Task* task);
ordered_json status_report(const RobotParts& parts, const Task* task);
/// The newest scan: points [x, y], m in the frame of the base, thinned; none where no current scan arrives.
ordered_json scan_report(const Surroundings& surroundings, double now);
/// The configuration in force.
ordered_json description(const Config& config);
/// A row of a check. @param outcome "ok", "warn" or "fail"
ordered_json check_row(const std::string& name, const std::string& outcome, const std::string& found,
                       const std::string& remedy);
/// Rows of what is possible.
ordered_json check_report(const RobotParts& parts);
/// @param calibration whose values are shown beside those in force
/// @param to_be m, what the controller is about to hold, by quantity; those that are not there stay
ordered_json parameter_report(const Drive& drive, const Calibrator& calibrator,
                              const std::optional<Calibration>& calibration, const ParameterMap& to_be = {});

}  // namespace odomcalib
