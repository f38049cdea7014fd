// Trace of an effect in the data: residual with and without it, against the covariate it acts by.
#pragma once

#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::calib::report {

/// One trace per effect but nuisance terms, which are in the model and too small to be reported. "Before" is
/// the model refitted without that effect, "after" the full one; the difference of the two predictions is the
/// effect's pattern. The covariate is the one of all observed covariates that describes most of the pattern
/// (correlation ratio over quantile bins), and so is the axis: a new effect needs no entry here.
std::vector<ResidualTrace> residual_traces(std::span<const measurement::FitData> data,
                                           const vehicle::EffectList& effects,
                                           const estimation::FitResult& fit, const std::vector<bool>& fixed,
                                           const vehicle::EffectList& nuisance = {});

}  // namespace odomcalib::calib::report
