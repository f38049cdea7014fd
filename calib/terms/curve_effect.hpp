// A curve as an effect: its coefficients are parameters of the model.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "calib/terms/curve.hpp"
#include "calib/vehicle/effect.hpp"

namespace odomcalib::calib::terms {

/// The curve with splines as smooth as the coefficients are, each bend as it and its neighbours are, at
/// several levels of what is the least (Ruppert and Carroll, Aust. N. Z. J. Stat. 42, 2000).
std::vector<Curve> as_rough_as(const Curve& curve, std::span<const double> coefficients);

std::shared_ptr<const vehicle::Effect> make_curve_effect(const Curve& curve);

}  // namespace odomcalib::calib::terms
