// Matchers that bench_pairs compares: one function for each, each in a file of its own, since the libraries'
// headers do not agree with each other.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace odomcalib::bench {

using Points = std::vector<Eigen::Vector2d>;

/// Pose of `scan` in the frame of `reference`, m, m, rad, from the guess zero; nullopt: none found.
using Motion = std::optional<std::array<double, 3>>;

/// Pairs farther apart are no pairs, m: the same for all peers.
inline constexpr double kPeerReach = 0.5;
inline constexpr int kPeerIterations = 50;

/// Point to point, as the library does without further settings.
Motion match_with_pcl(const Points& reference, const Points& scan);
Motion match_with_mrpt(const Points& reference, const Points& scan);

}  // namespace odomcalib::bench
