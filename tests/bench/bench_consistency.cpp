// Whether a scan match is as good as it says: thousands of pairs in random rooms, their errors in units of
// the stated covariance, and the share of truths outside of the stated 99 % ellipse. Of a hundred pairs one
// is expected there and none is found every third time, so that only large sets tell. Run
// build/release/bin/bench_consistency [PAIRS].
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "calib/match.hpp"
#include "tests/sim/world/random.hpp"
#include "tests/sim/world/rooms.hpp"
#include "tests/unit/calib/match_error.hpp"

namespace {

using namespace odomcalib;

constexpr double kDegrees = std::numbers::pi / 180.0;
constexpr double kQuantile = 11.345;  // chi-square of three degrees of freedom, 99 %
constexpr double kReach = 1.2;        // m from the middle of a room, which is free for 1.9 m

struct Lidar {
  int beams;
  double view;   // rad
  double noise;  // m
  double range_max = 16.0;
};

struct Kind {
  const char* name;
  Lidar lidar;
  double way, turn;  // largest motion: m, rad
};

Scan scan_at(const sim::Room& room, const sim::Pose& pose, const Lidar& lidar, sim::Random& random) {
  std::normal_distribution<double> noise(0.0, lidar.noise);
  Scan scan;
  scan.angle_min = -0.5 * lidar.view;
  scan.angle_increment = lidar.view / lidar.beams;
  scan.range_max = lidar.range_max;
  for (int i = 0; i < lidar.beams; ++i) {
    const auto hit = room.cast({pose.x, pose.y}, pose.yaw + scan.angle_min + scan.angle_increment * i);
    const bool returns =
        hit && hit->range < lidar.range_max && hit->incidence_cosine > std::cos(80.0 * kDegrees);
    scan.ranges.push_back(returns ? static_cast<float>(hit->range + noise(random)) : 0.0F);
  }
  return scan;
}

/// Uniform in a disc and in yaw.
sim::Pose within(double radius, double yaw, sim::Random& random) {
  const double r = radius * std::sqrt(sim::uniform(random, 0.0, 1.0));
  const double bearing = sim::uniform(random, -std::numbers::pi, std::numbers::pi);
  return {r * std::cos(bearing), r * std::sin(bearing), sim::uniform(random, -yaw, yaw)};
}

struct Errors {
  unsigned pairs = 0, right = 0, outside = 0;
  double way = 0.0, yaw = 0.0, normalised = 0.0;  // sums of squares

  void add(const calib::ScanMatch& match, const sim::Pose& motion) {
    ++pairs;
    if (!match.ok()) return;
    const Eigen::Vector3d error = test_support::error_of(match, {motion.x, motion.y, motion.yaw});
    if (error.head<2>().norm() > 0.05 || std::abs(error(2)) > kDegrees) return;
    ++right;
    const double squared = test_support::normalised_squared(match, error);
    way += error.head<2>().squaredNorm();
    yaw += error(2) * error(2);
    normalised += squared;
    if (squared > kQuantile) ++outside;
  }
};

Errors errors_of(const Kind& kind, unsigned pairs) {
  Errors errors;
  for (unsigned seed = 1; seed <= pairs; ++seed) {
    sim::Random random(seed);
    const sim::Room room = sim::random_room(seed);
    const sim::Pose first = within(kReach - kind.way / 2.0, std::numbers::pi, random);
    const sim::Pose motion = within(kind.way, kind.turn, random);
    const Scan reference = scan_at(room, first, kind.lidar, random);
    const Scan scan = scan_at(room, sim::compose(first, motion), kind.lidar, random);
    errors.add(calib::match_scans(reference, scan, {}), motion);
  }
  return errors;
}

void print(const Kind& kind, const Errors& errors) {
  const double right = errors.right;
  std::printf("| %s | %u | %.2f %% | %.2f | %.4f | %.3f +- %.3f | %.2f %% |\n", kind.name, errors.pairs,
              100.0 * right / errors.pairs, 1e3 * std::sqrt(errors.way / right),
              std::sqrt(errors.yaw / right) / kDegrees, errors.normalised / (3.0 * right),
              std::sqrt(2.0 / (3.0 * right)), 100.0 * errors.outside / right);
}

}  // namespace

int main(int argc, char** argv) {
  const auto pairs = static_cast<unsigned>(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 1000);
  const double round = 2.0 * std::numbers::pi;
  const std::array<Kind, 6> kinds{{
      {"720 beams, 10 mm; 0.1 m, 5 deg", {720, round, 0.01}, 0.1, 5.0 * kDegrees},
      {"the same; 0.3 m, 20 deg", {720, round, 0.01}, 0.3, 20.0 * kDegrees},
      {"the same; 1 m, 45 deg", {720, round, 0.01}, 1.0, 45.0 * kDegrees},
      {"720 beams, 30 mm; 0.1 m, 5 deg", {720, round, 0.03}, 0.1, 5.0 * kDegrees},
      {"1081 beams over 270 deg, 10 mm; 0.1 m, 5 deg", {1081, 0.75 * round, 0.01}, 0.1, 5.0 * kDegrees},
      {"360 beams, 20 mm; 0.3 m, 20 deg", {360, round, 0.02}, 0.3, 20.0 * kDegrees},
  }};
  std::puts("| scans; motion up to | pairs | success | RMS, mm | deg | NEES / 3 | outside 99 % |");
  std::puts("| --- | --- | --- | --- | --- | --- | --- |");
  for (const Kind& kind : kinds) print(kind, errors_of(kind, pairs));
}
