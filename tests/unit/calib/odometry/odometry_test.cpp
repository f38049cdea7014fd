#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "calib/odometry/correction.hpp"
#include "calib/odometry/odometry.hpp"
#include "calib/odometry/predict.hpp"
#include "calib/odometry/uncertainty.hpp"
#include "calib/report/next_test.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/fitted_smooth_term.hpp"
#include "tests/unit/calib/some_drive.hpp"

namespace odomcalib::calib::odometry::odometry_test {
namespace {

using test_support::kRobot;

Recording drive() { return test_support::some_drive(); }

Calibration with_effect(const vehicle::Effect& effect) {
  Calibration calibration = nominal_calibration(kRobot);
  EffectResult result;
  result.name = effect.name();
  for (const vehicle::EffectParameter& p : effect.parameters())
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

Calibration with_drift(double growth) {
  Calibration calibration = nominal_calibration(kRobot);
  calibration.data.resize(1);
  calibration.data[0].duration = 200.0;
  calibration.effects = {{"drift_with_time",
                          {{"common", {growth, -1.0, "1/(100 s)"}},
                           {"differential", {0.0, -1.0, "1/(100 s)"}},
                           {"time_constant", {1e5, -1.0, "s"}}},
                          {},
                          {},
                          "host"}};
  return calibration;
}

Calibration with_wheels_larger_by(double share) {
  Calibration calibration = nominal_calibration(kRobot);
  for (std::size_t k = 0; k < 2; ++k) calibration.parameters[k].second.value *= 1.0 + share;
  return calibration;
}

/// Expects wheels without a law, larger by `share`, to lead to the same end (`drive` takes 60 s).
void expect_as_larger(const Calibration& calibration, double share, const std::string& what) {
  const Recording recording = drive();
  const Calibration larger = with_wheels_larger_by(share);
  EXPECT_LT(distance(predict(recording, calibration).back(), predict(recording, larger).back()), 1e-4)
      << what;
  EXPECT_LT(distance(end_of(recording, calibration), end_of(recording, larger)), 1e-4) << what;
}

// A drive may begin with cold wheels or warm ones: odometry takes what they were on the average.
TEST(Odometry, wheels_that_change_with_time_count_by_their_mean_over_the_drive) {
  expect_as_larger(with_drift(0.01), 0.01, "the time is not known");
}

// Growth of 1 % in 100 s; the drive of the calibration took 200 s.
TEST(Odometry, wheels_that_change_with_time_are_known_on_the_same_clock) {
  for (const auto& [since, share] : {std::pair{300.0, 0.02}, {399.0, 0.02}, {401.0, 0.01}, {-10.0, 0.01}}) {
    Calibration drifting = with_drift(0.01);
    drifting.data[0].begin = -since;
    expect_as_larger(drifting, share, std::to_string(since) + " s since the calibration's drive began");
    drifting.data.push_back(drifting.data[0]);
    expect_as_larger(drifting, 0.01, "of two drives");
  }
}

TEST(Odometry, wheels_go_on_to_change_while_the_drive_of_the_calibration_lasts) {
  Calibration drifting = with_drift(0.01);
  drifting.data[0].begin = 0.0;
  const Recording recording = drive();
  const auto grown = predict(recording, drifting);
  const auto larger = predict(recording, with_wheels_larger_by(0.006));
  const auto nominal = predict(recording, nominal_calibration(kRobot));
  const auto step = [](const std::vector<PoseSample>& path, std::size_t k) {
    return std::hypot(path[k + 1].x - path[k].x, path[k + 1].y - path[k].y);
  };
  EXPECT_NEAR(step(grown, 100), step(nominal, 100), 3e-4 * step(nominal, 100)) << "after 2 s";
  EXPECT_NEAR(step(grown, 2900), step(larger, 2900), 3e-4 * step(larger, 2900)) << "after 58 s";
}

// A straight line from -1 to 1 over 200 s (the first Legendre polynomial), or a cosine.
TEST(Odometry, a_curve_of_time_acts_where_the_time_is_known) {
  Calibration bent = nominal_calibration(kRobot);
  bent.data.resize(1);
  bent.data[0].duration = 200.0;
  const auto set_smooth = [&bent](double period, const std::string& named_term) {
    const terms::SmoothTerm steady{{vehicle::Covariate::time, vehicle::Channel::both_travel}, 0.0, 200.0};
    const terms::SmoothTerm smooth = period > 0.0 ? on_basis(steady, terms::Cycle{period}) : steady;
    std::vector<double> coefficients(function_count(smooth), 0.0);
    coefficients[0] = 0.01;
    bent.curves = terms::entries_of({{smooth, coefficients, named_term}});
  };
  set_smooth(0.0, "");
  expect_as_larger(bent, 0.0, "another clock");
  EXPECT_EQ(effect_placements(bent).front().place, Place::odometry);
  bent.data[0].begin = -300.0;
  expect_as_larger(bent, 0.01, "as at the end");
  set_smooth(100.0, "");
  expect_as_larger(bent, 0.0, "up and down");
  EXPECT_EQ(effect_placements(bent).front().place, Place::nowhere);
  set_smooth(100.0, "drift_with_time");
  expect_as_larger(bent, 0.01, "what is left of a drift, as at the end");
}

// A base does not begin to crab, nor do wheels grow with a lidar's metre.
TEST(Odometry, what_a_lidar_did_in_time_is_not_followed) {
  Calibration lidars = nominal_calibration(kRobot);
  lidars.data.resize(1);
  lidars.data[0].duration = 200.0;
  lidars.data[0].begin = 0.0;
  for (const auto channel :
       {vehicle::Channel::sideways, vehicle::Channel::scale, vehicle::Channel::way_turned}) {
    terms::SmoothTerm smooth{{vehicle::Covariate::time, channel}, 0.0, 200.0};
    smooth.basis = terms::ChangePoint{100.0};
    const std::vector<double> coefficients(function_count(smooth), 0.01);
    lidars.curves = terms::entries_of({{smooth, coefficients, ""}});
    expect_as_larger(lidars, 0.0, to_string(channel).c_str());
    EXPECT_EQ(effect_placements(lidars).front().place, Place::reference) << to_string(channel);
  }
}

// A plain model looks at the same values whether those that come after are known or not.
TEST(Odometry, without_effects_each_pose_is_that_of_predict_to_the_last_bit) {
  const Recording recording = drive();
  const Calibration calibration = with_wheels_larger_by(0.013);
  const auto batch = predict(recording, calibration);
  Odometry odometry(calibration);
  for (std::size_t k = 0; k < batch.size(); ++k) {
    const PoseSample live = odometry.update(recording.ticks[k]);
    ASSERT_EQ(live.x, batch[k].x) << k;
    ASSERT_EQ(live.y, batch[k].y) << k;
    ASSERT_EQ(live.yaw, batch[k].yaw) << k;
  }
}

// Counters that begin anew show a speed that no wheel had.
TEST(Odometry, a_counter_that_was_reset_moves_nothing_whatever_the_effect) {
  Recording reset = drive();
  for (std::size_t k = 1400; k < reset.ticks.size(); ++k) {
    reset.ticks[k].left -= 9'000'000;
    reset.ticks[k].segment = 1;
  }
  for (const auto& effect : terms::effect_catalogue()) {
    const Calibration calibration = with_effect(*effect);
    for (const auto& path : {predict(reset, calibration), predict_live(reset, calibration)})
      EXPECT_LT(distance(path[1399], path[1400]), 1e-3) << effect->name();
  }
}

// The daemon sees speeds from the past only; apart from that it does what predict does.
TEST(Odometry, sample_by_sample_applies_every_effect_as_predict_does) {
  const Recording recording = drive();
  const PoseSample nominal = predict(recording, nominal_calibration(kRobot)).back();
  std::size_t applied = 0;
  for (const auto& effect : terms::effect_catalogue()) {
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
    EXPECT_EQ(effect_placements(with_effect(*terms::find_effect(name))).front().place, Place::reference)
        << name;
  EXPECT_EQ(effect_placements(with_effect(*terms::find_effect("time_offset"))).back().parameter, "smoothing");
  EXPECT_EQ(effect_placements(with_effect(*terms::find_effect("time_offset"))).back().place, Place::odometry);
  EXPECT_EQ(effect_placements(with_effect(*terms::find_effect("carpet"))).front().place, Place::nowhere);
  EXPECT_EQ(effect_placements(with_effect(*terms::find_effect("backlash"))).front().place, Place::odometry);
}

// A wheel that is off centre is off centre at the same counts, in whatever recording.
TEST(Odometry, the_phase_of_a_wheel_is_that_of_its_counter) {
  Recording late = drive();
  const Calibration calibration = with_effect(*terms::find_effect("wheel_eccentricity"));
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

/// A turn on the spot, a straight line and a bend, in increments of a few centimetres.
std::vector<PoseSample> increments_of_a_drive() {
  std::vector<PoseSample> increments(20, {0.0, 0.0, 0.0, 0.08});
  increments.insert(increments.end(), 60, {0.0, 0.05, 0.0, 0.0});
  increments.insert(increments.end(), 60, {0.0, 0.05, 0.0, -0.03});
  return increments;
}

PoseSample moved(const PoseSample& from, const PoseSample& by) {
  return {0.0, from.x + std::cos(from.yaw) * by.x - std::sin(from.yaw) * by.y,
          from.y + std::sin(from.yaw) * by.x + std::cos(from.yaw) * by.y, from.yaw + by.yaw};
}

double deviation(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v, squares += v * v;
  const auto n = static_cast<double>(values.size());
  return std::sqrt((squares - sum * sum / n) / (n - 1.0));
}

TEST(PathNoise, S0_04_first_order_deviations_at_the_end_are_those_of_many_noisy_drives) {
  constexpr double kTrack = 0.4;
  constexpr int kDrives = 100'000;
  constexpr unsigned kSeed = 4;
  const IncrementNoise noise{0.004, 0.002, 0.01};
  const auto increments = increments_of_a_drive();
  std::vector<PoseSample> path{{}};
  for (const PoseSample& step : increments) path.push_back(moved(path.back(), step));
  const auto stated = deviation_at_end(path, noise, kTrack);

  std::mt19937 random(kSeed);
  std::normal_distribution<double> unit(0.0, 1.0);
  std::array<std::vector<double>, 3> ends, first;
  for (int drive = 0; drive < kDrives; ++drive) {
    PoseSample at;
    for (std::size_t k = 0; k < increments.size(); ++k) {
      const PoseSample& step = increments[k];
      const double rolled =
          0.5 * (std::abs(step.x - 0.5 * kTrack * step.yaw) + std::abs(step.x + 0.5 * kTrack * step.yaw));
      const double root = std::sqrt(rolled);
      const std::array error{noise[0] * root * unit(random), noise[1] * root * unit(random),
                             noise[2] * root * unit(random)};
      if (k == 0)
        for (std::size_t axis = 0; axis < 3; ++axis) first[axis].push_back(error[axis] / root);
      at = moved(at, {0.0, step.x + error[0], step.y + error[1], step.yaw + error[2]});
    }
    ends[0].push_back(at.x);
    ends[1].push_back(at.y);
    ends[2].push_back(at.yaw);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(deviation(first[axis]) / noise[axis], 1.0, 0.03) << "the noise itself, axis " << axis;
    EXPECT_NEAR(deviation(ends[axis]) / stated[axis], 1.0, 0.05) << "axis " << axis;
  }
  EXPECT_EQ(deviation_at_end(std::span(path).first(1), noise, kTrack), (std::array{0.0, 0.0, 0.0}));
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
  EXPECT_EQ(report::next_test(calibration).value().manoeuvre, "turns");
  calibration.unexplained = Unexplained{{"left_phase"}, 1e-3, 0.5};
  EXPECT_EQ(report::next_test(calibration).value().manoeuvre, "slow_straights");
  EffectResult backlash;
  backlash.name = "backlash";
  backlash.aliases = {"caster_kick"};
  calibration.effects = {backlash};
  const auto next = report::next_test(calibration);
  ASSERT_TRUE(next.has_value());
  EXPECT_EQ(next->manoeuvre, "reversals");
  EXPECT_NE(next->why.find("caster_kick"), std::string::npos) << next->why;
}

TEST(NextTest, nothing_when_everything_is_certain_or_nothing_is) {
  EXPECT_FALSE(report::next_test(accepted(1e-5, 1e-5)).has_value());
  EXPECT_EQ(report::next_test(accepted(1e-3, 1e-5)).value().manoeuvre, "straights");
  Calibration refused = accepted(1e-3, 1e-3);
  refused.verdict = Verdict::refused;
  EXPECT_FALSE(report::next_test(refused).has_value());
}

TEST(NextTest, what_no_motion_separates_asks_for_no_motion) {
  Calibration calibration = accepted(1e-5, 1e-5);
  EffectResult offset;
  offset.name = "time_offset";
  offset.aliases = terms::find_effect("time_offset")->observationally_equivalent();
  ASSERT_FALSE(offset.aliases.empty());
  calibration.effects = {offset};
  EXPECT_FALSE(report::next_test(calibration).has_value());
}

}  // namespace
}  // namespace odomcalib::calib::odometry::odometry_test
