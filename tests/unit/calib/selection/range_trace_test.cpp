#include "calib/selection/range_trace.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "calib/terms/lidar_smooth_term.hpp"
#include "tests/unit/calib/room_scans.hpp"

namespace odomcalib::calib::selection::range_trace_test {
namespace {

using test_support::kRoom;

constexpr double kNoise = 0.01;
const matching::BeamMotion kAtRest = [](double) { return math::Pose{}; };

/// Error of a reading, m.
using RangeError = std::function<double(double range, double tangent_of_incidence)>;

/// The tangent of the incidence is the change of the range with the angle, over the range.
Scan wrong_scan(const math::Pose& pose, unsigned seed, const RangeError& error) {
  constexpr double kStep = 1e-6;
  Scan scan = test_support::scan_from(kRoom, pose, kNoise, seed);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (scan.ranges[i] <= 0.0F) continue;
    const auto range_at = [&](double step) {
      return test_support::ray_distance(kRoom, pose.x, pose.y, pose.yaw + scan.angle(i) + step);
    };
    const double range = range_at(0.0);
    const double tangent = std::abs(range_at(kStep) - range_at(-kStep)) / (2.0 * kStep * range);
    scan.ranges[i] += static_cast<float>(error(range, std::min(tangent, 3.0)));
  }
  return scan;
}

math::Pose pose_of(unsigned k) { return {1.2 * std::sin(0.7 * k) - 0.3, 0.7 * std::cos(0.3 * k), 0.9 * k}; }

struct Traced {
  measurement::RangeEvidence evidence;
  measurement::RangeTrace trace;
};

/// A scan from a pose, its noise drawn from the seed.
using Look = std::function<Scan(const math::Pose& pose, unsigned seed)>;

/// Two hundred scans from all over the room, every second of which makes the map.
struct Seen {
  measurement::PlaceOptions options{kNoise, 0.15};
  measurement::WallMap map;
  measurement::PlacedBeams used, others;
};

Seen seen(const Look& look) {
  Seen all;
  for (unsigned k = 0; k < 200; ++k) {
    const Scan scan = look(pose_of(k), 1000 + k);
    if (k % 10 == 0)
      all.map.insert(find_walls(matching::make_surface(scan, kAtRest, kNoise), kNoise), pose_of(k));
    measurement::PlacedBeams& half = k % 2 == 0 ? all.used : all.others;
    half.beams.push_back(measurement::make_beams(scan, kAtRest));
  }
  for (measurement::PlacedBeams* half : {&all.used, &all.others})
    for (std::size_t k = 0; k < half->beams.size(); ++k)
      half->places.push_back(place_scan(all.map, half->beams[k],
                                        pose_of(2 * static_cast<unsigned>(k) + (half == &all.others)),
                                        all.options));
  return all;
}

Traced traced(const Look& look, const RuleSet& rules = {}) {
  Seen all = seen(look);
  const measurement::RangeEvidence evidence =
      adjust_map(all.used.beams, all.options, all.map, all.used.places);
  return {evidence, trace_ranges(evidence, all.used, all.others, all.options, all.map, rules)};
}

Traced traced(const RangeError& error) {
  return traced([&](const math::Pose& pose, unsigned seed) { return wrong_scan(pose, seed, error); });
}

/// Beams point aside by this angle, rad, as a function of the angle that they claim.
using Aside = std::function<double(double angle)>;

Scan askew_scan(const math::Pose& pose, unsigned seed, const Aside& aside) {
  Scan scan = test_support::scan_from(kRoom, pose, kNoise, seed);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto range_at = [&](double angle) {
      return test_support::ray_distance(kRoom, pose.x, pose.y, pose.yaw + angle);
    };
    const double angle = scan.angle(i);
    if (scan.ranges[i] > 0.0F)
      scan.ranges[i] += static_cast<float>(range_at(angle + aside(angle)) - range_at(angle));
  }
  return scan;
}

TEST(RangeTrace, right_ranges_show_nothing) {
  const Traced found = traced([](double, double) { return 0.0; });
  EXPECT_LT(std::abs(found.evidence.values(0)), 3e-3);
  EXPECT_TRUE(found.trace.findings.empty());
  EXPECT_EQ(found.trace.offset, 0.0);
}

TEST(RangeTrace, an_offset_is_named_and_measured_to_a_millimetre) {
  for (const double offset : {0.01, -0.025}) {
    const Traced found = traced([&](double, double) { return offset; });
    ASSERT_EQ(found.trace.findings.size(), 1U);
    const terms::LidarFinding& finding = found.trace.findings[0];
    EXPECT_EQ(finding.effect->name(), "range_bias");
    EXPECT_NEAR(found.trace.offset, offset, 1e-3);
    EXPECT_LT(std::abs(finding.values[0] - offset), 4.0 * finding.deviations[0]);
    EXPECT_LT(finding.after, finding.before);
  }
}

TEST(RangeTrace, an_error_of_slanted_beams_is_not_called_an_offset) {
  for (const double size : {-2e-3, 3e-3}) {
    const Traced found = traced([&](double range, double tangent) { return size * range * tangent; });
    ASSERT_EQ(found.trace.findings.size(), 1U);
    EXPECT_EQ(found.trace.findings[0].effect->name(), "incidence");
    EXPECT_EQ(found.trace.offset, 0.0);
    EXPECT_GT(std::abs(found.evidence.offset_alone), 5e-3);  // as which it would pass, were it alone
  }
}

TEST(RangeTrace, both_are_told_apart) {
  const Traced found = traced([](double range, double tangent) { return 0.02 - 1e-3 * range * tangent; });
  EXPECT_NEAR(found.evidence.values(0), 0.02, 4e-3);
  EXPECT_NEAR(found.evidence.values(1) + 4.0 * found.evidence.values(3), -4e-3, 2e-3);
}

TEST(RangeTrace, errors_below_three_millimetres_are_not_claimed) {
  EXPECT_TRUE(traced([](double, double) { return 0.002; }).trace.findings.empty());
  EXPECT_TRUE(traced([](double range, double t) { return 5e-4 * range * t; }).trace.findings.empty());
}

// Its map is warped, and an offset would explain a part of that. The last one passes all but the gate on what
// is left.
TEST(RangeTrace, a_head_whose_beams_point_aside_has_no_offset) {
  for (const Aside& aside : {Aside([](double angle) { return 0.01 * std::sin(angle); }),
                             Aside([](double angle) { return 0.03 * std::sin(angle); }),
                             Aside([](double angle) { return -0.03 * std::sin(3.0 * angle); })}) {
    const Traced found =
        traced([&](const math::Pose& pose, unsigned seed) { return askew_scan(pose, seed, aside); });
    for (const terms::LidarFinding& finding : found.trace.findings)
      EXPECT_NE(finding.effect->name(), "range_bias") << finding.values[0] << " +- " << finding.deviations[0];
  }
}

TEST(RangeTrace, a_head_whose_beams_point_aside_has_one_without_the_rule_of_its_gain) {
  const Look look = [](const math::Pose& pose, unsigned seed) {
    return askew_scan(pose, seed, [](double angle) { return -0.03 * std::sin(3.0 * angle); });
  };
  const Traced found = traced(look, RuleSet().without(Rule::range_gain));
  ASSERT_FALSE(found.trace.findings.empty());
  EXPECT_EQ(found.trace.findings[0].effect->name(), "range_bias");
}

// The gain of a map from one more adjustment is no gain of the law that it was adjusted with.
TEST(RangeTrace, a_slant_of_which_nothing_is_left_once_the_map_has_settled_is_none) {
  const Seen all = seen([](const math::Pose& pose, unsigned seed) {
    return wrong_scan(pose, seed, [](double, double) { return 0.0; });
  });
  measurement::RangeEvidence passing;
  passing.values(1) = 5e-3;
  passing.covariance *= 1e-8;
  ASSERT_TRUE(shows_slant(passing));
  EXPECT_TRUE(trace_ranges(passing, all.used, all.others, all.options, all.map).findings.empty());
}

TEST(RangeTrace, no_scans_are_no_evidence) {
  const measurement::RangeTrace trace = trace_ranges({}, {}, {}, {}, {});
  EXPECT_TRUE(trace.findings.empty());
}

}  // namespace
}  // namespace odomcalib::calib::selection::range_trace_test
