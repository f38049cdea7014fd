#include "calib/odometry/dead_reckoning.hpp"

#include <utility>

#include "calib/vehicle/step_twist.hpp"

namespace odomcalib::calib::odometry {

DeadReckoning::DeadReckoning(Correction correction)
    : correction_(std::move(correction)), effects_(correction_.effects, vehicle::kBaseCount) {}

void DeadReckoning::advance(const vehicle::StepContext& interval) {
  before_ = sum_;
  twist_ = twist_of(interval, vehicle::as_span(correction_.parameters), effects_);
  sum_.add(twist_);
}

void DeadReckoning::take_back() {
  sum_ = before_;
  twist_ = {};
}

}  // namespace odomcalib::calib::odometry
