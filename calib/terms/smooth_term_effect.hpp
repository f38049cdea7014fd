// A smooth term as an effect: its coefficients are parameters of the model.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "calib/terms/smooth_term.hpp"
#include "calib/vehicle/effect.hpp"

namespace odomcalib::calib::terms {

/// The smooth term with splines as smooth as the coefficients are, each bend as it and its neighbours are, at
/// several levels of what is the least (Ruppert and Carroll, Aust. N. Z. J. Stat. 42, 2000).
std::vector<SmoothTerm> as_rough_as(const SmoothTerm& smooth, std::span<const double> coefficients);

std::shared_ptr<const vehicle::Effect> make_smooth_term_effect(const SmoothTerm& smooth);

}  // namespace odomcalib::calib::terms
