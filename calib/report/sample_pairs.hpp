// The measured motions of a solve beside what odometry made of them, for estimators elsewhere.
#pragma once

#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/measurement/dataset.hpp"
#include "calib/measurement/sample_pair.hpp"

namespace odomcalib::calib::report {

/// @param fit to the pairs of the dataset: its sensor pose takes measured motions to the base, and the
/// effects say when the sensor measured
std::vector<measurement::SamplePair> sample_pairs(const measurement::Dataset& dataset,
                                                  const vehicle::EffectList& effects,
                                                  const estimation::FitResult& fit);

}  // namespace odomcalib::calib::report
