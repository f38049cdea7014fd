#include "calib/terms/candidate_smooths.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "calib/terms/settings.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"

namespace odomcalib::calib::terms {
namespace {

bool is_unsigned(vehicle::Channel channel) {
  return channel == vehicle::Channel::both_path || channel == vehicle::Channel::sideways_path ||
         channel == vehicle::Channel::yaw_path;
}

/// Periods of both wheels, as the day goes, of one, as its brake or its motor does, or of the heading, as the
/// wind turns it. Periods closer than settings::kCycleStep cycles per recording look alike.
void add_periods(double duration, std::vector<SmoothTerm>& smooths) {
  for (double cycles = settings::kFewestCycles;
       cycles < settings::kMostCycles && duration / cycles > settings::kShortestCycle_s;
       cycles += settings::kCycleStep)
    for (const vehicle::Channel channel : kPeriodicChannels)
      smooths.push_back(
          on_basis({{vehicle::Covariate::time, channel}, 0.0, duration}, Cycle{duration / cycles}));
}

/// A load that is taken up or slips, a tyre that lets its air out, a lidar that is knocked: from one moment
/// on all is different. Where it leaves little of the drive, that would hang on a few scans.
void add_change_points(double duration, std::vector<SmoothTerm>& smooths) {
  for (int k = settings::kLeastPart; k <= kChangePoints - settings::kLeastPart; ++k)
    for (const auto channel :
         {vehicle::Channel::both_travel, vehicle::Channel::track, vehicle::Channel::way_turned})
      smooths.push_back(on_basis({{vehicle::Covariate::time, channel}, 0.0, duration},
                                 ChangePoint{duration * k / kChangePoints}));
}

/// A lidar's metre as it warms up, which is a matter of minutes.
void add_fading(double duration, std::vector<SmoothTerm>& smooths) {
  for (const double time_constant : settings::kFadingTimes_s)
    smooths.push_back(
        on_basis({{vehicle::Covariate::time, vehicle::Channel::scale}, 0.0, duration}, Decay{time_constant}));
}

void add_time_constants_about(const SmoothTerm& smooth, const Decay& decay, std::vector<SmoothTerm>& shapes) {
  for (const double factor : settings::kFadingFactors)
    shapes.push_back(on_basis(smooth, Decay{decay.time_constant * factor}));
}

/// Close to where it was found.
void add_change_points_about(const SmoothTerm& smooth, const ChangePoint& event,
                             std::vector<SmoothTerm>& shapes) {
  for (int k = settings::kFirstHalving; k <= settings::kLastHalving; ++k)
    for (const double way : {-1.0, 1.0})
      shapes.push_back(
          on_basis(smooth, ChangePoint{event.moment + std::ldexp(way * smooth.high / kChangePoints, -k)}));
}

void add_degrees_beside(const SmoothTerm& smooth, const Polynomials& found, std::vector<SmoothTerm>& shapes) {
  for (int degree = kPlainest; degree <= kHighestDegree; ++degree)
    if (degree != found.degree) shapes.push_back(on_basis(smooth, Polynomials{degree}));
}

/// The range of the covariate hangs on how it is understood.
void add_memories_beside(const SmoothTerm& smooth, std::span<const vehicle::DriveModel* const> models,
                         std::vector<SmoothTerm>& shapes) {
  const std::size_t memories = vehicle::memories_of(smooth.dependence.covariate);
  for (std::size_t memory = 0; memories > vehicle::kUsualMemory + 1 && memory < memories; ++memory) {
    if (memory == smooth.memory) continue;
    SmoothTerm shape = smooth;
    shape.memory = memory;
    std::tie(shape.low, shape.high) = range_of(smooth.dependence.covariate, models, memory);
    const bool is_as_before =
        is_relay(smooth.dependence.covariate, memory) == (basis_as<Relay>(smooth) != nullptr);
    if (!is_as_before) shape.basis = usual_basis(shape.dependence, memory);
    shapes.push_back(std::move(shape));
  }
}

/// Patches of what lies on the floor; wheels sink in, both alike.
void add_patches(double low, double high, std::vector<SmoothTerm>& smooths) {
  smooths.push_back(
      on_basis({{vehicle::Covariate::position, vehicle::Channel::both_travel}, low, high}, Patches{}));
}

void add_harmonics(const SmoothTerm& smooth, int first, int last, std::vector<SmoothTerm>& smooths) {
  for (int harmonic = first; harmonic <= last; ++harmonic)
    smooths.push_back(on_basis(smooth, Harmonics{harmonic}));
}

/// Driving and braking need not make a wheel slip alike, whichever way it goes.
void add_terms_of_speed_magnitude(std::span<const vehicle::DriveModel* const> models,
                                  std::vector<SmoothTerm>& smooths) {
  for (const vehicle::Dependence& dependence :
       {vehicle::Dependence{vehicle::Covariate::acceleration, vehicle::Channel::both_travel},
        {vehicle::Covariate::left_acceleration, vehicle::Channel::left_travel},
        {vehicle::Covariate::right_acceleration, vehicle::Channel::right_travel},
        {vehicle::Covariate::turn_acceleration, vehicle::Channel::track}}) {
    const auto [low, high] = range_of(dependence.covariate, models);
    const double most = std::max(-low, high);
    if (!(most > 1e-6)) continue;
    smooths.push_back({dependence, -most, most});
    smooths.back().with_motion = true;
  }
}

bool may_have_knots(const vehicle::Dependence& dependence) {
  return (is_signed_speed(dependence.covariate) && dependence.channel != vehicle::Channel::turn_path) ||
         is_acceleration(dependence.covariate);
}

struct Extent {
  double low = 1e300, high = -1e300;
  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Between neighbouring waves, cycles per m.
  [[nodiscard]] double step() const {
    return settings::kWaveStep / std::max(high - low, settings::kSmallestPlace_m);
  }
};

/// The highest frequency whose half disc holds no more than settings::kMostWaves.
double highest_frequency(double x_step, double y_step) {
  return std::min(1.0 / settings::kShortestWave_m,
                  std::sqrt(2.0 * settings::kMostWaves * x_step * y_step / math::kPi));
}

}  // namespace

std::vector<SmoothTerm> candidate_smooths(std::span<const vehicle::DriveModel* const> models) {
  std::vector<SmoothTerm> smooths;
  const bool both_ways = goes_both_ways(models);
  for (int v = 0; v <= static_cast<int>(vehicle::kLastCovariate); ++v) {
    const auto covariate = static_cast<vehicle::Covariate>(v);
    if (models.size() > 1 && (begins_with_the_recording(covariate) || is_memory(covariate))) continue;
    const auto [low, high] = range_of(covariate, models);
    if (!(high - low > 1e-6)) continue;
    for (const vehicle::Channel channel : channels_of(covariate)) {
      const SmoothTerm smooth{{covariate, channel}, low, high};
      const bool has_constant = covariate == vehicle::Covariate::heading && is_unsigned(channel) && both_ways;
      smooths.push_back(has_constant ? on_basis(smooth, Harmonics{0, true}) : smooth);
      if (is_phase(covariate)) add_harmonics(smooth, kHarmonics + 1, settings::kHighestHarmonic, smooths);
      if (covariate ==
          vehicle::Covariate::turn_acceleration) {  // what comes late may look like what went before
        smooths.push_back(smooth);
        smooths.back().memory = vehicle::kSwayLags.size() - 1;
      }
      // A term that stays until the opposite acceleration hardly resembles one that fades.
      for (std::size_t memory = 0; memory < memories_of(covariate); ++memory)
        if (is_relay(covariate, memory) &&
            (memory - vehicle::kMemorySpans.size()) % settings::kEveryRelay == 0) {
          smooths.push_back(on_basis(smooth, Relay{}));
          smooths.back().memory = memory;
        }
      // A drive seldom shows all headings; one wave round the circle is what few of them determine.
      if (covariate == vehicle::Covariate::heading) add_harmonics(smooth, 1, 1, smooths);
    }
    if (covariate == vehicle::Covariate::time) {
      add_periods(high - low, smooths);
      add_change_points(high, smooths);
      add_fading(high, smooths);
    }
    if (covariate == vehicle::Covariate::position) add_patches(low, high, smooths);
  }
  add_terms_of_speed_magnitude(models, smooths);
  return smooths;
}

std::vector<SmoothTerm> other_shapes(const SmoothTerm& smooth,
                                     std::span<const vehicle::DriveModel* const> models) {
  std::vector<SmoothTerm> shapes;
  for (const double roughness : kRoughness) {
    if (!may_have_knots(smooth.dependence)) continue;
    shapes.push_back(on_basis(smooth, Splines{kMostKnots, std::vector<double>(kMostKnots - 1, roughness)}));
  }
  if (const auto* event = basis_as<ChangePoint>(smooth)) add_change_points_about(smooth, *event, shapes);
  if (const auto* decay = basis_as<Decay>(smooth)) add_time_constants_about(smooth, *decay, shapes);
  if (const auto* found = basis_as<Polynomials>(smooth)) add_degrees_beside(smooth, *found, shapes);
  if (basis_as<Surface>(smooth)) shapes.push_back(on_basis(smooth, Patches{}));
  add_memories_beside(smooth, models, shapes);
  for (SmoothTerm& shape : shapes)
    if (!shape.mean.empty()) shape = centred(std::move(shape), models);
  return shapes;
}

std::vector<SmoothTerm> periodic_smooths(std::span<const vehicle::DriveModel* const> models) {
  std::vector<SmoothTerm> waves;
  if (models.size() != 1) return waves;
  Extent x, y;
  for (const vehicle::StepContext& c : models.front()->context()) {
    x.take(c.x);
    y.take(c.y);
  }
  if (!(x.high > x.low) && !(y.high > y.low)) return waves;
  const double highest = highest_frequency(x.step(), y.step());
  const SmoothTerm floor{{vehicle::Covariate::position, vehicle::Channel::both_travel},
                         std::min(x.low, y.low),
                         std::max(x.high, y.high)};
  for (double a = 0.0; a <= highest; a += x.step())
    for (double b = a > 0.0 ? -std::floor(highest / y.step()) * y.step() : y.step(); b <= highest;
         b += y.step()) {
      const double frequency = std::hypot(a, b);
      if (frequency < 1.0 / settings::kLongestWave_m || frequency > highest) continue;
      waves.push_back(on_basis(floor, Wave{a, b}));
    }
  return waves;
}

}  // namespace odomcalib::calib::terms
