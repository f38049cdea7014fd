// Errors of the lidar: displacement laws, and scans with the error taken out again.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "calib/ingest/sweeps.hpp"
#include "calib/selection/lidar_trace.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/lidar_smooth_term.hpp"

namespace odomcalib::calib::terms::lidar_effect_test {
namespace {

/// Bearings of a lidar that sees 270 degrees.
std::vector<double> front_view() {
  std::vector<double> bearings;
  for (int k = -1350; k <= 1350; ++k) bearings.push_back(k * std::numbers::pi / 1800.0);
  return bearings;
}

std::vector<LidarEffectPtr> all_effects() {
  std::vector<LidarEffectPtr> all = lidar_catalogue(false);
  for (const auto& smooth : lidar_smooths()) all.push_back(smooth);
  all.push_back(make_sector_error(front_view()));
  return all;
}

std::vector<Sighting> sightings() {
  std::vector<Sighting> all;
  for (double bearing = -3.0; bearing < 3.1; bearing += 0.5)
    for (const double range : {0.3, 1.0, 2.7, 6.0})
      for (const double incidence : {-0.9, 0.0, 0.4}) all.push_back({bearing, range, incidence});
  return all;
}

/// Scan of a round room that the effect distorts.
Scan distorted(const LidarEffect& effect, const std::vector<double>& values) {
  Scan scan;
  scan.range_max = 12.0;
  for (int k = 0; k < 360; ++k) {
    const double bearing = (k - 180) * std::numbers::pi / 180.0, range = 3.0 + std::cos(3.0 * bearing);
    const BeamShift shift = effect.total({bearing, range, 0.0}, values);
    scan.angles.push_back(static_cast<float>(bearing + shift.angular));
    scan.ranges.push_back(static_cast<float>(range + shift.radial));
  }
  return scan;
}

TEST(LidarEffect, has_a_shift_for_each_parameter) {
  for (const auto& effect : all_effects())
    for (const Sighting& sighting : sightings())
      EXPECT_EQ(effect->shifts(sighting).size(), effect->parameters().size()) << effect->name();
}

TEST(LidarEffect, total_grows_from_the_shifts) {
  constexpr double kSmall = 1e-7;
  for (const auto& effect : all_effects()) {
    const bool has_more_in_common =  // see below
        effect->name() == "lidar_tilt" || effect->parameters().front().name.starts_with("radial_at");
    if (has_more_in_common) continue;
    const std::size_t count = effect->parameters().size();
    for (std::size_t k = 0; k < count; ++k) {
      std::vector<double> values(count, 0.0);
      values[k] = kSmall;
      for (const Sighting& sighting : sightings()) {
        const BeamShift total = effect->total(sighting, values), unit = effect->shifts(sighting)[k];
        EXPECT_NEAR(total.radial / kSmall, unit.radial, 1e-6) << effect->name();
        EXPECT_NEAR(total.angular / kSmall, unit.angular, 1e-6) << effect->name();
      }
    }
  }
}

TEST(LidarEffect, of_parts_of_the_view_has_no_common_offset) {
  const auto sector = make_sector_error(front_view());
  ASSERT_TRUE(sector);
  ASSERT_EQ(sector->parameters().size(), 18U) << "19 knots from -135 to 135 degrees";
  EXPECT_EQ(sector->parameters().front().name, "radial_at_15");
  std::vector<double> sums(18, 0.0);
  for (int degrees = -120; degrees <= 135; degrees += 15) {
    const auto shifts = sector->shifts({degrees * std::numbers::pi / 180.0, 2.0, 0.0});
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += shifts[k].radial;
  }
  const auto at_end = sector->shifts({-135.0 * std::numbers::pi / 180.0, 2.0, 0.0});
  for (std::size_t k = 0; k < sums.size(); ++k) EXPECT_NEAR(sums[k] + at_end[k].radial, 0.0, 1e-9) << k;
  EXPECT_EQ(sector->shifts({std::numbers::pi, 2.0, 0.0})[3].radial, 0.0) << "not seen";
  std::vector<double> values(18, 0.01);
  values[4] = values[5] = 0.04;  // all but two parts agree
  values.front() = 0.01;
  EXPECT_NEAR(sector->total({1.0, 2.0, 0.0}, values).radial, 0.0, 1e-12);
  EXPECT_NEAR(sector->total({82.0 * std::numbers::pi / 180.0, 2.0, 0.0}, values).radial, 0.03, 1e-12);
  EXPECT_FALSE(make_sector_error({}));
  EXPECT_FALSE(make_sector_error(std::vector<double>(100, 0.1)));
}

TEST(LidarEffect, S3_19_a_tilted_plane_meets_walls_late_along_the_slope_and_not_across) {
  const auto tilt = find_lidar_effect("lidar_tilt");
  const double angle = 0.1, direction = 0.4, stretch = angle * angle / 4.0;
  const std::vector<double> values = {stretch * std::cos(2.0 * direction),
                                      stretch * std::sin(2.0 * direction)};
  const auto told = tilt->quantities(values, std::vector<double>(2, 0.0));
  EXPECT_NEAR(told[0].second.value, angle, 1e-12);
  EXPECT_NEAR(told[1].second.value, direction, 1e-12);
  EXPECT_NEAR(tilt->total({direction, 5.0, 0.0}, values).radial, 5.0 * (1.0 - std::cos(angle)), 1e-12);
  EXPECT_NEAR(tilt->total({direction + std::numbers::pi / 2.0, 5.0, 0.0}, values).radial, 0.0, 1e-12);
}

TEST(LidarEffect, correction_undoes_the_error) {
  const std::vector<std::pair<LidarEffectPtr, std::vector<double>>> cases = {
      {make_range_bias(), {0.03}},
      {make_angle_scale(), {0.002}},
      {find_lidar_effect("lidar_tilt"), {0.002, -0.001}}};
  for (const auto& [effect, values] : cases) {
    const Scan good = distorted(*effect, std::vector<double>(values.size(), 0.0));
    const Scan mended = corrected(distorted(*effect, values), {{effect, values, values, 0.0, 0.0, 0.0}});
    for (std::size_t k = 0; k < good.ranges.size(); ++k) {
      EXPECT_NEAR(mended.ranges[k], good.ranges[k], 1e-4) << effect->name();  // second order is left
      EXPECT_NEAR(mended.angles[k], good.angles[k], 2e-5) << effect->name();
    }
  }
}

/// Half the slope of the error over all that is seen; none of an offset, or of what scans are corrected by.
TEST(LidarEffect, that_bends_ranges_leaves_the_metre_in_doubt) {
  Recording recording;
  recording.scans.resize(1);
  recording.scans.front().ranges.assign(100, 1.5F);
  const auto of_range = lidar_smooths()[2];
  ASSERT_EQ(of_range->covariate(), "range");
  const auto uncertainty = [&](const LidarEffectPtr& effect, const std::vector<double>& values) {
    return selection::range_scale_uncertainty({{effect, values, {}, 0.0, 0.0, 0.0}}, {&recording, 1});
  };
  // Hats over log2 of the range: 10 mm at 1 m, none at 2 m.
  const double slope = -0.01 / (1.5 * std::numbers::ln2);
  EXPECT_NEAR(uncertainty(of_range, {0.0, 0.01, 0.0, 0.0}), 0.5 * std::abs(slope), 1e-5);
  EXPECT_NEAR(uncertainty(of_range, {0.01, 0.01, 0.01, 0.01}), 0.0, 1e-9);
  EXPECT_EQ(uncertainty(find_lidar_effect("lidar_tilt"), {0.1, 0.1}), 0.0);
  EXPECT_EQ(selection::range_scale_uncertainty({}, {&recording, 1}), 0.0);
}

TEST(LidarEffect, a_turn_that_begins_anywhere_is_seen_as_one) {
  Scan scan;
  scan.angle_increment = 2.0 * std::numbers::pi / 300.0;
  scan.ranges.assign(300, 1.0);
  EXPECT_TRUE(ingest::sees_all_round(scan));
  for (int k = 0; k < 300; ++k)
    scan.angles.push_back(static_cast<float>(std::remainder(2.0 - k * 0.0209, 2.0 * std::numbers::pi)));
  EXPECT_TRUE(ingest::sees_all_round(scan)) << "beam by beam, clockwise, across half a turn";
  scan.angles.clear();
  scan.angle_increment *= 300.0 / 299.0;
  EXPECT_FALSE(ingest::sees_all_round(scan)) << "a turn that is stated to be more than one";
  scan.angle_increment *= 299.0 / 300.0;
  scan.ranges.resize(200);
  EXPECT_FALSE(ingest::sees_all_round(scan));
}

TEST(LidarEffect, too_few_pairs_tell_nothing) {
  EXPECT_TRUE(selection::trace_lidar({}, true).empty());
  EXPECT_TRUE(selection::trace_lidar(std::vector<measurement::HeadingPair>(3), true).empty());
}

using ErrorOfBeam = std::function<BeamShift(const Sighting&)>;

/// Disagreement of two scans that face different ways.
/// @param view rad, to either side
measurement::HeadingPair seen_with(const ErrorOfBeam& error, double range, double view,
                                   std::mt19937& random) {
  constexpr double kNoise = 4e-3;  // m
  std::normal_distribution<double> noise(0.0, kNoise);
  std::uniform_real_distribution<double> angle(-view, view), slant(-0.6, 0.6);
  measurement::HeadingPair pair;
  for (int k = 0; k < 60; ++k) {
    measurement::DoubleSighting p;
    p.first = {angle(random), range, 0.0};
    p.second = {angle(random), range, 0.0};
    const double towards = angle(random), tilt = slant(random);
    p.first_beam = p.second_beam = {std::cos(towards), std::sin(towards)};
    p.normal = -Eigen::Vector2d(std::cos(towards + tilt), std::sin(towards + tilt));
    p.arm = range * p.second_beam;
    const BeamShift first = error(p.first), second = error(p.second);
    const Eigen::Vector2d across(-std::sin(towards), std::cos(towards));
    p.distance = p.normal.dot((second.radial - first.radial) * p.first_beam +
                              (second.angular - first.angular) * range * across) +
                 noise(random);
    p.deviation = kNoise;
    pair.points.push_back(p);
  }
  return pair;
}

/// Three of them look far.
std::vector<measurement::HeadingPair> sixty_pairs(const ErrorOfBeam& error, std::mt19937& random,
                                                  double view = 2.3) {
  std::vector<measurement::HeadingPair> pairs(60);
  for (std::size_t k = 0; k < pairs.size(); ++k)
    pairs[k] = seen_with(error, k % 20 == 0 ? 12.0 : 0.8, view, random);
  return pairs;
}

TEST(LidarEffect, that_a_few_wide_views_show_best_is_found) {
  constexpr unsigned kSeed = 3;
  std::mt19937 random(kSeed);
  const auto pairs = sixty_pairs([](const Sighting& s) { return BeamShift{0.0, 4e-3 * s.bearing}; }, random);
  const auto found = selection::trace_lidar(pairs, false);
  ASSERT_FALSE(found.empty()) << "seed " << kSeed;
  EXPECT_EQ(found.front().effect->name(), "angle_scale");
  EXPECT_NEAR(std::abs(found.front().values.front()), 4e-3, 4e-4);
}

TEST(LidarEffect, of_a_part_of_the_view_is_found_there) {
  constexpr unsigned kSeed = 5;
  constexpr double kError = 0.015, kMiddle = 1.0, kHalfWidth = 0.25;  // m, rad, rad
  std::mt19937 random(kSeed);
  const auto pairs = sixty_pairs(
      [](const Sighting& s) {
        return BeamShift{std::abs(s.bearing - kMiddle) < kHalfWidth ? kError : 0.0, 0.0};
      },
      random);
  const auto found = selection::trace_lidar(pairs, false);
  ASSERT_FALSE(found.empty()) << "seed " << kSeed;
  const auto radial = [&](double bearing) {
    double sum = 0.0;
    for (const LidarFinding& finding : found)
      sum += finding.effect->total({bearing, 2.0, 0.0}, finding.values).radial;
    return sum;
  };
  for (const double elsewhere : {-2.0, -1.0, 0.0, 2.0})
    EXPECT_NEAR(radial(kMiddle) - radial(elsewhere), kError, 0.25 * kError)
        << elsewhere << ", seed " << kSeed;
}

TEST(LidarEffect, that_a_name_stood_in_for_takes_its_place) {
  constexpr unsigned kSeed = 6;
  constexpr double kError = 8e-3;  // rad: a head whose disc is off its centre
  std::mt19937 random(kSeed);
  const auto pairs = sixty_pairs(
      [](const Sighting& s) {
        return BeamShift{0.0, kError * std::sin(s.bearing)};
      },
      random, 3.0);
  const auto found = selection::trace_lidar(pairs, false);
  ASSERT_FALSE(found.empty()) << "seed " << kSeed;
  for (const LidarFinding& finding : found)
    EXPECT_EQ(finding.effect->name(), "bearing") << finding.values.front() << ", seed " << kSeed;
}

/// Findings of a head that goes all the way round, in a room of one size.
std::vector<LidarFinding> found_all_round(const std::function<double(double)>& angular,
                                          std::mt19937& random) {
  const auto error = [&](const Sighting& s) { return BeamShift{0.0, angular(s.bearing)}; };
  std::vector<measurement::HeadingPair> pairs(60);
  for (measurement::HeadingPair& pair : pairs) pair = seen_with(error, 2.0, std::numbers::pi, random);
  return selection::trace_lidar(pairs, true);
}

/// A driver's wrong increment, though its steps add up to a turn; a disc off its centre is not taken for it.
TEST(LidarEffect, of_the_scale_of_a_whole_turn_is_named_where_it_is_plain) {
  constexpr unsigned kSeed = 10;
  constexpr double kScale = 5e-3;
  std::mt19937 random(kSeed);
  const auto scaled = found_all_round([](double bearing) { return kScale * bearing; }, random);
  ASSERT_FALSE(scaled.empty()) << "seed " << kSeed;
  EXPECT_EQ(scaled.front().effect->name(), "angle_scale");
  EXPECT_NEAR(scaled.front().values.front(), kScale, 0.05 * kScale);
  const auto off_centre = found_all_round([](double bearing) { return kScale * std::sin(bearing); }, random);
  ASSERT_FALSE(off_centre.empty()) << "seed " << kSeed;
  for (const LidarFinding& finding : off_centre) EXPECT_EQ(finding.effect->name(), "bearing");
}

TEST(LidarEffect, of_none_is_found_in_noise) {
  constexpr unsigned kSeed = 4;
  std::mt19937 random(kSeed);
  for (const bool all_round : {false, true}) {
    const auto pairs = sixty_pairs([](const Sighting&) { return BeamShift{}; }, random);
    EXPECT_TRUE(selection::trace_lidar(pairs, all_round).empty()) << all_round << ", seed " << kSeed;
  }
}

using selection::Rule;
using selection::RuleSet;

/// Chance and scans that it was not fitted to are two tests of their own: noise passes either in some draw.
TEST(LidarEffect, of_none_is_found_in_noise_without_the_rules_against_it) {
  constexpr unsigned kSeed = 4;
  std::mt19937 random(kSeed);
  const auto pairs = sixty_pairs([](const Sighting&) { return BeamShift{}; }, random);
  const RuleSet anything = RuleSet().without(Rule::lidar_size);
  const RuleSet untested = anything.without(Rule::lidar_gain).without(Rule::lidar_significance);
  EXPECT_FALSE(selection::trace_lidar(pairs, false, false, untested).empty()) << "seed " << kSeed;
  EXPECT_TRUE(selection::trace_lidar(pairs, false, false, anything.without(Rule::lidar_gain)).empty());
  EXPECT_TRUE(selection::trace_lidar(pairs, false, false, anything).empty());
}

/// An error of a few pairs is significant, but other pairs do not show it.
TEST(LidarEffect, that_few_scans_show_is_one_without_the_rule_of_its_gain) {
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  auto pairs = sixty_pairs([](const Sighting&) { return BeamShift{}; }, random);
  for (std::size_t k = 0; k < 4; ++k)
    pairs[k] = seen_with(
        [](const Sighting& s) {
          return BeamShift{0.02 * std::cos(s.bearing), 0.0};
        },
        0.8, 2.3, random);
  EXPECT_TRUE(selection::trace_lidar(pairs, false).empty()) << "seed " << kSeed;
  EXPECT_FALSE(selection::trace_lidar(pairs, false, false, RuleSet().without(Rule::lidar_gain)).empty());
}

TEST(LidarEffect, that_is_negligible_is_one_without_the_rule_of_its_size) {
  constexpr unsigned kSeed = 8;
  std::mt19937 random(kSeed);
  const auto pairs = sixty_pairs([](const Sighting& s) { return BeamShift{0.0, 3e-4 * s.bearing}; }, random);
  EXPECT_TRUE(selection::trace_lidar(pairs, false).empty()) << "seed " << kSeed;
  EXPECT_FALSE(selection::trace_lidar(pairs, false, false, RuleSet().without(Rule::lidar_size)).empty());
}

/// Where a name that the rest of an error made superfluous stays, it stands beside that rest.
TEST(LidarEffect, that_stood_in_stays_without_the_rule_of_elimination) {
  constexpr unsigned kSeed = 6;
  constexpr double kError = 8e-3;  // rad: a head whose disc is off its centre
  std::mt19937 random(kSeed);
  const auto pairs = sixty_pairs(
      [](const Sighting& s) {
        return BeamShift{0.0, kError * std::sin(s.bearing)};
      },
      random, 3.0);
  const auto kept = selection::trace_lidar(pairs, false, false, RuleSet().without(Rule::lidar_elimination));
  const auto usual = selection::trace_lidar(pairs, false);
  EXPECT_GT(kept.size(), usual.size()) << "seed " << kSeed;
}

/// Angles that are a little too large here and too small there, too little to be reported: the part of that
/// which a scale explains is no scale, though one of that size would be reported.
TEST(LidarEffect, of_a_small_bend_is_named_a_scale_without_the_rule_of_parts) {
  constexpr double kBend = 1.6e-3, kScale = 1.5e-3;  // rad, rad for each rad
  for (const unsigned seed : {11U, 12U, 13U}) {
    std::mt19937 random(seed);
    const auto bent = sixty_pairs(
        [](const Sighting& s) {
          return BeamShift{0.0, kBend * (std::sin(s.bearing) + std::cos(s.bearing) +
                                         std::sin(2.0 * s.bearing) + std::cos(2.0 * s.bearing))};
        },
        random);
    EXPECT_TRUE(selection::trace_lidar(bent, false).empty()) << "seed " << seed;
    const auto part =
        selection::trace_lidar(bent, false, false, RuleSet().without(Rule::lidar_part_of_an_error));
    ASSERT_EQ(part.size(), 1U) << "seed " << seed;
    EXPECT_EQ(part.front().effect->name(), "angle_scale");
    const auto scaled = sixty_pairs(
        [](const Sighting& s) {
          return BeamShift{0.0, kScale * s.bearing};
        },
        random);
    const auto whole = selection::trace_lidar(scaled, false);
    ASSERT_EQ(whole.size(), 1U) << "seed " << seed;
    EXPECT_EQ(whole.front().effect->name(), "angle_scale") << "explains all of it";
  }
}

}  // namespace
}  // namespace odomcalib::calib::terms::lidar_effect_test
