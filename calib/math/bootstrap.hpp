// Percentile bootstrap over blocks that are independent of each other (Efron, Ann. Statist. 7, 1979).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <random>
#include <vector>

#include "calib/math/settings.hpp"

namespace odomcalib::calib::math {

struct BootstrapInterval {
  double lower = 0.0;  ///< 2.5 % quantile of the figure
  double upper = 0.0;  ///< 97.5 %
};

/// Bootstrap interval of a figure of sums over blocks, settings::kBootstrapDraws draws with replacement.
/// @param blocks not empty; their sums add by +=, and one made by `{}` is zero
/// @param figure double of a sum
template <typename Sum, typename Figure>
BootstrapInterval bootstrap(const std::vector<Sum>& blocks, unsigned seed, const Figure& figure) {
  std::mt19937 engine(seed);
  std::vector<double> figures;
  figures.reserve(settings::kBootstrapDraws);
  for (int draw = 0; draw < settings::kBootstrapDraws; ++draw) {
    Sum sample{};
    for (std::size_t b = 0; b < blocks.size(); ++b) sample += blocks[engine() % blocks.size()];
    figures.push_back(figure(sample));
  }
  std::sort(figures.begin(), figures.end());
  return {figures[static_cast<std::size_t>(0.025 * settings::kBootstrapDraws)],
          figures[static_cast<std::size_t>(0.975 * settings::kBootstrapDraws)]};
}

/// Two sums whose ratio's root is the figure.
struct RatioOfSums {
  double above = 0.0;
  double below = 0.0;
  RatioOfSums& operator+=(const RatioOfSums& other) {
    above += other.above;
    below += other.below;
    return *this;
  }
  [[nodiscard]] double root() const { return std::sqrt(above / std::max(below, 1e-300)); }
};

inline RatioOfSums total_of(const std::map<std::size_t, RatioOfSums>& by_block) {
  RatioOfSums total;
  for (const auto& [block, sums] : by_block) total += sums;
  return total;
}

/// @param by_block not empty
inline BootstrapInterval bootstrap_root(const std::map<std::size_t, RatioOfSums>& by_block, unsigned seed) {
  std::vector<RatioOfSums> blocks;
  blocks.reserve(by_block.size());
  for (const auto& [block, sums] : by_block) blocks.push_back(sums);
  return bootstrap(blocks, seed, [](const RatioOfSums& s) { return s.root(); });
}

}  // namespace odomcalib::calib::math
