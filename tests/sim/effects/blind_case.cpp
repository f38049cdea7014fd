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

Disturbances draw_effect(Random& random, const BlindOptions& options, BlindAnswer& answer) {
  if (uniform(random, 0.0, 1.0) < options.share_without_effect) return {};
  const EffectKind& kind = effect_kinds()[random() % effect_kinds().size()];
  const double low = std::log(kind.smallest), high = std::log(kind.largest);
  answer.effect = kind.name;
  answer.catalogue_name = kind.catalogue_name;
  answer.depends_on = kind.depends_on;
  answer.unit = kind.unit;
  answer.size = options.size_factor * std::exp(uniform(random, low, high));
  return {kind.make(answer.size, random)};
}

/// Pieces of the guided pattern that end about where they began may come in any order.
std::vector<Manoeuvre> shuffled_pattern(Random& random) {
  std::vector<std::vector<Manoeuvre>> pieces(1);
  double forward = 0.0;
  for (const Manoeuvre& move : guided_pattern()) {
    pieces.back().push_back(move);
    forward += move.speed * move.duration;
    const bool at_home = std::abs(forward) < 1e-9;
    if (at_home) pieces.emplace_back();
  }
  std::shuffle(pieces.begin(), pieces.end(), random);
  std::vector<Manoeuvre> out{{0.0, 0.0, 1.0}};
  for (const auto& piece : pieces) out.insert(out.end(), piece.begin(), piece.end());
  return out;
}

Drive draw_drive(Random& random, const Geometry& nominal, BlindAnswer& answer) {
  const double kind = uniform(random, 0.0, 1.0);
  answer.drive = kind < 0.5 ? "guided" : kind < 0.85 ? "shuffled" : "random";
  if (answer.drive == "guided") return follow(nominal, guided_pattern());
  if (answer.drive == "shuffled") return follow(nominal, shuffled_pattern(random));
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

SimulationConfig draw_config(Random& random, std::uint64_t seed) {
  SimulationConfig config = standard_config(seed);
  config.nominal = draw_nominal(random);
  config.truth = draw_truth(config.nominal, seed);
  config.room = random_room(seed);
  config.body.start = {0.0, 0.0, any_angle(random)};
  config.body.slip_noise = uniform(random, 0.0002, 0.0006);
  config.body.motor.acceleration = config.body.motor.deceleration =
      uniform(random, 0.4, 0.9) / (0.5 * config.nominal.left_diameter);
  config.lidar.turns_per_second = uniform(random, 9.9, 10.1);
  return config;
}

BlindCase attempt(std::uint64_t campaign, unsigned number, int attempt_number, const BlindOptions& options) {
  std::seed_seq sequence{static_cast<unsigned>(campaign), static_cast<unsigned>(campaign >> 32U), number,
                         static_cast<unsigned>(attempt_number)};
  Random random(sequence);
  BlindCase out;
  out.answer.campaign = campaign;
  out.answer.number = number;
  SimulationConfig config = draw_config(random, random());
  const Drive drive = draw_drive(random, config.nominal, out.answer);
  config.disturbances = draw_effect(random, options, out.answer);
  out.run = simulate_recording(config, drive);
  out.answer.truth = config.truth;
  out.answer.least_clearance = out.run.least_clearance;
  return out;
}

}  // namespace

BlindCase make_blind_case(std::uint64_t campaign, unsigned number, const BlindOptions& options) {
  BlindCase out;
  for (int i = 0; i < kAttempts; ++i) {
    out = attempt(campaign, number, i, options);
    if (out.run.least_clearance >= kEnoughClearance) break;
  }
  const std::string label = "blind-" + std::to_string(campaign) + "-" + std::to_string(number);
  out.run.recording.name = label + ".jsonl.gz";
  out.run.recording.robot.robot_id = label;
  return out;
}

std::string answers_json(const std::vector<BlindAnswer>& answers) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BlindAnswer& answer : answers) {
    const Geometry& truth = answer.truth;
    list.push_back({{"campaign", answer.campaign},
                    {"number", answer.number},
                    {"effect", answer.effect},
                    {"catalogue_name", answer.catalogue_name},
                    {"depends_on", answer.depends_on},
                    {"size", answer.size},
                    {"unit", answer.unit},
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
