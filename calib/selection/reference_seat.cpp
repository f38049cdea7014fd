#include "calib/selection/reference_seat.hpp"

#include <utility>

#include "calib/selection/criterion.hpp"

namespace odomcalib::calib::selection {
namespace {

Seat seat_of(const estimation::FitResult& fit) {
  const auto estimate = [&](Eigen::Index k) { return Estimate{fit.parameters(k), fit.covariance(k, k)}; };
  return {estimate(vehicle::kMountX), estimate(vehicle::kMountY), estimate(vehicle::kMountYaw)};
}

measurement::Dataset seated(measurement::Dataset dataset, bool anywhere) {
  dataset.reference_sits_anywhere = anywhere;
  return dataset;
}

}  // namespace

estimation::Fit seat_reference(estimation::Fit fit, const estimation::Settling& how) {
  if (fit.failure || !fit.dataset.reference_is_base()) return fit;
  estimation::Fit elsewhere = settle(seated(fit.dataset, true), fit.model, how);
  if (!elsewhere.failure && sits_elsewhere(seat_of(elsewhere.result))) return elsewhere;
  // Settled once more on the trial's pairs, instead of keeping the fit as it was: it has one more pass behind
  // it then, as every result so far has had, and differs in the last digits.
  return settle(seated(std::move(elsewhere.dataset), false), std::move(fit.model), how);
}

}  // namespace odomcalib::calib::selection
