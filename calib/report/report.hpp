// From fits to the calibration file's members.
#pragma once

#include "calib/classical/closed_form_options.hpp"
#include "calib/estimation/joint.hpp"
#include "calib/measurement/dataset.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::report {

/// left_wheel_diameter, right_wheel_diameter, track_width, lidar_x, lidar_y, lidar_yaw from radii and mount.
/// @param covariance of the base parameters in radii; fixed ones have zero variance and get no deviation
QuantityList base_quantities(const wheels::BaseParameters& base, const Eigen::MatrixXd& covariance);

/// Adds what the statistics of one recording cannot show: all lengths inherit the error of the metre they
/// were measured with.
/// @param deviation of the metre, relative
Eigen::MatrixXd with_scale_error(const Eigen::MatrixXd& covariance, const wheels::BaseParameters& base,
                                 double deviation);

/// Covariance of the quantities above from that of the radii.
std::vector<std::vector<double>> diameter_covariance(const Eigen::MatrixXd& covariance);

std::vector<std::string> base_quantity_names();

/// The four classical estimators and the closed form on the same pairs: straight, spin, linear,
/// joint_closed_form.
/// @param cuts of the closed form, whose inliers the linear method takes too
std::vector<MethodResult> classical_methods(const measurement::Dataset& dataset, double delay,
                                            const classical::ClosedFormOptions& cuts,
                                            Calibration& calibration);

MethodResult joint_method(const estimation::FitResult& fit);

/// @param pairs of each recording; none where no pair was measured
std::vector<DataUse> data_use(std::span<const Recording> recordings,
                              std::span<const measurement::PairSet> pairs);

/// First and last sample of all recordings whose clock tells the date; nullopt where that of none does.
std::optional<Driven> driven_in(std::span<const Recording> recordings);

}  // namespace odomcalib::calib::report
