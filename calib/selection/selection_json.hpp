// Findings in the calibration file. Smooth terms: member "smooth terms", a list of {covariate, channel, low,
// high, coefficients}; those of the lidar; change points in words for a user.
#pragma once

#include <string>
#include <vector>

#include "calib/math/se2.hpp"
#include "calib/selection/search_result.hpp"
#include "calib/terms/lidar_effect.hpp"
#include "calib/terms/smooth_term.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::selection {

inline constexpr const char* kSmoothTermsMember = "curves";

struct FittedSmoothTerm {
  terms::SmoothTerm smooth;
  std::vector<double> coefficients;
  std::string
      named_term;  ///< named effect whose function it completes; empty: nothing in the catalogue explains it
};

std::string considered_to_json(const std::vector<Considered>& considered);

std::string smooth_terms_to_json(const std::vector<FittedSmoothTerm>& smooths);

/// Entries that are not understood are left out: a newer program's smooth term must not stop odometry.
std::vector<FittedSmoothTerm> smooth_terms_from_json(const std::string& text);

/// What changed at which moment, by how much, and which state the values stand for.
/// @param event a smooth term that happens at once
/// @param mount of the sensor on the base, since then
std::string event_to_text(const FittedSmoothTerm& event, const math::Pose& mount);

/// The named findings about the lidar.
std::vector<EffectResult> effect_results(const std::vector<terms::LidarFinding>& findings);

/// Member "lidar_smooths": what the lidar's error depends on without a name, and the coefficients.
inline constexpr const char* kLidarSmoothTermsMember = "lidar_curves";
std::string lidar_smooth_terms_to_json(const std::vector<terms::LidarFinding>& findings);

}  // namespace odomcalib::calib::selection
