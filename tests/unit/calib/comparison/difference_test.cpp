#include "calib/comparison/difference.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/unit/calib/comparison/calibrations.hpp"

namespace odomcalib::calib::comparison::difference_test {
namespace {

using test_support::drawn;
using test_support::TrueState;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;

std::vector<std::string> changed(const Difference& found) {
  std::vector<std::string> names;
  for (const Change& one : found.parameters)
    if (one.is_change()) names.push_back(one.name);
  return names;
}

const Change& change(const Difference& found, const std::string& name) {
  for (const Change& one : found.parameters)
    if (one.name == name) return one;
  ADD_FAILURE() << name << " is missing";
  return found.parameters.front();
}

TEST(Difference, of_one_state_is_called_a_change_as_rarely_as_the_level_says) {
  std::mt19937 random(1);
  constexpr int kPairs = 2000;
  int joint = 0, any = 0, beyond = 0, compared = 0;
  for (int k = 0; k < kPairs; ++k) {
    const Difference found = difference(drawn({}, random), drawn({}, random));
    EXPECT_EQ(found.joint.freedom, 6U);
    joint += found.joint.is_change() ? 1 : 0;
    any += changed(found).empty() ? 0 : 1;
    for (const Change& one : found.parameters) {
      ++compared;
      beyond += std::abs(one.deviations()) > 3.0 ? 1 : 0;
    }
  }
  EXPECT_NEAR(joint, 0.01 * kPairs, 15.0) << "one in a hundred";
  EXPECT_GT(joint, 0);
  EXPECT_LT(any, 0.02 * kPairs) << "Holm's test of six parameters keeps the level";
  EXPECT_LT(beyond, 0.01 * compared);
}

TEST(Difference, names_the_parameter_that_changed_and_no_other) {
  std::mt19937 random(2);
  TrueState later;
  later.x += 0.01;
  const Difference found = difference(drawn({}, random), drawn(later, random));
  EXPECT_TRUE(found.is_change());
  EXPECT_LT(found.joint.p_value, 1e-6);
  EXPECT_THAT(changed(found), ElementsAre("lidar_x"));
  EXPECT_NEAR(change(found, "lidar_x").difference(), 0.01, 0.002);
}

// Diameters whose errors have most in common: their difference is known better than each of them.
TEST(Difference, is_judged_with_the_covariance) {
  std::mt19937 random(3);
  TrueState later;
  later.left += 1.0e-4;
  later.right -= 1.0e-4;
  const Difference found = difference(drawn({}, random), drawn(later, random));
  Calibration blind_before = drawn({}, random), blind_after = drawn(later, random);
  blind_before.covariance_order.clear();
  blind_before.covariance.clear();
  blind_after.covariance_order.clear();
  blind_after.covariance.clear();
  EXPECT_GT(found.joint.statistic, 1.5 * difference(blind_before, blind_after).joint.statistic);
}

TEST(Difference, does_not_hold_the_metre_that_both_have_in_common) {
  std::mt19937 random(4);
  Calibration before = drawn({}, random), after = drawn({}, random);
  const double plain = change(difference(before, after), "track_width").std;
  EXPECT_EQ(difference(before, after).metre, Metre::unstated);
  before.scale = {1.0, 0.01, "lidar data sheet"};
  after.scale = {1.0, 0.01, "lidar data sheet"};
  const Difference common = difference(before, after);
  EXPECT_EQ(common.metre, Metre::common);
  EXPECT_EQ(change(common, "track_width").std, plain);
  after.scale = {1.002, 0.001, "tape"};
  const Difference apart = difference(before, after);
  EXPECT_EQ(apart.metre, Metre::apart);
  EXPECT_NEAR(change(apart, "track_width").std, std::hypot(plain, 0.4 * std::hypot(0.01, 0.001)), 1e-4);
  EXPECT_EQ(change(apart, "lidar_yaw").std, change(common, "lidar_yaw").std) << "an angle has no metre";
  EXPECT_GT(apart.metre_error->std, 0.009);
  EXPECT_NEAR(apart.turn_error->std, common.turn_error->std, 1e-6) << "a ratio of two lengths has none";
}

TEST(Difference, says_what_odometry_by_the_earlier_values_would_read_now) {
  std::mt19937 random(5);
  TrueState worn;
  worn.left *= 0.995;
  worn.right *= 0.995;
  const Difference found = difference(drawn({}, random), drawn(worn, random));
  ASSERT_TRUE(found.metre_error && found.turn_error);
  EXPECT_NEAR(found.metre_error->value, 0.005, 3.0 * found.metre_error->std) << "too long";
  EXPECT_LT(found.metre_error->std, 0.0005);
  EXPECT_NEAR(found.turn_error->value, 2.0 * M_PI * 0.005, 3.0 * found.turn_error->std) << "too far";
}

TEST(State, knows_the_mean_of_two_diameters_that_err_together) {
  std::mt19937 random(12);
  const auto mean = mean_diameter(state_of(drawn({}, random)));
  ASSERT_TRUE(mean);
  EXPECT_NEAR(mean->value, 0.1501, 2e-4);
  EXPECT_NEAR(mean->std, 3e-5 * std::sqrt(0.5 * (1.0 + 0.8)), 1e-9);
}

TEST(Difference, tells_which_effects_came_went_and_changed) {
  std::mt19937 random(6);
  Calibration before = drawn({}, random), after = drawn({}, random);
  before.effects = {{"backlash", {{"play", {0.01, 0.001, "rad"}}}, {}, {}, "host"},
                    {"tick_loss", {{"share", {0.01, 0.001, "1"}}}, {}, {}, "host"}};
  after.effects = {{"backlash", {{"play", {0.03, 0.001, "rad"}}}, {}, {}, "host"},
                   {"time_offset", {{"offset", {0.1, 0.001, "s"}}}, {}, {}, "host"}};
  const Difference found = difference(before, after);
  EXPECT_THAT(found.came, ElementsAre(Field(&LoneEffect::name, "time_offset")));
  EXPECT_THAT(found.went, ElementsAre(Field(&LoneEffect::name, "tick_loss")));
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects.front().name, "backlash: play");
  EXPECT_TRUE(found.effects.front().is_change());
  EXPECT_TRUE(found.has_changed_effect());
  EXPECT_FALSE(found.joint.is_change());
  EXPECT_TRUE(found.is_change());
}

EffectResult play(double value, double std) {
  return {"backlash", {{"left_play", {value, std, "rad"}}}, {}, {}, "host"};
}

Detectable detectable_play(double smallest) { return {"backlash", "left_play", "rad", smallest, 0.02, ""}; }

TEST(Difference, is_a_change_where_the_other_drives_would_have_shown_the_effect) {
  std::mt19937 random(13);
  Calibration before = drawn({}, random), after = drawn({}, random);
  before.detectable = {detectable_play(0.003)};
  after.effects = {play(0.06, 1e-4)};
  const Difference came = difference(before, after);
  EXPECT_FALSE(came.joint.is_change());
  EXPECT_TRUE(came.is_change());
  EXPECT_TRUE(came.came.front().is_change());
  EXPECT_EQ(came.came.front().value.name, "backlash: left_play");
  EXPECT_TRUE(difference(after, before).went.front().is_change());
  EXPECT_EQ(standing_of(after, std::vector<const Calibration*>{&before, &after}).urgency, Urgency::changed);
}

TEST(Difference, is_none_where_nobody_can_tell_whether_the_effect_was_there_before) {
  std::mt19937 random(14);
  Calibration before = drawn({}, random), after = drawn({}, random);
  after.effects = {play(0.06, 1e-4)};
  EXPECT_FALSE(difference(before, after).is_change()) << "no size is stated that would have been found";
  before.detectable = {detectable_play(0.003)};
  before.detectable.front().smallest.reset();
  EXPECT_FALSE(difference(before, after).is_change()) << "no size shows";
  before.detectable = {detectable_play(0.055)};
  EXPECT_FALSE(difference(before, after).is_change()) << "so near to what shows it may be chance";
  before.detectable = {detectable_play(0.003)};
  before.considered = {{"backlash", 40.0, 0.0005, "no gain on held-out data"}};
  EXPECT_FALSE(difference(before, after).is_change()) << "before it was seen, too, and not taken";
  before.considered.clear();
  EXPECT_TRUE(difference(before, after).is_change());
  before.effects = {{"caster_kick", {{"kappa", {0.02, 1e-4, "rad"}}}, {}, {"backlash"}, "host"}};
  const Difference renamed = difference(before, after);
  EXPECT_EQ(renamed.came.size(), 1U);
  EXPECT_FALSE(renamed.is_change()) << "before it may have gone by another name";
}

// The search finds what is beyond 4.4 deviations: sizes about that come and go by chance.
TEST(Difference, of_an_effect_near_the_threshold_is_called_a_change_as_rarely_as_the_level_says) {
  std::mt19937 random(15);
  std::normal_distribution<double> normal;
  constexpr double kStd = 0.5e-3, kThreshold = 4.4 * kStd, kSmallest = kThreshold + 1.28 * kStd;
  for (const double truth : {0.5, 0.8, 1.0, 1.2, 1.5}) {
    int lone = 0, changes = 0;
    constexpr int kPairs = 4000;
    for (int k = 0; k < kPairs; ++k) {
      std::array<Calibration, 2> pair{drawn({}, random), drawn({}, random)};
      for (Calibration& one : pair) {
        const double estimate = truth * kThreshold + kStd * normal(random);
        if (estimate > kThreshold)
          one.effects = {play(estimate, kStd)};
        else
          one.detectable = {detectable_play(kSmallest)};
      }
      const Difference found = difference(pair[0], pair[1]);
      lone += found.came.empty() && found.went.empty() ? 0 : 1;
      changes += found.has_changed_effect() ? 1 : 0;
    }
    EXPECT_GT(lone, truth == 1.0 ? 0.4 * kPairs : -1.0) << "the test tests something";
    EXPECT_LE(changes, 0.01 * kPairs) << truth;
  }
}

// Rooms and matchers move an effect by more than its deviation says: that is no change of the robot.
TEST(Difference, of_an_effect_is_none_where_it_does_not_matter_to_odometry) {
  std::mt19937 random(17);
  Calibration before = drawn({}, random), after = drawn({}, random);
  before.effects = {play(0.06, 1e-4)};
  after.effects = {play(0.0608, 1e-4)};
  const Difference small = difference(before, after);
  EXPECT_GT(small.effects.front().deviations(), 5.0);
  EXPECT_FALSE(small.is_change());
  after.effects = {play(0.0638, 1e-4)};
  EXPECT_TRUE(difference(before, after).is_change());
}

// A counter that began anew at power-on shows the same wheel with another phase.
TEST(Difference, of_an_eccentric_wheel_is_that_of_its_size) {
  std::mt19937 random(16);
  const auto eccentric = [](const std::string& side, double size, double phase) {
    return EffectResult{"wheel_eccentricity",
                        {{side + "_cos", {size * std::cos(phase), 1e-4, "1"}},
                         {side + "_sin", {size * std::sin(phase), 1e-4, "1"}}},
                        {},
                        {},
                        "host"};
  };
  Calibration before = drawn({}, random), after = drawn({}, random);
  before.effects = {eccentric("left", 0.02, 0.3)};
  after.effects = {eccentric("left", 0.02, 2.0)};
  const Difference turned = difference(before, after);
  ASSERT_EQ(turned.effects.size(), 1U);
  EXPECT_EQ(turned.effects.front().name, "wheel_eccentricity: left_size");
  EXPECT_FALSE(turned.is_change());
  after.effects = {eccentric("left", 0.025, 2.0)};
  EXPECT_TRUE(difference(before, after).is_change());
  after.effects = {eccentric("right", 0.02, 0.3)};
  after.detectable = {{"wheel_eccentricity", "left_sin", "1", 0.001, 0.005, ""}};
  const Difference other_wheel = difference(before, after);
  ASSERT_EQ(other_wheel.went.size(), 1U);
  EXPECT_TRUE(other_wheel.went.front().is_change()) << "that of the left wheel went";
  EXPECT_FALSE(other_wheel.came.front().is_change()) << "of the right one nothing is known";
}

TEST(Difference, compares_what_both_have_estimated) {
  std::mt19937 random(7);
  Calibration before = drawn({}, random), after = drawn({}, random);
  after.parameters[3].second.std = -1.0;  // lidar_x: fixed
  const Difference found = difference(before, after);
  EXPECT_EQ(found.parameters.size(), 5U);
  EXPECT_EQ(found.joint.freedom, 5U);
  after.parameters.clear();
  const Difference nothing = difference(before, after);
  EXPECT_THAT(nothing.parameters, IsEmpty());
  EXPECT_EQ(nothing.joint.p_value, 1.0);
  EXPECT_FALSE(nothing.metre_error);
}

TEST(Homogeneity, of_two_is_the_joint_test_and_of_many_keeps_its_level) {
  std::mt19937 random(8);
  const Calibration a = drawn({}, random), b = drawn({}, random);
  const std::array<const Calibration*, 2> two{&a, &b};
  EXPECT_NEAR(homogeneity(two).statistic, difference(a, b).joint.statistic, 1e-6);
  int alarms = 0;
  for (int k = 0; k < 500; ++k) {
    std::vector<Calibration> all;
    all.reserve(5);
    for (int n = 0; n < 5; ++n) all.push_back(drawn({}, random));
    const JointTest test = homogeneity(test_support::views(all));
    EXPECT_EQ(test.freedom, 24U);
    alarms += test.is_change() ? 1 : 0;
  }
  EXPECT_LT(alarms, 14);
  TrueState worn;
  worn.left -= 3e-4;
  const Calibration c = drawn(worn, random);
  const std::array<const Calibration*, 3> three{&a, &b, &c};
  EXPECT_TRUE(homogeneity(three).is_change());
}

TEST(Fleet, puts_first_what_nobody_knows_then_what_changed_most) {
  std::mt19937 random(9);
  TrueState worn, more;
  worn.left *= 0.99;
  more.left *= 0.98;
  const Calibration first = drawn({}, random), same = drawn({}, random), changed = drawn(worn, random),
                    changed_more = drawn(more, random);
  Calibration warned = drawn({}, random), refused = drawn({}, random);
  warned.verdict = Verdict::accepted_with_warnings;
  refused.verdict = Verdict::refused;
  const auto standing = [](std::initializer_list<const Calibration*> all) {
    return standing_of(**std::prev(all.end()), std::vector<const Calibration*>(all));
  };
  const std::array order{standing_of(refused, std::vector<const Calibration*>{&first}),
                         standing({&first, &changed_more}), standing({&first, &changed}), standing({&warned}),
                         standing({&first, &same})};
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t k = 0; k < order.size(); ++k)
      EXPECT_EQ(order.at(i).is_before(order.at(k)), i < k) << i << " and " << k;
  EXPECT_EQ(order[0].urgency, Urgency::refused);
  EXPECT_FALSE(order[0].since_last);
  EXPECT_NEAR(order[1].size, 0.01, 0.001) << "half of two per cent: one wheel of two";
}

}  // namespace
}  // namespace odomcalib::calib::comparison::difference_test
