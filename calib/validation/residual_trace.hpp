// What an effect looks like in the data: residual with and without it, against the variable it acts by.
#pragma once

#include <span>
#include <vector>

#include "calib/estimators/joint.hpp"
#include "proto/report_data.hpp"

namespace odomcalib::calib {

/// One trace per effect but the quiet ones, which are in the model and too small to be told. "Before" is the
/// model refitted without that effect, "after" the full one; the difference of the two predictions is the
/// effect's pattern. The variable is the one of all observed variables that describes most of the pattern
/// (correlation ratio over quantile bins), and so is the axis: a new effect needs no entry here.
std::vector<ResidualTrace> residual_traces(std::span<const FitData> data, const EffectList& effects,
                                           const FitResult& fit, const std::vector<bool>& fixed,
                                           const EffectList& quiet = {});

}  // namespace odomcalib::calib
