// All effects the software knows, of wheels and of the lidar, by name.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/terms/lidar_effect.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "calib/vehicle/parameter_meaning.hpp"

namespace odomcalib::calib::terms {

/// In the fixed order in which they are tried and listed.
const vehicle::EffectList& effect_catalogue();

/// nullptr when there is none. Effects that exist once per wheel share their name and differ by their
/// parameters.
std::shared_ptr<const vehicle::Effect> find_effect(const std::string& name,
                                                   const std::string& first_parameter = {});

/// The effect that has this part of the sensor's clock.
std::shared_ptr<const vehicle::Effect> clock_effect(vehicle::ClockPart part);

/// All effects of that name, e.g. one per wheel.
vehicle::EffectList find_effects(const std::string& name);

/// Every named effect of the lidar.
/// @param all_round whether the head sees all directions, so that its stated steps add up to a turn
const std::vector<LidarEffectPtr>& lidar_catalogue(bool all_round);
/// nullptr when there is none.
LidarEffectPtr find_lidar_effect(const std::string& name);

/// Effects that a stage finds by its own means, beside the search.
std::shared_ptr<const vehicle::Effect> make_scan_skew();
LidarEffectPtr make_range_bias();
/// @param all_round see lidar_catalogue()
LidarEffectPtr make_angle_scale(bool all_round = false);

using vehicle::ParameterMeaning;

/// The meaning that the row of the effect states; of wheels or of the lidar.
/// @return nullptr where there is none, as for a parameter of a file from another version
const ParameterMeaning* meaning_of(std::string_view effect, std::string_view parameter);

/// The unit that the row of the effect states, of wheels or of the lidar.
/// @return nullopt where there is none, as for a parameter of a file from another version
std::optional<std::string> unit_of_effect(const std::string& effect, const std::string& parameter);

}  // namespace odomcalib::calib::terms
