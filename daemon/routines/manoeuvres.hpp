// Single manoeuvres of about a minute, each for one question that a calibration may leave open.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "daemon/routines/builder.hpp"
#include "daemon/routines/pattern.hpp"

namespace odomcalib::routines {

/// For the free area of the options.
Builder builder_for(const PatternOptions& options);

void straights_on_four_headings(Builder& build);

/// How long a robot has to stand until something sticks only stops of different lengths can tell.
void vary_rests(std::span<Move> moves);
/// How hard a push has to be until something gives way only pushes of different strengths can tell.
void vary_pushes(std::span<Move> moves);

/// straights, slow_straights, turns, arcs, accelerations, reversals, headings; nullopt for another name.
std::optional<Plan> manoeuvre_plan(const std::string& name, const PatternOptions& options);

}  // namespace odomcalib::routines
