#include "tests/sim/effects/blind_case.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/sim/effects/effect.hpp"
#include "tests/sim/world/rooms.hpp"

namespace odomcalib::sim {

namespace {

constexpr double kEnoughClearance = 0.25;  // m; nearer the robot would have touched a wall
constexpr int kAttempts = 20;
constexpr double kRest = 0.8;       // s, braking included: robots that are calibrated stand still at times
constexpr double kLongest = 300.0;  // s

BlindEffect describe(const EffectKind& kind, double size) {
  return {kind.name, kind.catalogue_name, kind.depends_on, size, kind.unit};
}

bool may_be_drawn(const EffectKind& kind, const BlindOptions& options) {
  if (options.only_catalogue && kind.catalogue_name.empty()) return false;
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), kind.name) != options.only.end();
}

std::vector<const EffectKind*> drawable_kinds(const BlindOptions& options) {
  std::vector<const EffectKind*> kinds;
  for (const EffectKind& kind : options.free_laws ? free_laws() : effect_kinds())
    if (may_be_drawn(kind, options)) kinds.push_back(&kind);
  return kinds;
}

/// Two effects that one name of the catalogue covers would be one finding.
bool drawn_before(const EffectKind& kind, const std::vector<BlindEffect>& drawn) {
  return std::any_of(drawn.begin(), drawn.end(), [&](const BlindEffect& other) {
    return other.name == kind.name ||
           (!kind.catalogue_name.empty() && other.catalogue_name == kind.catalogue_name);
  });
}

Disturbances draw_effects(Random& random, const BlindOptions& options, BlindAnswer& answer) {
  Disturbances disturbances;
  if (uniform(random, 0.0, 1.0) < options.share_without_effect) return disturbances;
  const auto kinds = drawable_kinds(options);
  while (answer.effects.size() < options.effects) {
    const EffectKind& kind = *kinds[random() % kinds.size()];
    if (drawn_before(kind, answer.effects)) continue;
    const double low = std::log(kind.smallest), high = std::log(kind.largest);
    const double size = options.size_factor * std::exp(uniform(random, low, high));
    answer.effects.push_back(describe(kind, size));
    disturbances.push_back(kind.make(size, random));
  }
  return disturbances;
}

std::vector<Manoeuvre> pattern_for(const BlindOptions& options) {
  return options.few_speeds ? guided_pattern(kRest) : varied_pattern();
}

/// Pieces of a pattern that end about where they began may come in any order.
std::vector<Manoeuvre> shuffled(const std::vector<Manoeuvre>& pattern, Random& random) {
  std::vector<std::vector<Manoeuvre>> pieces(1);
  double forward = 0.0;
  for (const Manoeuvre& move : pattern) {
    pieces.back().push_back(move);
    forward += way_of(move);
    const bool at_home = std::abs(forward) < 1e-9;
    if (at_home) pieces.emplace_back();
  }
  std::shuffle(pieces.begin(), pieces.end(), random);
  std::vector<Manoeuvre> out{{0.0, 0.0, 1.0}};
  for (const auto& piece : pieces) out.insert(out.end(), piece.begin(), piece.end());
  return out;
}

Drive draw_drive(Random& random, const Geometry& nominal, const BlindOptions& options, BlindAnswer& answer) {
  if (options.tour) {
    answer.drive = "tour";
    return tour_drive(nominal, random());
  }
  const double kind = uniform(random, 0.0, 1.0);
  answer.drive = kind < 0.5 ? "guided" : kind < 0.85 ? "shuffled" : "random";
  if (answer.drive == "guided") return follow(nominal, pattern_for(options));
  if (answer.drive == "shuffled") return follow(nominal, shuffled(pattern_for(options), random));
  return random_drive(nominal, random(), 1.1);
}

Geometry draw_nominal(Random& random) {
  Geometry nominal;
  nominal.left_diameter = nominal.right_diameter = uniform(random, 0.12, 0.20);
  nominal.track_width = uniform(random, 0.30, 0.50);
  nominal.lidar = {uniform(random, -0.05, 0.18), uniform(random, -0.04, 0.04), uniform(random, -0.3, 0.3)};
  nominal.ticks_per_rev = 1024.0 * static_cast<double>(1U << random() % 5U);
  return nominal;
}

SimulationConfig draw_config(Random& random, std::uint64_t seed, const BlindOptions& options) {
  SimulationConfig config = standard_config(seed);
  config.duration = std::min(kLongest, total_duration(pattern_for(options)));
  config.nominal = draw_nominal(random);
  config.truth = draw_truth(config.nominal, seed);
  config.room = options.tour ? random_room(seed, kTourRoom) : random_room(seed);
  config.body.start = {0.0, 0.0, any_angle(random)};
  config.body.slip_noise = uniform(random, 0.0002, 0.0006);
  config.body.motor.acceleration = config.body.motor.deceleration =
      uniform(random, 0.4, 0.9) / (0.5 * config.nominal.left_diameter);
  config.lidar.turns_per_second = uniform(random, 9.9, 10.1);
  return config;
}

double any_of(Random& random, std::initializer_list<double> values) {
  return *(values.begin() + random() % values.size());
}

/// Machines on the market: small and large bases, coarse and fine encoders read seldom or often, lidars of 5
/// to 40 turns a second with few or many beams, near- and far-sighted, good and poor.
void draw_machine(Random& random, SimulationConfig& config) {
  const double diameter = uniform(random, 0.06, 0.30);
  Geometry& nominal = config.nominal;
  config.body.motor.acceleration = config.body.motor.deceleration =
      uniform(random, 0.3, 1.5) / (0.5 * diameter);
  nominal.left_diameter = nominal.right_diameter = diameter;
  nominal.track_width = uniform(random, 0.14, 0.60);
  nominal.lidar.yaw = any_angle(random);
  nominal.ticks_per_rev = std::floor(std::exp(uniform(random, std::log(250.0), std::log(65536.0))));
  config.truth = draw_truth(nominal, random());
  config.tick_period = any_of(random, {0.01, 0.02, 0.05, 0.1});
  LidarOptions& lidar = config.lidar;
  lidar.turns_per_second = any_of(random, {5.5, 7.0, 10.0, 12.0, 20.0, 40.0}) * uniform(random, 0.98, 1.02);
  const bool fast = lidar.turns_per_second > 15.0;
  lidar.beams_per_turn =
      static_cast<int>(fast ? any_of(random, {180, 360, 455}) : any_of(random, {180, 360, 720, 1440}));
  lidar.range_noise = std::exp(uniform(random, std::log(0.003), std::log(0.03)));
  lidar.resolution = any_of(random, {0.0, 0.001, 0.004, 0.01});
  lidar.range_max = any_of(random, {6.0, 12.0, 30.0});
  lidar.random_drops = any_of(random, {0.0, 0.01, 0.05});
  config.body.slip_noise = uniform(random, 0.0001, 0.001);
}

/// Lengths that a tape would find: a wheel's diameter is the distance of a turn over pi.
Geometry effective(const SimulationConfig& config) {
  Geometry truth = config.truth;
  for (const auto& disturbance : config.disturbances) {
    truth.left_diameter *= disturbance->roundness(kLeft);
    truth.right_diameter *= disturbance->roundness(kRight);
  }
  return truth;
}

struct Draw {
  SimulationConfig config;
  Drive drive;
  BlindAnswer answer;
};

/// A drive and the disturbances keep state, so every run needs a draw of its own.
Draw draw(std::uint64_t campaign, unsigned number, int attempt, const BlindOptions& options) {
  std::seed_seq sequence{static_cast<unsigned>(campaign), static_cast<unsigned>(campaign >> 32U), number,
                         static_cast<unsigned>(attempt)};
  Random random(sequence);
  Draw out;
  out.answer.campaign = campaign;
  out.answer.number = number;
  out.config = draw_config(random, random(), options);
  if (options.any_machine) draw_machine(random, out.config);
  out.drive = draw_drive(random, out.config.nominal, options, out.answer);
  out.config.disturbances = draw_effects(random, options, out.answer);
  out.answer.truth = effective(out.config);
  return out;
}

struct Attempt {
  BlindCase drawn;
  int number = 0;
};

Attempt first_clear_attempt(std::uint64_t campaign, unsigned number, const BlindOptions& options) {
  Attempt attempt;
  for (; attempt.number < kAttempts; ++attempt.number) {
    Draw one = draw(campaign, number, attempt.number, options);
    attempt.drawn.run = simulate_recording(one.config, one.drive);
    attempt.drawn.answer = std::move(one.answer);
    attempt.drawn.answer.least_clearance = attempt.drawn.run.least_clearance;
    if (attempt.drawn.run.least_clearance >= kEnoughClearance) break;
  }
  return attempt;
}

/// Another drive of ten minutes, with other noise; the whole circle of headings and all speeds. Less, and the
/// ratio of two errors would be uncertain by a fifth.
SimulatedRun fresh_drive(Draw one, const BlindOptions& options) {
  constexpr double kDuration = 600.0;  // s
  one.config.seed += 1000003;
  one.config.duration = kDuration;
  const Geometry& nominal = one.config.nominal;
  return simulate_recording(one.config, options.tour ? tour_drive(nominal, one.config.seed)
                                                     : random_drive(nominal, one.config.seed, 0.9));
}

Draw without_effects(Draw one) {
  one.config.disturbances.clear();
  return one;
}

}  // namespace

BlindCase make_blind_case(std::uint64_t campaign, unsigned number, const BlindOptions& options) {
  BlindCase out = first_clear_attempt(campaign, number, options).drawn;
  const std::string label = "blind-" + std::to_string(campaign) + "-" + std::to_string(number);
  out.run.recording.name = label + ".jsonl.gz";
  out.run.recording.robot.robot_id = label;
  return out;
}

BlindProof make_blind_proof(std::uint64_t campaign, unsigned number, const BlindOptions& options) {
  const int attempt = first_clear_attempt(campaign, number, options).number;
  const auto again = [&] { return draw(campaign, number, attempt, options); };
  BlindProof proof;
  const Draw twin = without_effects(again());
  proof.twin = simulate_recording(twin.config, twin.drive);
  proof.fresh = fresh_drive(again(), options);
  proof.fresh_twin = fresh_drive(without_effects(again()), options);
  return proof;
}

namespace {

nlohmann::ordered_json effects_json(const std::vector<BlindEffect>& effects) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BlindEffect& effect : effects)
    list.push_back({{"name", effect.name},
                    {"catalogue_name", effect.catalogue_name},
                    {"depends_on", effect.depends_on},
                    {"size", effect.size},
                    {"unit", effect.unit}});
  return list;
}

}  // namespace

std::string answers_json(const std::vector<BlindAnswer>& answers) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BlindAnswer& answer : answers) {
    const Geometry& truth = answer.truth;
    list.push_back({{"campaign", answer.campaign},
                    {"number", answer.number},
                    {"effects", effects_json(answer.effects)},
                    {"drive", answer.drive},
                    {"left_wheel_diameter", truth.left_diameter},
                    {"right_wheel_diameter", truth.right_diameter},
                    {"track_width", truth.track_width},
                    {"lidar_pose", {truth.lidar.x, truth.lidar.y, truth.lidar.yaw}},
                    {"least_clearance", answer.least_clearance}});
  }
  return list.dump(2) + "\n";
}

}  // namespace odomcalib::sim
