// One line per effect file; catalogue.cpp puts them in order.
#pragma once

#include <memory>

#include "calib/vehicle/effect.hpp"

namespace odomcalib::calib::terms {

std::shared_ptr<const vehicle::Effect> make_acceleration_slip();
std::shared_ptr<const vehicle::Effect> make_backlash();
std::shared_ptr<const vehicle::Effect> make_carpet();
std::shared_ptr<const vehicle::Effect> make_caster_kick();
std::shared_ptr<const vehicle::Effect> make_clock_drift();
std::shared_ptr<const vehicle::Effect> make_direction_dependent_diameter();
std::shared_ptr<const vehicle::Effect> make_drift_with_time();
std::shared_ptr<const vehicle::Effect> make_encoder_lag();
std::shared_ptr<const vehicle::Effect> make_floor_slope();
std::shared_ptr<const vehicle::Effect> make_lateral_slip();
std::shared_ptr<const vehicle::Effect> make_scan_skew();
std::shared_ptr<const vehicle::Effect> make_speed_dependent_radius();
std::shared_ptr<const vehicle::Effect> make_speed_dependent_track();
std::shared_ptr<const vehicle::Effect> make_stop_settling();
std::shared_ptr<const vehicle::Effect> make_tick_loss();
std::shared_ptr<const vehicle::Effect> make_time_offset();
std::shared_ptr<const vehicle::Effect> make_track_depends_on_motion();
std::shared_ptr<const vehicle::Effect> make_turn_direction_asymmetry();
std::shared_ptr<const vehicle::Effect> make_wheel_eccentricity_left();
std::shared_ptr<const vehicle::Effect> make_wheel_eccentricity_right();

}  // namespace odomcalib::calib::terms
