// Bases whose sum a smooth term may be: a closed set, each with its own settings.
#pragma once

#include <variant>

#include "calib/terms/bases/change_point.hpp"
#include "calib/terms/bases/decay.hpp"
#include "calib/terms/bases/fading_since.hpp"
#include "calib/terms/bases/harmonics.hpp"
#include "calib/terms/bases/place.hpp"
#include "calib/terms/bases/polynomials.hpp"
#include "calib/terms/bases/relay.hpp"
#include "calib/terms/bases/speed_hats.hpp"
#include "calib/terms/bases/splines.hpp"
#include "calib/terms/bases/sway.hpp"
#include "calib/terms/bases/turn_path.hpp"
#include "calib/terms/bases/wave.hpp"

namespace odomcalib::calib::terms {

/// Each gives the values of its functions in an interval (`values`); one whose coefficients are not all
/// expected to be alike says so (`prior`, `penalty`).
using Basis = std::variant<Polynomials, SpeedHats, Splines, TurnPath, Harmonics, Cycle, FadingSince, Relay,
                           ChangePoint, Decay, Sway, Surface, Patches, Wave>;

/// The plainest basis for a term, in which it is sought first.
/// @param memory which way to understand what happened before, see vehicle::memories_of
Basis usual_basis(const vehicle::Dependence& dependence, std::size_t memory);

}  // namespace odomcalib::calib::terms
