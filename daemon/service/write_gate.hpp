// Conditions that must hold before values are written to the controller.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "daemon/service/parts/drive.hpp"
#include "daemon/service/parts/write_back.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/value_check.hpp"

namespace odomcalib {

/// The axes have torque, or one of them: nothing drives them while a write-back may begin, so it goes.
bool comes_to_rest(const Drive& drive);
Error axes_not_off(const Drive& drive);

/// Why nothing may be written now. Axes that come to rest are waited for, by whoever writes.
std::optional<Error> write_forbidden(const Drive& drive, const WriteBack& write_back);

/// The robot's own lengths, by which values are judged, and where each is stated.
struct NominalLengths {
  ParameterMap values;  ///< m, by quantity; 0: not stated
  std::map<std::string, std::string> from;
};
NominalLengths nominal_lengths(const Drive& drive, const Config& config);

/// Why these values are not this robot's: one band around what is nominal, none around what is present. A
/// controller that was replaced is no dead end, and small steps do not walk away.
std::optional<Error> implausible(const ParameterMap& values, const NominalLengths& nominal);

/// The first parameter of a calibration that no controller and no host may be given, by its path, and why: a
/// unit that is missing or another one, a value or a deviation that is no number or beyond what a robot has.
/// @param unit_of_effect see wrong_value()
std::optional<Error> absurd(const Calibration& calibration, const NominalLengths& nominal,
                            const UnitOfEffect& unit_of_effect);

/// Lengths in force, by the names of the parameters.
ParameterMap present_lengths(const RobotDescription& robot);

}  // namespace odomcalib
