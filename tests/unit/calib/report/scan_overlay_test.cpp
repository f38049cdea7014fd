#include "calib/report/scan_overlay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "calib/solve.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::calib::report::scan_overlay_test {
namespace {

/// Squares of a tenth of a metre that something lies in: walls that lie on each other fill fewer.
std::size_t squares_filled(const std::vector<ScanTrace>& scans, std::array<double, 3> ScanTrace::*of) {
  constexpr double kSquare = 0.1;  // m
  std::set<std::pair<long, long>> filled;
  for (const ScanTrace& scan : scans) {
    const auto& [x, y, yaw] = scan.*of;
    for (const auto& [ahead, left] : scan.points)
      filled.insert({std::lround((x + std::cos(yaw) * ahead - std::sin(yaw) * left) / kSquare),
                     std::lround((y + std::sin(yaw) * ahead + std::cos(yaw) * left) / kSquare)});
  }
  return filled.size();
}

TEST(ScanOverlay, has_thinner_walls_after_than_before) {
  sim::SimulationConfig config = sim::standard_config(7);
  config.duration = 60.0;
  config.nominal.track_width = 1.08 * config.nominal.track_width;
  const auto run = simulate_recording(config, sim::random_drive(config.nominal, 7));
  const Calibration solved = solve({&run.recording, 1}, {{"none"}});
  ASSERT_NE(solved.verdict, Verdict::refused) << solved.reasons.front();
  const auto scans = report_data_of(solved).scans;
  ASSERT_EQ(scans.size(), 8U);
  for (const ScanTrace& scan : scans) EXPECT_GT(scan.points.size(), 50U);
  EXPECT_LT(static_cast<double>(squares_filled(scans, &ScanTrace::after)),
            0.8 * static_cast<double>(squares_filled(scans, &ScanTrace::before)));
}

TEST(ScanOverlay, is_none_where_nothing_was_held_out) {
  sim::SimulationConfig config = sim::standard_config(7);
  config.duration = 18.0;
  const auto run = simulate_recording(config, sim::random_drive(config.nominal, 7));
  EXPECT_TRUE(report_data_of(solve({&run.recording, 1}, {{"none"}})).scans.empty());
}

}  // namespace
}  // namespace odomcalib::calib::report::scan_overlay_test
