// Detectable effects of a drive: larger ones are found, smaller ones not, and those it cannot show are named.
#include "calib/selection/detectable.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "calib/terms/catalogue.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::detectable_test {
namespace {

FittedModel plain_fit(const measurement::FitData& data) {
  auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  EXPECT_TRUE(fit) << "seed " << kSeed;
  return {{}, std::move(fit).value()};
}

std::vector<Detectable> detectable_in(const measurement::FitData& data) {
  return smallest_detectable({{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)}, plain_fit(data));
}

const Detectable& of(const std::vector<Detectable>& all, const std::string& effect) {
  const auto it =
      std::find_if(all.begin(), all.end(), [&](const Detectable& d) { return d.effect == effect; });
  EXPECT_NE(it, all.end()) << effect;
  return *it;
}

class Detection : public testing::TestWithParam<std::string> {};

TEST_P(Detection, is_sure_above_the_size_that_is_stated_and_fails_well_below_it) {
  const vehicle::DriveModel model = jerky_model();
  const auto all = detectable_in(measured(model, {}, {}));
  const Detectable& stated = of(all, GetParam());
  ASSERT_TRUE(stated.smallest);
  const auto effect = terms::find_effect(GetParam());
  const auto found_at = [&](double size) {
    std::vector<double> values;
    for (const vehicle::EffectParameter& p : effect->parameters())
      values.push_back(p.name == stated.parameter ? size : p.start);
    const SearchResult result = searched(measured(model, {effect}, values));
    return std::any_of(result.considered.begin(), result.considered.end(),
                       [&](const Considered& c) { return c.name == GetParam(); });
  };
  EXPECT_TRUE(found_at(1.5 * *stated.smallest)) << *stated.smallest << ' ' << stated.unit;
  EXPECT_FALSE(found_at(0.3 * *stated.smallest)) << *stated.smallest << ' ' << stated.unit;
}

INSTANTIATE_TEST_SUITE_P(Effects, Detection,
                         testing::Values("acceleration_slip", "turn_direction_asymmetry", "lateral_slip",
                                         "floor_slope", "carpet"));

/// Noise so large that what is stated is not what is too small to matter.
TEST(Detectable, agrees_with_the_deviation_of_a_fit) {
  const vehicle::DriveModel model = jerky_model();
  measurement::FitData data = measured(model, {}, {});
  data.pairs.resize(60);
  const FittedModel plain = plain_fit(data);
  const auto effect = terms::find_effect("acceleration_slip");
  const FitTask task{{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)};
  const auto with = with_effect(task, plain, effect, plain.fit.noise);
  ASSERT_TRUE(with);
  const double deviation = std::sqrt(with->fit.covariance(vehicle::kBaseCount, vehicle::kBaseCount));
  EXPECT_NEAR(*of(smallest_detectable(task, plain), "acceleration_slip").smallest / deviation, 5.68, 0.5);
}

/// Forward only, at one speed, without an arc: no reversals, nothing to push the robot sideways.
TEST(Detectable, says_of_a_lazy_drive_what_it_is_no_test_of) {
  wheels::WheelTrack track;
  double left = 0.0, right = 0.0;
  for (int k = 0; k <= 6000; ++k) {
    const double t = 0.04 * k, phase = std::fmod(t, 16.0);
    const bool turns = phase > 12.0;
    track.t.push_back(t);
    track.left.push_back(left += 0.04 * (turns ? -2.0 : 3.0));
    track.right.push_back(right += 0.04 * (turns ? 2.0 : 3.0));
    track.segment.push_back(0);
  }
  const auto context = vehicle::make_context(track, kBase);
  const vehicle::DriveModel model(std::move(track), context);
  const auto all = detectable_in(measured(model, {}, {}));
  for (const char* effect : {"lateral_slip", "speed_dependent_radius", "track_depends_on_motion"}) {
    const Detectable& stated = of(all, effect);
    EXPECT_TRUE(!stated.smallest || *stated.smallest > stated.typical) << effect << ' ' << *stated.smallest;
  }
  EXPECT_LT(*of(all, "carpet").smallest, of(all, "carpet").typical);
}

}  // namespace
}  // namespace odomcalib::calib::selection::detectable_test
