// The blind test: robot, room, drive, noise and effect drawn from a seed, the answer kept apart from the
// recording.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/sim/world/simulate.hpp"

namespace odomcalib::sim {

struct BlindEffect {
  std::string name;
  std::string catalogue_name;  ///< nearest name in the catalogue; empty: outside
  std::vector<std::string> depends_on;
  double size = 0.0;
  std::string unit;
};

/// The answer, which the estimators do not see.
struct BlindAnswer {
  std::uint64_t campaign = 0;
  unsigned number = 0;
  std::vector<BlindEffect> effects;  ///< empty: nothing is missing in the model
  std::string drive;                 ///< guided, shuffled or random
  Geometry truth;
  double least_clearance = 0.0;  ///< m
};

struct BlindCase {
  BlindAnswer answer;
  SimulatedRun run;
};

struct BlindOptions {
  double share_without_effect = 0.2;
  double size_factor = 1.0;  ///< scales the range of sizes of every effect
  unsigned effects = 1;      ///< of different kinds, in the recordings that have any
  bool only_catalogue = false;
  bool free_laws = false;         ///< laws of no mechanism instead of effects
  std::vector<std::string> only;  ///< kinds by name; empty: all
  bool any_machine = false;       ///< other lidars, encoders, sizes and durations than the usual robot's
  bool few_speeds = false;        ///< guided drives at a few speeds, with equal rests and pushes
  bool tour = false;              ///< drives at work instead of drives for calibration, in larger rooms
};

/// Same campaign and number, same case. The recording's names give nothing away but campaign and number.
BlindCase make_blind_case(std::uint64_t campaign, unsigned number, const BlindOptions& options = {});

/// Recordings to judge an answer by, which no estimator is given.
struct BlindProof {
  SimulatedRun twin;        ///< same robot, room, drive and noise, without the effects
  SimulatedRun fresh;       ///< same robot with the effects, ten minutes of another drive
  SimulatedRun fresh_twin;  ///< the other drive without the effects
};
BlindProof make_blind_proof(std::uint64_t campaign, unsigned number, const BlindOptions& options = {});

/// The answers as JSON text, in the order given.
std::string answers_json(const std::vector<BlindAnswer>& answers);

}  // namespace odomcalib::sim
