#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/effects/catalogue.hpp"
#include "calib/next_test.hpp"
#include "calib/predict.hpp"

namespace odomcalib::calib {
namespace {

const RobotDescription kRobot{0.15, 0.15, 0.4, 16384.0, std::nullopt, "", ""};

/// Straights, spins and arcs both ways at two paces, each from rest to rest; counts begin anywhere.
Recording drive() {
  constexpr std::array<std::array<double, 2>, 6> kMoves{
      {{2.7, 2.7}, {-2.7, -2.7}, {-1.6, 1.6}, {1.6, -1.6}, {1.0, 2.6}, {-2.0, -0.4}}};
  Recording recording;
  recording.robot = kRobot;
  double left = 5000.0;
  double right = -70000.0;
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.02 * k;
    recording.ticks.push_back({t, std::llround(left), std::llround(right), 0});
    const double phase = std::fmod(t, 5.0);
    const auto move = static_cast<std::size_t>(t / 5.0);
    const double pace = (move / kMoves.size()) % 2 == 0 ? 1.0 : 0.4;
    const double ramp = std::clamp(std::min(phase, 4.6 - phase), 0.0, 1.0) * pace;
    left += 0.02 * ramp * kMoves.at(move % kMoves.size())[0] * kRobot.ticks_per_rev / (2.0 * M_PI);
    right += 0.02 * ramp * kMoves.at(move % kMoves.size())[1] * kRobot.ticks_per_rev / (2.0 * M_PI);
  }
  return recording;
}

Calibration with_effect(const Effect& effect) {
  Calibration calibration = nominal_calibration(kRobot);
  EffectResult result;
  result.name = effect.name();
  for (const EffectParameter& p : effect.parameters())
    result.parameters.push_back({p.name, {p.start + (p.fixed ? 0.0 : p.scale), -1.0, p.unit}});
  calibration.effects = {result};
  return calibration;
}

PoseSample end_of(const Recording& recording, const Calibration& calibration) {
  Odometry odometry(calibration);
  PoseSample pose;
  for (const TickSample& sample : recording.ticks) pose = odometry.update(sample);
  return pose;
}

double distance(const PoseSample& a, const PoseSample& b) {
  return std::hypot(a.x - b.x, a.y - b.y) + 0.2 * std::abs(std::remainder(a.yaw - b.yaw, 2.0 * M_PI));
}

// A drive may begin with cold wheels or warm ones: odometry takes what they were on the average.
TEST(Odometry, wheels_that_change_with_time_count_by_their_mean_over_the_drive) {
  const Recording recording = drive();
  Calibration drifting = nominal_calibration(kRobot);
  drifting.data.resize(1);
  drifting.data[0].duration = 200.0;
  drifting.effects = {{"drift_with_time",
                       {{"common", {0.01, -1.0, "1/(100 s)"}},
                        {"differential", {0.0, -1.0, "1/(100 s)"}},
                        {"time_constant", {1e5, -1.0, "s"}}},
                       {},
                       {},
                       "host"}};
  Calibration larger = nominal_calibration(kRobot);  // by 1 % after the first 100 s of 200
  for (std::size_t k = 0; k < 2; ++k) larger.parameters[k].second.value *= 1.01;
  EXPECT_LT(distance(predict(recording, drifting).back(), predict(recording, larger).back()), 1e-4);
  EXPECT_LT(distance(end_of(recording, drifting), end_of(recording, larger)), 1e-4);
}

// The daemon sees speeds from the past only; apart from that it does what predict does.
TEST(Odometry, sample_by_sample_applies_every_effect_as_predict_does) {
  const Recording recording = drive();
  const PoseSample nominal = predict(recording, nominal_calibration(kRobot)).back();
  std::size_t applied = 0;
  for (const auto& effect : effect_catalogue()) {
    const Calibration calibration = with_effect(*effect);
    const PoseSample batch = predict(recording, calibration).back();
    const PoseSample live = end_of(recording, calibration);
    const double size = distance(batch, nominal);
    const auto placements = effect_placements(calibration);
    ASSERT_EQ(placements.size(), effect->parameters().size()) << effect->name();
    const bool is_applied = std::any_of(placements.begin(), placements.end(),
                                        [](const Placement& p) { return p.place == Place::odometry; });
    if (!is_applied) {
      EXPECT_EQ(size, 0.0) << effect->name();
      EXPECT_LT(distance(live, nominal), 1e-9) << effect->name();
      continue;
    }
    if (size > 1e-3) ++applied;
    EXPECT_LT(distance(live, batch), 0.25 * size + 1e-3)
        << effect->name() << " moves the end by " << size << " m in predict";
  }
  EXPECT_GE(applied, 6U);
}

TEST(Odometry, an_error_of_the_lidar_is_no_error_of_odometry_but_encoders_that_smooth_are) {
  for (const char* name : {"time_offset", "clock_drift", "scan_skew"})
    EXPECT_EQ(effect_placements(with_effect(*find_effect(name))).front().place, Place::reference) << name;
  EXPECT_EQ(effect_placements(with_effect(*find_effect("time_offset"))).back().parameter, "smoothing");
  EXPECT_EQ(effect_placements(with_effect(*find_effect("time_offset"))).back().place, Place::odometry);
  EXPECT_EQ(effect_placements(with_effect(*find_effect("carpet"))).front().place, Place::nowhere);
  EXPECT_EQ(effect_placements(with_effect(*find_effect("backlash"))).front().place, Place::odometry);
}

// A wheel that is off centre is off centre at the same counts, in whatever recording.
TEST(Odometry, the_phase_of_a_wheel_is_that_of_its_counter) {
  Recording late = drive();
  const Calibration calibration = with_effect(*find_effect("wheel_eccentricity"));
  const auto whole = predict(late, calibration);
  constexpr std::size_t kCut = 137;
  late.ticks.erase(late.ticks.begin(), late.ticks.begin() + kCut);
  const auto part = predict(late, calibration);
  for (const std::size_t k : {std::size_t{50}, std::size_t{900}}) {
    const auto moved = [](const std::vector<PoseSample>& path, std::size_t from, std::size_t to) {
      return std::hypot(path[to].x - path[from].x, path[to].y - path[from].y);
    };
    EXPECT_NEAR(moved(part, 0, k), moved(whole, kCut, kCut + k), 1e-9);
  }
}

Calibration accepted(double diameter_std, double track_std) {
  Calibration calibration = nominal_calibration(kRobot);
  calibration.verdict = Verdict::accepted;
  calibration.parameters = {{"left_wheel_diameter", {0.15, diameter_std, "m"}},
                            {"right_wheel_diameter", {0.15, diameter_std, "m"}},
                            {"track_width", {0.4, track_std, "m"}}};
  return calibration;
}

TEST(NextTest, ambiguity_goes_before_a_nameless_defect_and_that_before_uncertainty) {
  Calibration calibration = accepted(1e-5, 4e-3);
  EXPECT_EQ(next_test(calibration).value().manoeuvre, "turns");
  calibration.unexplained = Unexplained{{"left_phase"}, 1e-3, 0.5};
  EXPECT_EQ(next_test(calibration).value().manoeuvre, "slow_straights");
  EffectResult backlash;
  backlash.name = "backlash";
  backlash.aliases = {"caster_kick"};
  calibration.effects = {backlash};
  const auto next = next_test(calibration);
  ASSERT_TRUE(next.has_value());
  EXPECT_EQ(next->manoeuvre, "reversals");
  EXPECT_NE(next->why.find("caster_kick"), std::string::npos) << next->why;
}

TEST(NextTest, nothing_when_everything_is_certain_or_nothing_is) {
  EXPECT_FALSE(next_test(accepted(1e-5, 1e-5)).has_value());
  EXPECT_EQ(next_test(accepted(1e-3, 1e-5)).value().manoeuvre, "straights");
  Calibration refused = accepted(1e-3, 1e-3);
  refused.verdict = Verdict::refused;
  EXPECT_FALSE(next_test(refused).has_value());
}

TEST(NextTest, what_no_motion_separates_asks_for_no_motion) {
  Calibration calibration = accepted(1e-5, 1e-5);
  EffectResult offset;
  offset.name = "time_offset";
  offset.aliases = find_effect("time_offset")->always_alike();
  ASSERT_FALSE(offset.aliases.empty());
  calibration.effects = {offset};
  EXPECT_FALSE(next_test(calibration).has_value());
}

}  // namespace
}  // namespace odomcalib::calib
