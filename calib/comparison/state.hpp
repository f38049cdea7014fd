// State of a robot by its calibration: values with their covariance, against one metre.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/base_quantities.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/scale.hpp"

namespace odomcalib::calib::comparison {

/// Mean of both wheel diameters, m: what a metre of odometry is proportional to.
inline constexpr const char* kMeanDiameter = "mean_wheel_diameter";

/// Parameters that were estimated, in the order of the file; SI units.
struct State {
  std::vector<std::string> names, units;
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;  ///< against the metre of its own reference
  std::optional<Scale> scale;  ///< of that reference

  [[nodiscard]] std::optional<Eigen::Index> find(const std::string& name) const;
  [[nodiscard]] std::optional<Eigen::Index> find(BaseQuantity quantity) const {
    return find(std::string(name_of(quantity)));
  }
};

/// Fixed parameters, and those without a finite value and deviation, are left out. Where the covariance of
/// the file does not name a parameter its deviation stands alone.
State state_of(const Calibration& calibration);

/// Relation between the metres that the lengths of several calibrations are measured with.
enum class Metre {
  unstated,  ///< no file states one: it is taken to be the same
  common,    ///< the same in all: its error is in all values alike, and cancels
  apart      ///< different ones: the error of each is added to its lengths
};
Metre metre_of(std::span<const State> states);

/// The parameters that they have in common, with the errors of their metres where these are not the same.
std::vector<State> comparable(std::vector<State> states);

struct Estimate {
  double value = 0.0, std = 0.0;
};
/// The mean of both diameters, with their covariance; nullopt where one of them was not estimated.
std::optional<Estimate> mean_diameter(const State& state);

}  // namespace odomcalib::calib::comparison
