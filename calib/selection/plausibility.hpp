// Reasons not to add an effect although the data like it.
#pragma once

#include <string>

#include "calib/estimation/joint.hpp"
#include "calib/terms/smooth_term.hpp"

namespace odomcalib::calib::selection {

/// The parameter of the effect, the fit's last, that is outside its physical bounds; empty when none is.
std::string impossibility(const vehicle::Effect& effect, const estimation::FitResult& fit);

/// Why the effect's values, the fit's last, make no sense together; empty when they do.
std::string contradiction(const vehicle::Effect& effect, const estimation::FitResult& fit);

/// A size is so large for the effect that its prior must have kept it from being larger.
bool is_held_back(const vehicle::Effect& effect, const estimation::FitResult& fit);

/// Every size is below the share of its typical size that matters to odometry.
/// @param first of the effect's parameters; without it they are the fit's last
bool is_negligible(const vehicle::Effect& effect, std::size_t first, const estimation::FitResult& fit);
bool is_negligible(const vehicle::Effect& effect, const estimation::FitResult& fit);

/// A sway of the sensor, the smooth term's coefficients being the fit's last, that is no larger than what
/// ticks hide: what a turn that speeds up does between two of them, and the step of a count.
bool is_hidden_by_ticks(const terms::SmoothTerm& smooth, const estimation::FitResult& fit,
                        std::span<const vehicle::DriveModel* const> models);

/// This drive cannot separate the addition from the wheels: it would trade a known geometry for a guess.
/// (With what changes by the day the wheels of one moment are less well known than their mean, which up to
/// ten times is no fault; nor is a length that is still known to a thousandth.)
bool spoils_base(const vehicle::Effect& effect, const estimation::FitResult& before,
                 const estimation::FitResult& after);

/// The same of a term without a name, or that it changes a length by a quarter, which only a name may have to
/// (a track that scrubs).
bool smooth_spoils_base(const vehicle::Effect& smooth, const estimation::FitResult& before,
                        const estimation::FitResult& after);

/// The effect, whose parameters begin at `first`, is no longer needed beside what was added after it: its
/// Wald statistic is not significant at 5 %.
bool is_superfluous(const vehicle::Effect& effect, std::size_t first, const estimation::FitResult& fit);

}  // namespace odomcalib::calib::selection
