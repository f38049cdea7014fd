// Values of a calibration file are checked here for all who show, compare, use or write them.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "proto/calibration/calibration.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// Unit that a parameter of an effect has in this program; nullopt where it does not know the parameter.
/// Empty: nobody knows any.
using UnitOfEffect =
    std::function<std::optional<std::string>(const std::string& effect, const std::string& parameter)>;

/// The first parameter whose unit is not its own, "m" or "rad" for those of the base, by its path; of an
/// effect one that is none of SI. A file made by hand may leave units out: they are these. Nobody reads a
/// value in another unit as what it is. Also a base parameter that is beyond what a robot has, where the file
/// does not say itself that it was refused. A value or deviation that is no number is not looked at
/// (non_finite_value).
/// @param where file, or what else the error is to name
std::optional<Error> wrong_value(const Calibration& calibration, const UnitOfEffect& unit_of_effect,
                                 const std::string& where);

}  // namespace odomcalib
