#include "calib/terms/parameter_meaning.hpp"

#include <algorithm>
#include <array>

namespace odomcalib::calib::terms {
namespace {

constexpr std::array<ParameterMeaning, 50> kMeanings = {{
    {"time_offset", "offset", "by which scans are stamped later than counts of the same moment"},
    {"time_offset", "smoothing", "of the counts: half the square of a filter's time constant"},
    {"clock_drift", "rate", "by which the two clocks drift apart"},
    {"encoder_lag", "left_less_right", "age of the left wheel's counts less that of the right wheel's"},
    {"scan_skew", "c",
     "share of left turns that the sweeps do not see, and of right turns that they see twice, per rad/s"},
    {"wheel_eccentricity", "left_cos",
     "share by which the left radius varies as the wheel turns: cosine part"},
    {"wheel_eccentricity", "left_sin", "share by which the left radius varies as the wheel turns: sine part"},
    {"wheel_eccentricity", "right_cos",
     "share by which the right radius varies as the wheel turns: cosine part"},
    {"wheel_eccentricity", "right_sin",
     "share by which the right radius varies as the wheel turns: sine part"},
    {"tick_loss", "left_kappa",
     "share by which the left wheel goes further than it counts, above the threshold"},
    {"tick_loss", "right_kappa",
     "share by which the right wheel goes further than it counts, above the threshold"},
    {"tick_loss", "threshold", "speed of the wheel above which counts are lost"},
    {"tick_loss", "width", "range of speed over which the loss sets in"},
    {"backlash", "left_play", "angle that the left motor turns before the wheel follows, after a reversal"},
    {"backlash", "right_play", "angle that the right motor turns before the wheel follows, after a reversal"},
    {"backlash", "spread", "angle over which it is missed; 0: at once"},
    {"direction_dependent_diameter", "left_kappa",
     "share by which the left wheel is larger when it rolls back"},
    {"direction_dependent_diameter", "right_kappa",
     "share by which the right wheel is larger when it rolls back"},
    {"speed_dependent_radius", "kappa", "share by which both wheels grow per m/s"},
    {"speed_dependent_radius", "half_speed",
     "speed at which half of the growth is reached; 0: it has no end"},
    {"acceleration_slip", "k", "share of its way that a wheel slips per m/s^2 of acceleration"},
    {"acceleration_slip", "side", "1: when it drives; -1: when it brakes; 0: both"},
    {"lateral_slip", "k", "way outwards in a bend, per metre driven and rad/s of turn rate"},
    {"lateral_slip", "k_tyre",
     "way outwards in a bend, per metre driven and m/s^2 of centripetal acceleration"},
    {"lateral_slip", "relaxation", "way over which the tyres take that up; 0: at once"},
    {"speed_dependent_track", "kappa",
     "share by which the effective track width grows per rad/s of turn rate"},
    {"track_depends_on_motion", "kappa",
     "share by which the effective track width is larger in a spin than in a wide bend"},
    {"track_depends_on_motion", "arm", "radius of the bend that is half a spin, in track widths"},
    {"turn_direction_asymmetry", "kappa",
     "share by which the effective track width is larger in left turns than in right ones"},
    {"caster_kick", "kappa", "turn after a reversal, to the side that changes with the direction of travel"},
    {"caster_kick", "kappa_turn", "turn after a reversal, to the side that the turn before gives"},
    {"caster_kick", "kappa_side", "turn after a reversal, always to the same side"},
    {"caster_kick", "length", "way over which it fades to a third"},
    {"caster_kick", "order",
     "2: it rises before it fades; 1: it fades from the reversal on; 0: it follows the caster's angle"},
    {"caster_kick", "lean", "angle that the caster keeps when it has settled"},
    {"stop_settling", "turn", "turn that follows a stop, uncounted; negative: back"},
    {"stop_settling", "way", "way that follows a stop, uncounted; negative: back"},
    {"stop_settling", "lasting", "1: a turn stays wound up until another one; 0: until the next stop"},
    {"stop_settling", "speed", "speed before the stop at which these sizes hold; 0: at any"},
    {"drift_with_time", "common", "share by which both diameters grow in 100 s"},
    {"drift_with_time", "differential",
     "share by which the right diameter grows and the left one shrinks in 100 s"},
    {"drift_with_time", "time_constant", "of that growth"},
    {"floor_slope", "kappa_x", "share of its way that the robot creeps back when it heads along x"},
    {"floor_slope", "kappa_y", "share of its way that the robot creeps back when it heads along y"},
    {"carpet", "p_x", "way along x of the room, per metre driven on any heading"},
    {"carpet", "p_y", "way along y of the room, per metre driven on any heading"},
    {"range_bias", "offset", "by which every range is too long"},
    {"angle_scale", "epsilon", "share by which the angles between beams are larger than true"},
    {"lidar_tilt", "stretch_cos",
     "share by which ranges ahead and behind are too long, and those at the sides too short"},
    {"lidar_tilt", "stretch_sin",
     "share by which ranges ahead left and behind right are too long, and the others too short"},
}};

}  // namespace

std::span<const ParameterMeaning> parameter_meanings() { return kMeanings; }

std::string_view meaning_of(std::string_view effect, std::string_view parameter) {
  const auto found = std::find_if(kMeanings.begin(), kMeanings.end(), [&](const ParameterMeaning& row) {
    return row.effect == effect && row.parameter == parameter;
  });
  return found == kMeanings.end() ? std::string_view{} : found->is;
}

}  // namespace odomcalib::calib::terms
