// The one generator of the simulator, and what is drawn from it.
#pragma once

#include <random>

namespace odomcalib::sim {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

}  // namespace odomcalib::sim
