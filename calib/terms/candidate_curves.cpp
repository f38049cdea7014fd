#include "calib/terms/candidate_curves.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "calib/terms/curve_on_drives.hpp"

namespace odomcalib::calib::terms {
namespace {

constexpr std::size_t kEvery = 3;    ///< relay is asked for: the others are found by their neighbours
constexpr int kHighestHarmonic = 8;  ///< poles of encoder magnets, lugs, spokes

using Carriers = std::vector<vehicle::Carrier>;

/// In drives both ways a defect of the signed way and one of the unsigned way are two laws. What one wheel
/// does moves the base sideways by no mechanism: such a law, found in straights and spins, was nonsense in
/// circles.
Carriers carriers_of(vehicle::Variable variable) {
  using enum vehicle::Carrier;
  switch (variable) {
    case vehicle::Variable::left_speed:
      return {left_travel, left_path, right_travel, right_path};
    case vehicle::Variable::right_speed:
      return {right_travel, right_path, left_travel, left_path};
    case vehicle::Variable::wheel_speed:
      return {both_travel};
    case vehicle::Variable::left_phase:
    case vehicle::Variable::left_since_reversal:
      return {left_travel};
    case vehicle::Variable::right_phase:
    case vehicle::Variable::right_since_reversal:
      return {right_travel};
    case vehicle::Variable::left_acceleration:
      return {left_travel, left_path};
    case vehicle::Variable::right_acceleration:
      return {right_travel, right_path};
    case vehicle::Variable::acceleration:
      return {both_travel, both_path, track, sideways_path, yaw_path};
    case vehicle::Variable::turn_acceleration:
      return {sensor_yaw};
    case vehicle::Variable::speed:
      return {both_travel, left_travel, right_travel,  track,   sideways,
              turn_side,   both_path,   sideways_path, yaw_path};
    case vehicle::Variable::turn_rate:
      return {both_travel, left_travel, right_travel, track,      sideways,      turn_path,
              turn_side,   both_path,   left_path,    right_path, sideways_path, yaw_path};
    case vehicle::Variable::lateral_acceleration:
      return {sideways, sideways_path, track, both_travel, left_travel, right_travel, both_path, yaw_path};
    case vehicle::Variable::time:
      return {both_travel, left_travel, right_travel, track, sideways, turn_side, scale, yaw_path};
    case vehicle::Variable::heading:
    case vehicle::Variable::position:
      return {both_travel, left_travel, right_travel, both_path, sideways_path, yaw_path};
    case vehicle::Variable::since_reversal:
    case vehicle::Variable::since_stop:
    case vehicle::Variable::previous_turn:
      return {both_travel, left_travel, right_travel, track, sideways_path, yaw_path};
    case vehicle::Variable::distance:
      return {};
    case vehicle::Variable::previous_push:
      return {both_travel, left_travel, right_travel, track};
  }
  return {};
}

bool is_unsigned(vehicle::Carrier carrier) {
  return carrier == vehicle::Carrier::both_path || carrier == vehicle::Carrier::sideways_path ||
         carrier == vehicle::Carrier::yaw_path;
}

/// Of both wheels, as the day goes, of one, as its brake or its motor does, or of the heading, as the wind
/// turns it. Periods closer than kStep cycles per recording look alike.
void add_periods(double duration, std::vector<Curve>& curves) {
  constexpr double kShortest = 8.0;  // s
  constexpr double kFewestCycles = 1.5;
  constexpr double kStep = 0.7;  // cycles
  for (double cycles = kFewestCycles; duration / cycles > kShortest; cycles += kStep)
    for (const auto carrier : {vehicle::Carrier::both_travel, vehicle::Carrier::left_travel,
                               vehicle::Carrier::right_travel, vehicle::Carrier::yaw_path})
      curves.push_back(
          on_basis({{vehicle::Variable::time, carrier}, 0.0, duration}, Cycle{duration / cycles}));
}

/// A load that is taken up or slips, a tyre that lets its air out, a lidar that is knocked: from one moment
/// on all is different. Where it leaves little of the drive, that would hang on a few scans.
void add_moments(double duration, std::vector<Curve>& curves) {
  constexpr int kLeast = 2;  // parts of the drive
  for (int k = kLeast; k <= kMoments - kLeast; ++k)
    for (const auto carrier :
         {vehicle::Carrier::both_travel, vehicle::Carrier::track, vehicle::Carrier::way_turned})
      curves.push_back(on_basis({{vehicle::Variable::time, carrier}, 0.0, duration},
                                ChangePoint{duration * k / kMoments}));
}

/// A lidar's metre as it warms up, which is a matter of minutes.
void add_fading(double duration, std::vector<Curve>& curves) {
  for (const double time_constant : {30.0, 100.0})
    curves.push_back(
        on_basis({{vehicle::Variable::time, vehicle::Carrier::scale}, 0.0, duration}, Decay{time_constant}));
}

void add_time_constants_about(const Curve& curve, const Decay& decay, std::vector<Curve>& shapes) {
  for (const double factor : {0.5, 0.71, 1.41, 2.0})
    shapes.push_back(on_basis(curve, Decay{decay.time_constant * factor}));
}

/// Close to where it was found.
void add_moments_about(const Curve& curve, const ChangePoint& event, std::vector<Curve>& shapes) {
  for (int k = 3; k <= 5; ++k)
    for (const double way : {-1.0, 1.0})
      shapes.push_back(
          on_basis(curve, ChangePoint{event.moment + std::ldexp(way * curve.high / kMoments, -k)}));
}

void add_degrees_beside(const Curve& curve, const Polynomials& found, std::vector<Curve>& shapes) {
  for (int degree = kPlainest; degree <= kDegrees; ++degree)
    if (degree != found.degree) shapes.push_back(on_basis(curve, Polynomials{degree}));
}

/// The range of the variable hangs on how it is understood.
void add_memories_beside(const Curve& curve, std::span<const vehicle::DriveModel* const> models,
                         std::vector<Curve>& shapes) {
  const std::size_t memories = vehicle::memories_of(curve.law.variable);
  for (std::size_t memory = 0; memories > vehicle::kUsualMemory + 1 && memory < memories; ++memory) {
    if (memory == curve.memory) continue;
    Curve shape = curve;
    shape.memory = memory;
    std::tie(shape.low, shape.high) = range_of(curve.law.variable, models, memory);
    const bool is_as_before = is_relay(curve.law.variable, memory) == (basis_as<Relay>(curve) != nullptr);
    if (!is_as_before) shape.basis = usual_basis(shape.law, memory);
    shapes.push_back(std::move(shape));
  }
}

/// Of what lies on the floor; wheels sink in, both alike.
void add_patches(double low, double high, std::vector<Curve>& curves) {
  curves.push_back(
      on_basis({{vehicle::Variable::position, vehicle::Carrier::both_travel}, low, high}, Patches{}));
}

void add_harmonics(const Curve& curve, int first, int last, std::vector<Curve>& curves) {
  for (int harmonic = first; harmonic <= last; ++harmonic)
    curves.push_back(on_basis(curve, Harmonics{harmonic}));
}

/// What drives a wheel and what brakes it need not slip alike, whichever way it goes.
void add_laws_of_pace(std::span<const vehicle::DriveModel* const> models, std::vector<Curve>& curves) {
  for (const vehicle::Law& law :
       {vehicle::Law{vehicle::Variable::acceleration, vehicle::Carrier::both_travel},
        {vehicle::Variable::left_acceleration, vehicle::Carrier::left_travel},
        {vehicle::Variable::right_acceleration, vehicle::Carrier::right_travel},
        {vehicle::Variable::turn_acceleration, vehicle::Carrier::track}}) {
    const auto [low, high] = range_of(law.variable, models);
    const double most = std::max(-low, high);
    if (!(most > 1e-6)) continue;
    curves.push_back({law, -most, most});
    curves.back().with_motion = true;
  }
}

bool may_have_knots(const vehicle::Law& law) {
  return (is_signed_speed(law.variable) && law.carrier != vehicle::Carrier::turn_path) ||
         is_acceleration(law.variable);
}

}  // namespace

std::vector<Curve> candidate_curves(std::span<const vehicle::DriveModel* const> models) {
  std::vector<Curve> curves;
  const bool both_ways = goes_both_ways(models);
  for (int v = 0; v <= static_cast<int>(vehicle::kLastVariable); ++v) {
    const auto variable = static_cast<vehicle::Variable>(v);
    if (models.size() > 1 && (begins_with_the_recording(variable) || is_memory(variable))) continue;
    const auto [low, high] = range_of(variable, models);
    if (!(high - low > 1e-6)) continue;
    for (const vehicle::Carrier carrier : carriers_of(variable)) {
      const Curve curve{{variable, carrier}, low, high};
      const bool has_constant = variable == vehicle::Variable::heading && is_unsigned(carrier) && both_ways;
      curves.push_back(has_constant ? on_basis(curve, Harmonics{0, true}) : curve);
      if (is_phase(variable)) add_harmonics(curve, kHarmonics + 1, kHighestHarmonic, curves);
      if (variable ==
          vehicle::Variable::turn_acceleration) {  // what comes late may look like what went before
        curves.push_back(curve);
        curves.back().memory = vehicle::kSwayLags.size() - 1;
      }
      // What stays until the opposite push hardly resembles what fades.
      for (std::size_t memory = 0; memory < memories_of(variable); ++memory)
        if (is_relay(variable, memory) && (memory - vehicle::kMemorySpans.size()) % kEvery == 0) {
          curves.push_back(on_basis(curve, Relay{}));
          curves.back().memory = memory;
        }
      // A drive seldom shows all headings; one wave round the circle is what few of them can tell.
      if (variable == vehicle::Variable::heading) add_harmonics(curve, 1, 1, curves);
    }
    if (variable == vehicle::Variable::time) {
      add_periods(high - low, curves);
      add_moments(high, curves);
      add_fading(high, curves);
    }
    if (variable == vehicle::Variable::position) add_patches(low, high, curves);
  }
  add_laws_of_pace(models, curves);
  return curves;
}

std::vector<Curve> other_shapes(const Curve& curve, std::span<const vehicle::DriveModel* const> models) {
  std::vector<Curve> shapes;
  for (const double roughness : kRoughness) {
    if (!may_have_knots(curve.law)) continue;
    shapes.push_back(on_basis(curve, Splines{kMostKnots, std::vector<double>(kMostKnots - 1, roughness)}));
  }
  if (const auto* event = basis_as<ChangePoint>(curve)) add_moments_about(curve, *event, shapes);
  if (const auto* decay = basis_as<Decay>(curve)) add_time_constants_about(curve, *decay, shapes);
  if (const auto* found = basis_as<Polynomials>(curve)) add_degrees_beside(curve, *found, shapes);
  if (basis_as<Surface>(curve)) shapes.push_back(on_basis(curve, Patches{}));
  add_memories_beside(curve, models, shapes);
  for (Curve& shape : shapes)
    if (!shape.mean.empty()) shape = centred(std::move(shape), models);
  return shapes;
}

}  // namespace odomcalib::calib::terms
