// A curve as an effect: its coefficients are parameters of the model.
#pragma once

#include <memory>

#include "calib/curves/curve.hpp"
#include "calib/model/effect.hpp"

namespace odomcalib::calib {

std::shared_ptr<const Effect> make_curve_effect(const Curve& curve);

}  // namespace odomcalib::calib
