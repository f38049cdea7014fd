// Matching of scan pairs with exact truth: odomcalib beside a plain point-to-line ICP and other programs'
// matchers on the same pairs in the same run, from the guess zero. CPU time of a pair, from ranges to pose.
// One JSON line for each matcher. Run build/release/bin/bench_pairs FILE.smp.gz [PAIRS].
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>

#include "calib/match.hpp"
#include "calib/matching/nearest.hpp"
#include "calib/math/se2.hpp"
#include "tests/bench/cpu_time.hpp"
#include "tests/bench/pair_matchers.hpp"
#include "tests/unit/calib/scan_pairs.hpp"

namespace odomcalib::bench {
namespace {

// As the sets' own test has it: a match this far from the truth is of another place.
constexpr double kAstray = 0.05;                          // m
constexpr double kAstrayTurn = calib::math::kPi / 180.0;  // rad

// End of the floor's iterations: where it moves by a hundredth of its error; pairs swap to and fro beyond.
constexpr double kSettled = 1e-5;  // m and rad
constexpr int kFloorIterations = 20;

Points points_of(const Scan& scan) {
  Points points;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i)
    if (scan.ranges[i] > 0.0F && scan.ranges[i] < static_cast<float>(scan.range_max))
      points.push_back(static_cast<double>(scan.ranges[i]) *
                       Eigen::Vector2d(std::cos(scan.angle(i)), std::sin(scan.angle(i))));
  return points;
}

/// Gauss-Newton step to the lines through the nearest point and its nearer neighbour in the scan.
Eigen::Vector3d line_step(const Points& reference, const calib::matching::BearingOrder& order,
                          const Points& scan, const Eigen::Vector3d& pose, double reach) {
  Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const Eigen::Rotation2Dd turn(pose(2));
  for (const Eigen::Vector2d& p : scan) {
    const Eigen::Vector2d turned = turn * p, at = turned + pose.head<2>();
    const auto found = order.nearest(at, reach);
    if (!found) continue;
    const std::size_t k = found->index, before = k == 0 ? k : k - 1,
                      after = std::min(k + 1, reference.size() - 1);
    const bool take_before = before != k && (after == k || (reference[before] - at).squaredNorm() <
                                                               (reference[after] - at).squaredNorm());
    const Eigen::Vector2d along = reference[take_before ? before : after] - reference[k];
    if (along.squaredNorm() == 0.0 || along.norm() > reach) continue;
    const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
    const Eigen::Vector3d row(across.x(), across.y(), across.dot(Eigen::Vector2d(-turned.y(), turned.x())));
    normal += row * row.transpose();
    right += row * across.dot(reference[k] - at);
  }
  return normal.ldlt().solve(right);
}

/// The floor: no noise model, no outliers but by distance, no covariance.
Motion match_lines(const Points& reference, const Points& scan) {
  const calib::matching::BearingOrder order(reference);
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();
  double reach = kPeerReach;
  for (int k = 0; k < kFloorIterations; ++k) {
    const Eigen::Vector3d step = line_step(reference, order, scan, pose, reach);
    pose += step;
    if (step.norm() < kSettled) break;
    reach = std::max(0.05, 0.7 * reach);
  }
  return std::array<double, 3>{pose(0), pose(1), pose(2)};
}

Motion match_with_odomcalib(const test_support::ScanPair& pair) {
  const calib::ScanMatch match = calib::match_scans(pair.reference, pair.scan, {});
  if (!match.ok()) return std::nullopt;
  return match.pose;
}

using Matcher = std::function<Motion(const test_support::ScanPair&)>;

Matcher of_points(Motion (*match)(const Points&, const Points&)) {
  return [match](const test_support::ScanPair& pair) {
    return match(points_of(pair.reference), points_of(pair.scan));
  };
}

void measure(const char* name, const char* version, const std::vector<test_support::ScanPair>& pairs,
             const Matcher& match) {
  std::vector<double> times;
  double errors = 0.0, bounds = 0.0;
  std::size_t right = 0;
  for (const test_support::ScanPair& pair : pairs) {
    (void)match(pair);  // the caches as a stream of scans has them
    const double begin = cpu_ms();
    const Motion motion = match(pair);
    times.push_back(cpu_ms() - begin);
    if (!motion) continue;
    const auto& [x, y, yaw] = *motion;
    const double error = std::hypot(x - pair.truth[0], y - pair.truth[1]);
    if (error > kAstray || std::abs(calib::math::wrap_angle(yaw - pair.truth[2])) > kAstrayTurn) continue;
    ++right;
    errors += error * error;
    bounds += pair.translation_bound() * pair.translation_bound();
  }
  std::sort(times.begin(), times.end());
  const auto quantile = [&times](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  std::printf(
      "{\"matcher\": \"%s\", \"version\": \"%s\", \"pairs\": %zu, \"success\": %.4f, \"ratio\": %.3f, "
      "\"quartiles_ms\": [%.4f, %.4f, %.4f], \"worst_ms\": %.4f}\n",
      name, version, pairs.size(), static_cast<double>(right) / static_cast<double>(pairs.size()),
      right > 0 ? std::sqrt(errors / bounds) : 0.0, quantile(0.25), quantile(0.5), quantile(0.75),
      times.back());
  std::fflush(stdout);
}

}  // namespace
}  // namespace odomcalib::bench

int main(int argc, char** argv) {
  using namespace odomcalib;
  auto pairs = argc > 1 ? test_support::read_scan_pairs(argv[1]) : std::vector<test_support::ScanPair>{};
  if (pairs.empty()) return std::fprintf(stderr, "usage: bench_pairs FILE.smp.gz [PAIRS]\n"), 2;
  if (argc > 2) pairs.resize(std::min<std::size_t>(pairs.size(), std::strtoul(argv[2], nullptr, 10)));
  bench::measure("odomcalib", "", pairs, bench::match_with_odomcalib);
  bench::measure("plain point to line", "", pairs, bench::of_points(bench::match_lines));
#ifdef ODOMCALIB_WITH_PCL
  bench::measure("PCL", ODOMCALIB_WITH_PCL, pairs, bench::of_points(bench::match_with_pcl));
#endif
#ifdef ODOMCALIB_WITH_MRPT
  bench::measure("MRPT", ODOMCALIB_WITH_MRPT, pairs, bench::of_points(bench::match_with_mrpt));
#endif
}
