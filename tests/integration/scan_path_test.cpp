// Every scan of a simulated drive placed in the map of its walls.
#include "calib/measurement/scan_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/measurement/scan_surfaces.hpp"
#include "calib/vehicle/step_context.hpp"
#include "calib/wheels/wheel_track.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::calib::scan_path_test {
namespace {

constexpr std::uint64_t kSeed = 2718;
constexpr double kRangeNoise = 0.01;  // m

wheels::BaseParameters base_of(const sim::Geometry& g) {
  return {g.left_diameter / 2.0, g.right_diameter / 2.0, g.track_width, {g.lidar.x, g.lidar.y, g.lidar.yaw}};
}

class ScanPaths : public ::testing::Test {
 protected:
  ScanPaths() {
    sim::SimulationConfig config = sim::standard_config(kSeed);
    config.duration = 80.0;
    run_ = sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern()));
    const wheels::WheelTrack track = wheels::wheel_track_from_ticks(run_.recording);
    model_ =
        std::make_unique<vehicle::DriveModel>(track, vehicle::make_context(track, base_of(config.nominal)));
    truth_ = vehicle::to_vector(base_of(run_.truth));
  }

  [[nodiscard]] measurement::ScanPath placed(const Eigen::VectorXd& p) const {
    return measurement::place_scans(run_.recording, *model_, vehicle::as_span(p), {}, {kRangeNoise});
  }

  [[nodiscard]] math::Pose true_sensor(double t) const {
    const auto sample = std::lower_bound(run_.path.begin(), run_.path.end() - 1, t,
                                         [](const auto& s, double time) { return s.t < time; });
    return compose({sample->pose.x, sample->pose.y, sample->pose.yaw}, base_of(run_.truth).mount);
  }

  /// Root mean square distance of the places from the truth, both seen from the first one.
  [[nodiscard]] double error_of(const measurement::ScanPath& path) const {
    double sum = 0.0;
    for (const measurement::PlacedScan& scan : path.scans) {
      const math::Pose seen = between(path.scans.front().pose, scan.pose);
      const math::Pose real = between(true_sensor(path.scans.front().time), true_sensor(scan.time));
      sum += std::pow(seen.x - real.x, 2) + std::pow(seen.y - real.y, 2);
    }
    return std::sqrt(sum / static_cast<double>(path.scans.size()));
  }

  sim::SimulatedRun run_;
  std::unique_ptr<vehicle::DriveModel> model_;
  Eigen::VectorXd truth_;
};

TEST_F(ScanPaths, SD_05_places_are_those_of_the_drive) {
  const measurement::ScanPath path = placed(truth_);
  ASSERT_TRUE(path.is_usable()) << "seed " << kSeed;
  // The true path is sampled every 20 ms: 4 mm at the drive's 0.4 m/s, half of it on the average.
  EXPECT_LT(error_of(path), 0.006) << "seed " << kSeed;
}

TEST_F(ScanPaths, a_known_map_gives_the_same_places) {
  const measurement::ScanPath path = placed(truth_);
  Eigen::VectorXd other = truth_;
  other.head<3>() *= 1.005;
  const measurement::ScanPath fresh = placed(other);
  const measurement::ScanPath again =
      place_scans(run_.recording, *model_, vehicle::as_span(other), {}, {kRangeNoise}, path);
  std::size_t both = 0;
  for (const measurement::PlacedScan& scan : again.scans) {
    const auto same = std::find_if(fresh.scans.begin(), fresh.scans.end(),
                                   [&](const measurement::PlacedScan& s) { return s.time == scan.time; });
    if (same == fresh.scans.end()) continue;
    ++both;
    EXPECT_NEAR(scan.pose.x, same->pose.x, 1e-3);
    EXPECT_NEAR(scan.pose.y, same->pose.y, 1e-3);
    EXPECT_NEAR(scan.pose.yaw, same->pose.yaw, 1e-3);
  }
  EXPECT_GT(both + 5, fresh.scans.size()) << "seed " << kSeed;
}

TEST_F(ScanPaths, the_motion_in_a_sweep_is_that_of_dead_reckoning) {
  const vehicle::Trajectory trajectory = model_->trajectory(vehicle::as_span(truth_), {});
  const math::Pose mount = base_of(run_.truth).mount;
  for (std::size_t k = 50; k < run_.recording.scans.size(); k += 37) {
    const Scan& scan = run_.recording.scans[k];
    const matching::BeamMotion motion = measurement::motion_in_sweep(trajectory, mount, scan);
    const math::Pose middle = compose(trajectory.at(scan.t + matching::reference_time(scan)), mount);
    for (const double share : {0.0, 0.13, 0.5, 0.77, 1.0}) {
      const double t = 2.0 * share * matching::reference_time(scan);
      const math::Pose expected = between(middle, compose(trajectory.at(scan.t + t), mount));
      EXPECT_NEAR(motion(t).x, expected.x, 1e-5);
      EXPECT_NEAR(motion(t).y, expected.y, 1e-5);
      EXPECT_NEAR(motion(t).yaw, expected.yaw, 1e-5);
    }
  }
}

}  // namespace
}  // namespace odomcalib::calib::scan_path_test
