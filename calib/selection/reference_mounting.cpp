#include "calib/selection/reference_mounting.hpp"

#include <utility>

#include "calib/selection/criterion.hpp"

namespace odomcalib::calib::selection {
namespace {

MountingOffset mounting_offset_of(const estimation::FitResult& fit) {
  const auto estimate = [&](Eigen::Index k) { return Estimate{fit.parameters(k), fit.covariance(k, k)}; };
  return {estimate(vehicle::kMountX), estimate(vehicle::kMountY), estimate(vehicle::kMountYaw)};
}

measurement::Dataset mounted(measurement::Dataset dataset, bool anywhere) {
  dataset.reference_sits_anywhere = anywhere;
  return dataset;
}

}  // namespace

estimation::Fit mount_reference(estimation::Fit fit, const estimation::Settling& how) {
  if (fit.failure || !fit.dataset.reference_is_base()) return fit;
  estimation::Fit elsewhere = settle(mounted(fit.dataset, true), fit.model, how);
  if (!elsewhere.failure && is_mounted_elsewhere(mounting_offset_of(elsewhere.result))) return elsewhere;
  // Settled once more on the trial's pairs, instead of keeping the fit as it was: it has one more pass behind
  // it then, as every result so far has had, and differs in the last digits.
  return settle(mounted(std::move(elsewhere.dataset), false), std::move(fit.model), how);
}

}  // namespace odomcalib::calib::selection
