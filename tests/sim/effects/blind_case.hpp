// The blind test: robot, room, drive, noise and effect drawn from a seed, the answer kept apart from the
// recording.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/sim/world/simulate.hpp"

namespace odomcalib::sim {

/// What the estimators do not see.
struct BlindAnswer {
  std::uint64_t campaign = 0;
  unsigned number = 0;
  std::string effect;          ///< empty: nothing is missing in the model
  std::string catalogue_name;  ///< nearest name in the catalogue; empty: outside
  std::vector<std::string> depends_on;
  double size = 0.0;
  std::string unit;
  std::string drive;  ///< guided, shuffled or random
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
};

/// Same campaign and number, same case. The recording's names give nothing away but campaign and number.
BlindCase make_blind_case(std::uint64_t campaign, unsigned number, const BlindOptions& options = {});

/// The answers as JSON text, in the order given.
std::string answers_json(const std::vector<BlindAnswer>& answers);

}  // namespace odomcalib::sim
