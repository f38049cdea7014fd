#include "calib/terms/candidate_smooths.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "calib/terms/settings.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"

namespace odomcalib::calib::terms {
namespace {

bool is_unsigned(vehicle::Channel channel) {
  return channel == vehicle::Channel::both_path || channel == vehicle::Channel::sideways_path ||
         channel == vehicle::Channel::yaw_path;
}

/// The values of a covariate, in its unit.
struct Range {
  double low, high;
};

/// A covariate of the drives that are at hand.
struct Driven {
  vehicle::Covariate covariate;
  Range range;
  bool both_ways;  ///< whether the drives go forwards and backwards
};

/// A member of a family has these in place of what is usual.
struct Member {
  std::optional<Basis> basis = {};
  std::size_t memory = vehicle::kUsualMemory;
  bool with_motion = false;
  std::optional<Range> range = {};
};
using Members = std::vector<Member>;

/// A row: terms of one kind that are worth trying.
struct SmoothFamily {
  bool (*has)(vehicle::Covariate);
  /// Empty: those that the covariate usually acts on.
  std::vector<vehicle::Channel> channels;
  /// @param channel the one that the members are for
  Members (*members)(const Driven&, vehicle::Channel channel);
};

template <vehicle::Covariate kOne>
bool is(vehicle::Covariate covariate) {
  return covariate == kOne;
}

/// An unsigned way never changes its sign with the direction: in drives both ways it has a constant that no
/// base parameter has.
Members usual(const Driven& driven, vehicle::Channel channel) {
  if (driven.covariate == vehicle::Covariate::heading && is_unsigned(channel) && driven.both_ways)
    return {{.basis = Harmonics{0, true}}};
  return {{}};
}

Members higher_harmonics(const Driven& /*driven*/, vehicle::Channel /*channel*/) {
  Members members;
  for (int harmonic = kHarmonics + 1; harmonic <= settings::kHighestHarmonic; ++harmonic)
    members.push_back({.basis = Harmonics{harmonic}});
  return members;
}

Members one_wave(const Driven& /*driven*/, vehicle::Channel /*channel*/) { return {{.basis = Harmonics{1}}}; }

Members longest_memory(const Driven& driven, vehicle::Channel /*channel*/) {
  return {{.memory = memories_of(driven.covariate) - 1}};
}

Members relays(const Driven& driven, vehicle::Channel /*channel*/) {
  Members members;
  for (std::size_t memory = 0; memory < memories_of(driven.covariate); ++memory)
    if (is_relay(driven.covariate, memory) &&
        (memory - vehicle::kMemorySpans.size()) % settings::kEveryRelay == 0)
      members.push_back({.basis = Relay{}, .memory = memory});
  return members;
}

/// Periods closer than settings::kCycleStep cycles per recording look alike.
Members cycles(const Driven& driven, vehicle::Channel /*channel*/) {
  Members members;
  const double duration = driven.range.high - driven.range.low;
  for (double number = settings::kFewestCycles;
       number < settings::kMostCycles && duration / number > settings::kShortestCycle_s;
       number += settings::kCycleStep)
    members.push_back({.basis = Cycle{duration / number}, .range = Range{0.0, duration}});
  return members;
}

/// Where one leaves little of the drive, it would hang on a few scans.
Members change_points(const Driven& driven, vehicle::Channel /*channel*/) {
  Members members;
  for (int k = settings::kLeastPart; k <= kChangePoints - settings::kLeastPart; ++k)
    members.push_back({.basis = ChangePoint{driven.range.high * k / kChangePoints},
                       .range = Range{0.0, driven.range.high}});
  return members;
}

Members fading(const Driven& driven, vehicle::Channel /*channel*/) {
  Members members;
  for (const double time_constant : settings::kFadingTimes_s)
    members.push_back({.basis = Decay{time_constant}, .range = Range{0.0, driven.range.high}});
  return members;
}

Members patches(const Driven& /*driven*/, vehicle::Channel /*channel*/) { return {{.basis = Patches{}}}; }

Members of_speed_magnitude(const Driven& driven, vehicle::Channel /*channel*/) {
  const double most = std::max(-driven.range.low, driven.range.high);
  return {{.with_motion = true, .range = Range{-most, most}}};
}

const std::vector<SmoothFamily>& smooth_families() {
  using enum vehicle::Channel;
  using vehicle::Covariate;
  static const std::vector<SmoothFamily> kAll = {
      {[](Covariate) { return true; }, {}, usual},
      {vehicle::is_phase, {}, higher_harmonics},
      // A term that comes late may look like what went before.
      {is<Covariate::turn_acceleration>, {}, longest_memory},
      // A term that stays until the opposite acceleration hardly resembles one that fades.
      {[](Covariate) { return true; }, {}, relays},
      // A drive seldom shows all headings; one wave round the circle is what few of them determine.
      {is<Covariate::heading>, {}, one_wave},
      // Both wheels change as the day goes, one as its brake or its motor does, the heading as the wind does.
      {is<Covariate::time>, {kPeriodicChannels.begin(), kPeriodicChannels.end()}, cycles},
      // A load that is taken up or slips, a tyre that lets its air out, a lidar that is knocked: from one
      // moment on all is different.
      {is<Covariate::time>, {both_travel, track, way_turned}, change_points},
      // A lidar's metre as it warms up, which is a matter of minutes.
      {is<Covariate::time>, {scale}, fading},
      // Patches of what lies on the floor; wheels sink in, both alike.
      {is<Covariate::position>, {both_travel}, patches},
      // Driving and braking need not make a wheel slip alike, whichever way it goes.
      {is<Covariate::acceleration>, {both_travel}, of_speed_magnitude},
      {is<Covariate::left_acceleration>, {left_travel}, of_speed_magnitude},
      {is<Covariate::right_acceleration>, {right_travel}, of_speed_magnitude},
      {is<Covariate::turn_acceleration>, {track}, of_speed_magnitude},
  };
  return kAll;
}

SmoothTerm term_of(const Member& member, const Driven& driven, vehicle::Channel channel) {
  const Range range = member.range.value_or(driven.range);
  SmoothTerm smooth{{driven.covariate, channel}, range.low, range.high};
  if (member.basis) smooth = on_basis(smooth, *member.basis);
  smooth.memory = member.memory;
  smooth.with_motion = member.with_motion;
  return smooth;
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
    const Driven driven{covariate, {low, high}, both_ways};
    for (const SmoothFamily& family : smooth_families()) {
      if (!family.has(covariate)) continue;
      for (const vehicle::Channel channel :
           family.channels.empty() ? channels_of(covariate) : std::span(family.channels))
        for (const Member& member : family.members(driven, channel))
          smooths.push_back(term_of(member, driven, channel));
    }
  }
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
