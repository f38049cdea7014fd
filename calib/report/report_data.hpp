// Fills what a report shows beyond the contract of the calibration file (proto/report_data.hpp).
#pragma once

#include <optional>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/measurement/dataset.hpp"
#include "calib/measurement/sample_pair.hpp"
#include "calib/selection/search_result.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::calib::report {

/// @param plain fit of the base parameters alone
ReportData make_report_data(const measurement::Dataset& dataset, const selection::SearchResult& found,
                            const std::optional<estimation::FitResult>& plain);

/// The measured motions of a solve beside what odometry made of them, for estimators elsewhere.
/// @param fit to the pairs of the dataset: its sensor pose takes measured motions to the base, and the
/// effects say when the sensor measured
std::vector<measurement::SamplePair> sample_pairs(const measurement::Dataset& dataset,
                                                  const vehicle::EffectList& effects,
                                                  const estimation::FitResult& fit);

}  // namespace odomcalib::calib::report
