// From residual to missing effect, on wheels and sensor motions made from the model alone.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "calib/effects/catalogue.hpp"
#include "calib/model/placed_effects.hpp"
#include "calib/tracing/candidate.hpp"
#include "calib/tracing/candidate_columns.hpp"
#include "calib/tracing/curve.hpp"
#include "calib/tracing/law_shape.hpp"
#include "calib/tracing/outlier_trace.hpp"
#include "calib/tracing/plausibility.hpp"
#include "calib/tracing/proof.hpp"
#include "calib/tracing/score.hpp"
#include "calib/tracing/search.hpp"
#include "calib/tracing/tracing_json.hpp"
#include "calib/validation/held_out.hpp"

namespace odomcalib::calib {
namespace {

const BaseParameters kBase{0.075, 0.074, 0.4, {0.1, 0.02, 0.3}};
constexpr unsigned kSeed = 4711;

/// Four minutes in which both wheels speed up, slow down and reverse on their own.
/// @param haste times the usual pace, over the same ground
DriveModel lively_model(double haste = 1.0) {
  WheelTrack track;
  for (int k = 0; k <= 6000; ++k) {
    track.t.push_back(0.04 * k);
    const double t = haste * 0.04 * k;
    track.left.push_back(9.0 * std::sin(0.31 * t) + 4.0 * std::sin(0.113 * t) + 0.4 * t);
    track.right.push_back(8.0 * std::sin(0.43 * t + 0.5) + 5.0 * std::sin(0.097 * t) + 0.5 * t);
    track.segment.push_back(0);
  }
  const auto context = make_context(track, kBase);
  return {std::move(track), context};
}

/// Four minutes of steady motions with short ramps between them.
DriveModel jerky_model() {
  constexpr double kStep = 0.04, kRamp = 0.4, kLeg = 2.0;  // s
  std::mt19937 engine(kSeed);
  std::uniform_real_distribution<double> speed(-5.0, 5.0);
  WheelTrack track;
  double left = 0.0, right = 0.0, from[2] = {}, to[2] = {};
  for (int k = 0; k <= 6000; ++k) {
    const double in_leg = std::fmod(kStep * k, kLeg);
    if (in_leg < kStep / 2.0)
      for (int side = 0; side < 2; ++side) from[side] = to[side], to[side] = speed(engine);
    const double share = std::min(in_leg / kRamp, 1.0);
    track.t.push_back(kStep * k);
    track.left.push_back(left += kStep * (from[0] + share * (to[0] - from[0])));
    track.right.push_back(right += kStep * (from[1] + share * (to[1] - from[1])));
    track.segment.push_back(0);
  }
  const auto context = make_context(track, kBase);
  return {std::move(track), context};
}

std::span<const double> as_span(const Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

/// What a sensor with 0.5 mm and 0.5 mrad of noise would have measured, had the robot these effects.
FitData measured(const DriveModel& model, const EffectList& effects, const std::vector<double>& values) {
  Eigen::VectorXd p = to_vector(kBase, values.size());
  std::copy(values.begin(), values.end(), p.data() + kBaseCount);
  std::vector<Interval> intervals;
  for (double t = 0.513; t < 238.0; t += 0.5) intervals.push_back({t, t + 0.5});
  const auto motions = model.predict(as_span(p), effects, intervals);
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> noise(0.0, 5e-4);
  FitData data{&model, {}};
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    const Pose& m = motions[k];
    data.pairs.push_back({intervals[k],
                          {m.x + noise(engine), m.y + noise(engine), m.yaw + noise(engine)},
                          Eigen::Vector3d::Constant(25e-8).asDiagonal(),
                          false});
  }
  return data;
}

SearchResult searched(const FitData& data) {
  const auto fit = fit_joint({&data, 1}, {}, to_vector(kBase));
  EXPECT_TRUE(fit) << "seed " << kSeed;
  return search_effects({&data, 1}, {}, fit.value(), std::vector<bool>(kBaseCount, false), [](double) {});
}

TEST(Tracing, adds_nothing_when_nothing_is_missing) {
  const DriveModel model = lively_model();
  const SearchResult result = searched(measured(model, {}, {}));
  EXPECT_TRUE(result.findings.empty());
  EXPECT_TRUE(result.curves.empty());
  EXPECT_EQ(result.model.fit.parameters.size(), kBaseCount);
}

/// Sum of squares of what the search doubts about the base.
double doubt_of(const SearchResult& result) {
  double sum = 0.0;
  for (const Eigen::VectorXd& doubt : result.doubts) sum += doubt.squaredNorm();
  return std::sqrt(sum);
}

TEST(Tracing, a_name_that_is_plain_in_one_stretch_only_stays_a_doubt_about_the_lengths) {
  const DriveModel model = lively_model();
  FitData data = measured(model, {}, {});
  const FitData with = measured(model, {find_effect("direction_dependent_diameter")}, {0.03, 0.03});
  std::copy(with.pairs.begin(), with.pairs.begin() + 50, data.pairs.begin());  // 25 s of 238
  const SearchResult result = searched(data);
  EXPECT_TRUE(result.findings.empty());
  ASSERT_FALSE(result.considered.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.considered.front().outcome, "no gain on held-out data");
  EXPECT_GT(doubt_of(result), 1e-5);
  EXPECT_EQ(doubt_of(searched(measured(model, {}, {}))), 0.0);
}

TEST(Tracing, so_does_a_curve_that_is_plain_in_one_half_only) {
  const DriveModel model = jerky_model();
  const Curve law{{Variable::left_acceleration, Carrier::left_travel}, -1.0, 1.0};
  FitData data = measured(model, {}, {});
  const FitData with = measured(model, {make_curve_effect(law)}, {0.03, 0.0, 0.0, 0.0});
  std::copy(with.pairs.begin(), with.pairs.begin() + 120, data.pairs.begin());
  const SearchResult result = searched(data);
  EXPECT_TRUE(result.curves.empty());
  ASSERT_FALSE(result.considered.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.considered.front().outcome, "no gain on held-out data");
  EXPECT_GT(doubt_of(result), 1e-6);
}

TEST(Tracing, names_what_is_in_the_catalogue_and_finds_its_size) {
  struct Case {
    const char* name;
    std::vector<double> values;
    double haste = 1.0;
  };
  // A law of speed has no shape to be seen in slow drives.
  for (const Case& c :
       {Case{"wheel_eccentricity", {0.008, -0.004}}, Case{"speed_dependent_radius", {0.02, 0.0}, 2.0},
        Case{"speed_dependent_radius", {0.04, 0.2}, 2.0}, Case{"tick_loss", {-0.02, 0.0, 0.15, 0.02}},
        Case{"lateral_slip", {0.03, 0.1, 0.07}}, Case{"turn_direction_asymmetry", {0.01}}}) {
    const DriveModel model = lively_model(c.haste);
    const SearchResult result = searched(measured(model, {find_effect(c.name)}, c.values));
    ASSERT_EQ(result.findings.size(), 1U) << c.name << ", seed " << kSeed;
    EXPECT_EQ(result.findings[0].effect->name(), c.name);
    EXPECT_LE(result.findings[0].proof.family_p_value, 0.003) << c.name;
    for (std::size_t k = 0; k < c.values.size(); ++k) {
      const auto index = static_cast<Eigen::Index>(kBaseCount + k);
      EXPECT_NEAR(result.model.fit.parameters(index), c.values[k],
                  4.0 * std::sqrt(result.model.fit.covariance(index, index)) + 1e-3)
          << c.name << " " << k;
    }
  }
}

TEST(Tracing, a_curve_on_the_ground_of_the_second_best_name_takes_no_name_from_it) {
  const DriveModel model = lively_model();
  // A wheel out of round by more than its first harmonic, on a carpet that explains a little more than that.
  const auto wheel = make_curve_effect({{Variable::left_phase, Carrier::left_travel}});
  const SearchResult result = searched(
      measured(model, {find_effect("carpet"), wheel}, {0.014, 0.0, 0.01, 0.01, 0.007, 0.0, 0.0, 0.0}));
  std::set<std::string> names;
  for (const Finding& finding : result.findings) names.insert(finding.effect->name());
  EXPECT_EQ(names, (std::set<std::string>{"carpet", "wheel_eccentricity"})) << "seed " << kSeed;
  for (const AddedCurve& curve : result.curves) EXPECT_NE(curve.law_of, nullptr);
}

TEST(Tracing, shapes_that_are_tried_are_not_fitted) {
  for (const char* name : {"drift_with_time", "caster_kick"}) {
    const auto parameters = find_effect(name)->parameters();
    EXPECT_TRUE(std::any_of(parameters.begin(), parameters.end(), [](const EffectParameter& parameter) {
      return parameter.fixed && parameter.start != 0.0;
    })) << name;
    EXPECT_FALSE(parameters.front().fixed) << name;
  }
}

TEST(Tracing, says_which_variable_when_it_has_no_name) {
  const DriveModel model = lively_model();
  const Curve swing{{Variable::left_phase, Carrier::left_travel}, 0.0, 1.0, 0.0, 5};
  const SearchResult result = searched(measured(model, {make_curve_effect(swing)}, {0.03, 0.01}));
  EXPECT_TRUE(result.findings.empty());
  ASSERT_TRUE(result.has_unnamed());
  EXPECT_EQ(result.curves[0].curve.law, swing.law);
  EXPECT_EQ(result.curves[0].curve.harmonic, 5);
}

TEST(Tracing, a_clock_is_asked_before_what_happened_before) {
  const DriveModel model = lively_model();
  const SearchResult result = searched(measured(model, {find_effect("time_offset")}, {0.03, 0.0}));
  ASSERT_EQ(result.findings.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.findings[0].effect->name(), "time_offset");
  EXPECT_TRUE(result.curves.empty());
}

TEST(Tracing, a_wheel_that_keeps_what_the_last_push_did_is_flagged) {
  const DriveModel model = lively_model(3.0);
  const Curve seat{{Variable::previous_push, Carrier::track}, -1.0, 1.0, 0.0, 0};
  const SearchResult result = searched(measured(model, {make_curve_effect(seat)}, {0.01, 0.0, 0.0, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law.variable, Variable::previous_push);
}

TEST(Tracing, a_mast_that_sways_is_flagged_and_kept_out_of_odometry) {
  const DriveModel model = jerky_model();
  const Curve sway{{Variable::turn_acceleration, Carrier::sensor_yaw}, -3.0, 3.0};
  const SearchResult result = searched(measured(model, {make_curve_effect(sway)}, {0.03, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, sway.law);
  EXPECT_EQ(result.curves[0].effect->storage(), Storage::driver);
}

TEST(Tracing, what_is_plain_but_too_small_to_be_told_stays_a_doubt_about_the_lengths) {
  const DriveModel model = jerky_model();
  const Curve sway{{Variable::turn_acceleration, Carrier::sensor_yaw}, -3.0, 3.0};
  const SearchResult result = searched(measured(model, {make_curve_effect(sway)}, {0.001, 0.0}));
  EXPECT_TRUE(result.curves.empty()) << "seed " << kSeed;
  ASSERT_FALSE(result.considered.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.considered.front().outcome, "too small to matter");
  EXPECT_GT(doubt_of(result), 1e-6);
}

TEST(Tracing, a_mast_that_follows_late_gets_its_lag) {
  const DriveModel model = jerky_model();
  Curve sway{{Variable::turn_acceleration, Carrier::sensor_yaw}, -3.0, 3.0};
  for (sway.memory = 0; sway.memory < kSwayLags.size(); ++sway.memory) {
    const SearchResult result = searched(measured(model, {make_curve_effect(sway)}, {0.03, 0.0}));
    ASSERT_TRUE(result.has_unnamed()) << kSwayLags[sway.memory] << " s, seed " << kSeed;
    EXPECT_EQ(result.curves[0].curve.law, sway.law);
    EXPECT_EQ(result.curves[0].curve.memory, sway.memory);
  }
}

// Slow or coarse ticks blur when a turn speeds up, which looks like a sensor that sways a little.
TEST(Tracing, a_sway_that_ticks_can_hide_is_not_believed) {
  const auto hidden = [](double period, double angle, double sway) {
    WheelTrack track;
    track.tick_period = period;
    track.tick_angle = angle;
    const DriveModel model(track, {});
    const DriveModel* models[] = {&model};
    FitResult fit;
    fit.parameters = to_vector(kBase, 2);
    fit.parameters.tail<2>() << sway, 0.0;
    return is_hidden_by_ticks({{Variable::turn_acceleration, Carrier::sensor_yaw}, -4.0, 4.0}, fit, models);
  };
  EXPECT_FALSE(hidden(0.02, 1e-3, 0.002));
  EXPECT_TRUE(hidden(0.1, 1e-3, 0.002));
  EXPECT_TRUE(hidden(0.02, 2e-2, 0.002));
  EXPECT_FALSE(hidden(0.1, 1e-3, 0.03));
}

TEST(Tracing, a_narrow_peak_gets_more_knots_and_the_wheel_a_wider_deviation) {
  const DriveModel model = lively_model();
  const Curve peak{{Variable::left_speed, Carrier::left_travel}, -0.3, 0.3, 0.0, 0, {}, 8};
  const std::vector<double> values = {0.0, 0.0, 0.0, -0.03, -0.03, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  const SearchResult result = searched(measured(model, {make_curve_effect(peak)}, values));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, peak.law);
  EXPECT_GT(result.curves[0].curve.knots, kKnots.front());
  double doubt = 0.0;
  for (const Eigen::VectorXd& d : result.doubts) doubt = std::hypot(doubt, d(kLeftRadius));
  const double deviation =
      std::hypot(doubt, std::sqrt(result.model.fit.covariance(kLeftRadius, kLeftRadius)));
  EXPECT_NEAR(result.model.fit.parameters(kLeftRadius), kBase.left_radius, 3.0 * deviation);
}

TEST(Tracing, a_law_that_takes_a_fifth_is_found_as_well) {
  const DriveModel model = jerky_model();
  Curve curve{{Variable::left_acceleration, Carrier::left_travel}, -1.0, 1.0};
  const SearchResult result = searched(measured(model, {make_curve_effect(curve)}, {0.2, 0.0, 0.0, 0.0}));
  ASSERT_FALSE(result.curves.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.curves.front().curve.law, curve.law);
  EXPECT_TRUE(result.curves.front().curve.strong);
  EXPECT_NEAR(result.model.fit.parameters(kLeftRadius), kBase.left_radius, 2e-4);
}

TEST(Tracing, what_other_shapes_would_make_of_a_length_is_doubted_by_their_probability) {
  const DriveModel model = lively_model(2.0);
  const auto doubts = [&](const char* name, double kappa) {
    const auto effect = find_effect(name);
    std::vector<double> values = start_of({effect});
    values.front() = kappa;
    const FitData data = measured(model, {effect}, values);
    const FitTask task{{&data, 1}, std::vector<bool>(kBaseCount, false)};
    const auto plain = fit_joint({&data, 1}, {}, to_vector(kBase));
    const auto found = plain ? with_effect(task, {{}, plain.value()}, effect, {}) : std::nullopt;
    EXPECT_TRUE(found) << name << ", seed " << kSeed;
    return found ? doubts_of_shape(task, *found, 0) : std::vector<Eigen::VectorXd>{};
  };
  const auto sum = [](const std::vector<Eigen::VectorXd>& all) {
    double of_squares = 0.0;
    for (const Eigen::VectorXd& doubt : all) of_squares += doubt(kTrackWidth) * doubt(kTrackWidth);
    return std::sqrt(of_squares);
  };
  const auto weak = doubts("track_depends_on_motion", 0.002),
             strong = doubts("track_depends_on_motion", 0.05);
  EXPECT_EQ(weak.size(), 3U);
  EXPECT_GT(sum(weak), 1e-5) << "m; any shape may be right";
  EXPECT_LT(sum(strong), sum(weak)) << "the data tell which";
  EXPECT_TRUE(doubts("lateral_slip", 0.03).empty()) << "scales no length";
}

TEST(Tracing, lengths_are_extrapolated_to_where_no_effect_is) {
  const DriveModel model = lively_model();
  const DriveModel fast = lively_model(3.0);
  const auto doubt = [](const DriveModel& drive, const char* name, const std::vector<double>& values) {
    const FitData data = measured(drive, {}, {});
    FittedModel found{{find_effect(name)}, {}};
    found.fit.parameters = to_vector(kBase, values.size());
    std::copy(values.begin(), values.end(), found.fit.parameters.data() + kBaseCount);
    return doubt_of_extrapolation({{&data, 1}, std::vector<bool>(kBaseCount, false)}, found, 0);
  };
  const double slow = doubt(model, "speed_dependent_radius", {0.02, 0.0})(kLeftRadius) / kBase.left_radius;
  EXPECT_GT(slow, 1e-5);
  EXPECT_NEAR(doubt(fast, "speed_dependent_radius", {0.02, 0.0})(kLeftRadius) / kBase.left_radius, 3.0 * slow,
              0.3 * slow);
  EXPECT_EQ(doubt(model, "wheel_eccentricity", {0.01, 0.0})(kLeftRadius), 0.0) << "of either sign";
  EXPECT_EQ(doubt(model, "carpet", {0.01, 0.0})(kLeftRadius), 0.0) << "of either sign";
  EXPECT_NEAR(doubt(model, "turn_direction_asymmetry", {0.01})(kTrackWidth), 0.005 * kBase.track_width, 1e-6)
      << "either way of turning may be the normal one";
}

TEST(Tracing, tiles_are_flagged_as_a_matter_of_the_place) {
  const DriveModel model = lively_model();
  Curve tiles{{Variable::position, Carrier::both_travel}};
  tiles.wave = {2.4, 1.8};  // every third of a metre
  const SearchResult result = searched(measured(model, {make_curve_effect(tiles)}, {0.0, 0.0, 0.06, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, tiles.law);
  EXPECT_NEAR(std::hypot(result.curves[0].curve.wave[0], result.curves[0].curve.wave[1]), 3.0, 0.3);
  EXPECT_EQ(result.curves[0].effect->storage(), Storage::nowhere);
}

/// Wheels as a first-order low pass shows them.
WheelTrack filtered(WheelTrack track, double lag) {
  for (std::vector<double>* wheel : {&track.left, &track.right}) {
    double state = wheel->front(), before = wheel->front();
    for (std::size_t k = 1; k < wheel->size(); ++k) {
      // Exact for an input that is linear between samples.
      const double now = (*wheel)[k], step = track.t[k] - track.t[k - 1], decay = std::exp(-step / lag);
      const double slope = (now - before) / step;
      state = decay * (state - before + slope * lag) + now - slope * lag;
      before = now;
      (*wheel)[k] = state;
    }
  }
  return track;
}

TEST(Tracing, a_filter_of_the_encoder_is_a_delay_that_smooths) {
  constexpr double kLag = 0.06;  // s
  const DriveModel model = jerky_model();
  WheelTrack late = filtered(model.track(), kLag);
  auto context = make_context(late, kBase);
  const DriveModel seen(std::move(late), std::move(context));
  FitData data = measured(model, {}, {});
  data.model = &seen;
  const EffectList offset = {find_effect("time_offset")};
  const auto fitted = [&](bool pure_delay) {
    FitOptions options;
    options.fixed = std::vector<bool>(kBaseCount + count_parameters(offset), false);
    options.fixed.back() = pure_delay;
    return fit_joint({&data, 1}, offset, to_vector(kBase, count_parameters(offset)), options);
  };
  const auto fit = fitted(false), delayed = fitted(true);
  ASSERT_TRUE(fit && delayed) << "seed " << kSeed;
  const auto& p = fit.value().parameters;
  EXPECT_NEAR(p(kBaseCount), -kLag, 2e-3);
  EXPECT_NEAR(p(kBaseCount + 1), kLag * kLag / 2.0, 0.3 * kLag * kLag / 2.0);
  EXPECT_LT(fit.value().rms.norm(), 0.5 * delayed.value().rms.norm());
}

TEST(Tracing, a_centre_of_turning_that_moves_is_flagged) {
  const DriveModel model = jerky_model();
  const Curve curve{{Variable::speed, Carrier::turn_side}, -0.4, 0.4};
  const SearchResult result =
      searched(measured(model, {make_curve_effect(curve)}, {0.002, 0.004, 0.006, 0.008, 0.0, 0.0}));
  ASSERT_EQ(result.curves.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.curves.front().curve.law, curve.law);
}

TEST(Tracing, a_wheel_whose_counts_are_older_than_the_others_is_named) {
  constexpr double kLag = 0.025;  // s
  const DriveModel model = jerky_model();
  WheelTrack late = model.track();
  for (std::size_t k = 1; k < late.left.size(); ++k)
    late.left[k] -= kLag / (late.t[k] - late.t[k - 1]) * (model.track().left[k] - model.track().left[k - 1]);
  auto context = make_context_of_moment(late, kBase, 0);
  const DriveModel seen(std::move(late), std::move(context));
  FitData data = measured(model, {}, {});
  data.model = &seen;
  const auto fit = fit_joint({&data, 1}, {find_effect("time_offset")}, to_vector(kBase, 2));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const SearchResult result = search_effects({&data, 1}, {find_effect("time_offset")}, fit.value(),
                                             std::vector<bool>(kBaseCount, false), [](double) {});
  ASSERT_FALSE(result.findings.empty());
  EXPECT_EQ(result.findings.front().effect->name(), "encoder_lag");
  EXPECT_NEAR(result.model.fit.parameters(kBaseCount + 2), kLag, 3e-3);
}

TEST(Tracing, columns_of_curves_are_their_derivatives) {
  const DriveModel model = lively_model();
  const FitData data = measured(model, {}, {});
  const auto fit = fit_joint({&data, 1}, {}, to_vector(kBase));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const DriveModel* models[] = {&model};
  for (const Curve& curve : candidate_curves(models)) {
    const auto effect = make_curve_effect(curve);
    const Candidate by_response{effect, curve, "a"}, by_jets{effect, std::nullopt, "b"};
    const auto columns = candidate_columns({&data, 1}, {}, fit.value(), {by_response, by_jets});
    EXPECT_LE((columns[0] - columns[1]).norm(), 1e-9 * columns[1].norm()) << effect->name();
  }
}

TEST(Tracing, how_long_a_robot_remembers_is_found_out) {
  const DriveModel model = jerky_model();
  const Curve twist{{Variable::previous_turn, Carrier::left_travel}, -1.0, 1.0, 0.0, 0, {}, 4, 0};
  const SearchResult result = searched(measured(model, {make_curve_effect(twist)}, {0.01, 0.0, 0.0, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, twist.law);
  EXPECT_EQ(result.curves[0].curve.memory, 0U);
}

TEST(Tracing, a_seat_that_only_the_opposite_push_changes_is_no_fading_memory) {
  const DriveModel model = lively_model(3.0);
  const std::size_t hard = kMemorySpans.size() + 2;
  const Curve seat{{Variable::previous_push, Carrier::track}, -1.0, 1.0, 0.0, 0, {}, 4, hard};
  const SearchResult result = searched(measured(model, {make_curve_effect(seat)}, {0.01}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, seat.law);
  EXPECT_EQ(result.curves[0].curve.memory, hard);
  EXPECT_NEAR(result.model.fit.parameters(kBaseCount), 0.01, 5e-4);
}

// Of a slight seat a fading memory shows too little to be found and put right afterwards.
TEST(Tracing, a_slight_seat_is_found_as_what_it_is) {
  const DriveModel model = jerky_model();
  const std::size_t hard = kMemorySpans.size() + 2;
  const Curve seat{{Variable::previous_push, Carrier::track}, -1.0, 1.0, 0.0, 0, {}, 4, hard};
  const SearchResult result = searched(measured(model, {make_curve_effect(seat)}, {0.001}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, seat.law);
  EXPECT_NEAR(result.model.fit.parameters(kTrackWidth), kBase.track_width, 2e-4);
}

TEST(Tracing, several_recordings_share_no_zero_of_time_heading_or_phase) {
  const DriveModel model = lively_model();
  const std::vector<const DriveModel*> one = {&model}, two = {&model, &model};
  const auto begins = [](const Curve& c) { return begins_with_the_recording(c.law.variable); };
  const auto alone = candidate_curves(one), together = candidate_curves(two);
  EXPECT_TRUE(std::any_of(alone.begin(), alone.end(), begins));
  EXPECT_TRUE(std::none_of(together.begin(), together.end(), begins));
}

TEST(Curve, is_zero_at_rest_but_on_the_turn_path) {
  for (int v = 0; v <= static_cast<int>(kLastVariable); ++v) {
    const auto variable = static_cast<Variable>(v);
    if (begins_with_the_recording(variable) || is_distance_since(variable)) continue;
    const Curve curve{{variable, Carrier::both_travel}, -0.7, 0.9, 0.0, 0};
    for (const double f : basis(curve, StepContext{})) EXPECT_NEAR(f, 0.0, 1e-12) << to_string(variable);
  }
  const Curve turn{{Variable::turn_rate, Carrier::turn_path}, -1.0, 1.0, 0.0, 0};
  EXPECT_EQ(basis(turn, StepContext{})[0], 1.0);
}

TEST(Curve, of_a_speed_is_zero_at_rest_with_any_knots) {
  for (const int knots : kKnots) {
    const Curve curve{{Variable::speed, Carrier::both_travel}, -0.5, 0.5, 0.0, 0, {}, knots};
    for (const double f : basis(curve, StepContext{})) EXPECT_NEAR(f, 0.0, 1e-12) << knots;
  }
}

/// Largest error of the curve that is nearest to a smooth bump, relative to its height.
double misfit_of_bump(const Curve& curve) {
  constexpr int kSpeeds = 200;
  const auto functions = static_cast<Eigen::Index>(basis_size(curve));
  Eigen::MatrixXd columns(kSpeeds, functions);
  Eigen::VectorXd bump(kSpeeds);
  for (int k = 0; k < kSpeeds; ++k) {
    StepContext c;
    c.speed = 0.5 * (k + 1) / kSpeeds;
    const BasisValues values = basis(curve, c);
    columns.row(k) = Eigen::Map<const Eigen::RowVectorXd>(values.begin(), functions);
    bump(k) = std::exp(-std::pow((c.speed - 0.27) / 0.06, 2));
  }
  const Eigen::VectorXd nearest = columns.colPivHouseholderQr().solve(bump);
  return (columns * nearest - bump).cwiseAbs().maxCoeff();
}

TEST(Curve, more_knots_describe_a_bump_better) {
  const Curve coarse{{Variable::speed, Carrier::both_travel}, -0.5, 0.5};
  const auto shapes = other_shapes(coarse, {});
  ASSERT_EQ(shapes.size(), kKnots.size() - 1);
  EXPECT_EQ(shapes.back().knots, kKnots.back());
  EXPECT_TRUE(other_shapes(shapes.back(), {}).empty());
  EXPECT_TRUE(other_shapes({{Variable::heading, Carrier::both_travel}, -1.0, 1.0}, {}).empty());
  double before = misfit_of_bump(coarse);
  for (const Curve& shape : shapes) {
    const double misfit = misfit_of_bump(shape);
    EXPECT_LT(misfit, 0.5 * before) << shape.knots;
    before = misfit;
  }
  EXPECT_LT(before, 0.01);
}

/// Of the best sum of the curve's functions and a constant to what is 1 in a square and 0 elsewhere.
double misfit_of_rug(const Curve& curve) {
  constexpr int kSteps = 30;  // each way
  const auto functions = static_cast<Eigen::Index>(basis_size(curve));
  Eigen::MatrixXd columns(kSteps * kSteps, functions + 1);
  Eigen::VectorXd rug(kSteps * kSteps);
  for (Eigen::Index k = 0; k < rug.size(); ++k) {
    StepContext c;
    const Eigen::Index column = k % kSteps, row = k / kSteps;
    c.x = -1.0 + 2.0 * static_cast<double>(column) / (kSteps - 1);
    c.y = -1.0 + 2.0 * static_cast<double>(row) / (kSteps - 1);
    const BasisValues values = basis(curve, c);
    columns.row(k) << 1.0, Eigen::Map<const Eigen::RowVectorXd>(values.begin(), functions);
    rug(k) = std::max(std::abs(c.x - 0.4), std::abs(c.y - 0.3)) < 0.35 ? 1.0 : 0.0;
  }
  const Eigen::VectorXd nearest = columns.completeOrthogonalDecomposition().solve(rug);
  return (columns * nearest - rug).norm() / rug.norm();
}

TEST(Curve, patches_describe_a_rug_better_than_polynomials) {
  const Curve smooth{{Variable::position, Carrier::both_travel}, -1.0, 1.0};
  const auto shapes = other_shapes(smooth, {});
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_TRUE(shapes[0].patches);
  EXPECT_LT(misfit_of_rug(shapes[0]), 0.8 * misfit_of_rug(smooth));
  for (const double place : {-3.0, -0.9, 0.0, 0.37, 1.0, 8.0}) {
    StepContext c;
    c.x = place;
    c.y = -0.7 * place;
    const BasisValues values = basis(shapes[0], c);
    EXPECT_NEAR(std::accumulate(values.begin(), values.end(), 0.0), 1.0, 1e-12) << place;
  }
}

TEST(Candidate, what_must_help_over_ten_seconds) {
  const auto ratio = [](Variable variable, Carrier carrier) {
    const Curve curve{{variable, carrier}, -1.0, 1.0};
    return largest_ratio({make_curve_effect(curve), curve, ""});
  };
  EXPECT_LT(ratio(Variable::speed, Carrier::both_travel), 1.0);
  EXPECT_LT(ratio(Variable::heading, Carrier::both_travel), ratio(Variable::speed, Carrier::both_travel));
  EXPECT_GT(ratio(Variable::left_phase, Carrier::left_travel), 1.0)
      << "cancels over whole turns of the wheel";
}

TEST(Curve, its_spread_is_that_of_the_law_over_the_drive) {
  const DriveModel model = lively_model();
  const DriveModel* models[] = {&model};
  const Curve wave{{Variable::left_phase, Carrier::left_travel}, 0.0, 1.0, 0.0, 5};
  // Root mean square of a sine, as the wheel passes all its angles alike.
  EXPECT_NEAR(spread_of(wave, std::vector<double>{0.01, 0.0}, models), 0.01 / std::sqrt(2.0), 2e-4);
}

TEST(Curve, about_its_mean_it_has_none_over_the_drive) {
  const DriveModel model = lively_model();
  const DriveModel* models[] = {&model};
  const Curve curve = centred({{Variable::left_speed, Carrier::left_travel}, -0.8, 0.8, 0.0, 0}, models);
  std::vector<double> sum(basis_size(curve), 0.0);
  double way = 0.0;
  for (const StepContext& c : model.context()) {
    way += std::abs(c.left_delta);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += std::abs(c.left_delta) * basis(curve, c)[k];
  }
  for (const double value : sum) EXPECT_NEAR(value / way, 0.0, 1e-12);
  const std::vector<FittedCurve> written = {{curve, std::vector<double>(sum.size(), 0.01), ""}};
  const auto read = curves_from_json(curves_to_json(written));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].curve.mean, curve.mean);
}

/// What is known of the outliers when these pairs are wrong by 20 mrad.
std::optional<OutlierTrace> traced(const DriveModel& model, const std::vector<std::size_t>& wrong) {
  FitData data = measured(model, {}, {});
  for (const std::size_t k : wrong) data.pairs[k].motion.yaw += 0.02;
  const auto fit = fit_joint({&data, 1}, {}, to_vector(kBase));
  EXPECT_TRUE(fit);
  return trace_outliers({&data, 1}, fit.value());
}

/// Every n-th pair of a range.
std::vector<std::size_t> pairs_between(std::size_t first, std::size_t end, std::size_t step) {
  std::vector<std::size_t> pairs;
  for (std::size_t k = first; k < end; k += step) pairs.push_back(k);
  return pairs;
}

TEST(OutlierTrace, is_silent_about_noise_and_single_bad_matches) {
  const DriveModel model = jerky_model();
  EXPECT_FALSE(traced(model, {}));
  EXPECT_FALSE(traced(model, {17, 140, 141, 333}));
}

TEST(OutlierTrace, says_when_something_happened) {
  const DriveModel model = jerky_model();
  const auto trace = traced(model, pairs_between(200, 230, 1));
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->outliers, 30U);
  ASSERT_FALSE(trace->depends_on.empty());
  EXPECT_EQ(trace->depends_on.front(), Variable::time);
  EXPECT_NEAR(trace->begin, 100.0, 2.0);
  EXPECT_NEAR(trace->end, 115.0, 2.0);
  EXPECT_NE(to_text(*trace).find("30 of 475"), std::string::npos) << to_text(*trace);
}

TEST(OutlierTrace, names_no_variable_when_outliers_are_anywhere) {
  const auto trace = traced(jerky_model(), pairs_between(3, 475, 31));
  ASSERT_TRUE(trace);
  EXPECT_TRUE(trace->depends_on.empty()) << to_text(*trace);
}

TEST(OutlierTrace, names_the_motion_that_goes_wrong) {
  const DriveModel model = jerky_model();
  const FitData data = measured(model, {}, {});
  std::vector<std::size_t> fast;
  for (std::size_t k = 0; k < data.pairs.size(); ++k)
    if (data.pairs[k].motion.yaw > 0.5) fast.push_back(k);
  ASSERT_GT(fast.size(), 10U);
  const auto trace = traced(model, fast);
  ASSERT_TRUE(trace);
  ASSERT_FALSE(trace->depends_on.empty());
  EXPECT_EQ(trace->depends_on.front(), Variable::turn_rate) << to_text(*trace);
}

TEST(StepContext, remembers_the_last_push_through_steady_motion) {
  WheelTrack track;
  double angle = 0.0, rate = 0.0;
  for (int k = 0; k <= 400; ++k) {  // speeds up for 1 s, goes on steadily, slows down for 0.5 s, goes on
    const double t = 0.02 * k;
    const double acceleration = t < 1.0 ? 5.0 : t > 4.0 && t < 4.5 ? -5.0 : 0.0;
    rate += 0.02 * acceleration;
    angle += 0.02 * rate;
    track.t.push_back(t);
    track.left.push_back(angle);
    track.right.push_back(angle);
    track.segment.push_back(0);
  }
  const auto context = make_context(track, kBase);
  EXPECT_EQ(context.front().previous_push[kUsualMemory], 0.0);
  EXPECT_GT(context[190].previous_push[kUsualMemory], 0.8);
  EXPECT_LT(context[350].previous_push[kUsualMemory], -0.5);
  const double push = 5.0 * kBase.left_radius;
  for (std::size_t k = 0; k < kPushes.size(); ++k) {
    const double stays = kPushes[k] < push ? 1.0 : 0.0;
    EXPECT_EQ(context[190].previous_push[kMemorySpans.size() + k], stays) << kPushes[k];
    EXPECT_EQ(context.back().previous_push[kMemorySpans.size() + k], -stays) << kPushes[k];
  }
}

TEST(StepContext, counts_from_stops_that_last) {
  WheelTrack track;
  double angle = 0.0;
  for (int k = 0; k <= 400; ++k) {  // stands for 0.3 s at 4 s, for 0.1 s at 6 s
    const double t = 0.02 * k;
    const bool stands = (t > 4.0 && t < 4.31) || (t > 6.0 && t < 6.11);
    if (!stands) angle += 0.1;
    track.t.push_back(t);
    track.left.push_back(angle);
    track.right.push_back(angle);
    track.segment.push_back(0);
  }
  const auto since = make_context(track, kBase).back().since_stop;
  const double step = 0.1 * kBase.left_radius;
  for (std::size_t k = 0; k < kStops.size(); ++k) {
    if (kStops[k] > 0.3)
      EXPECT_GT(since[k], 100.0) << kStops[k];
    else
      EXPECT_NEAR(since[k], (kStops[k] < 0.11 ? 94.0 : 179.0) * step, 2.0 * step) << kStops[k];
  }
}

TEST(Curve, every_carrier_acts_and_reverses_as_it_says) {
  StepContext ahead;
  ahead.dt = 0.02;
  ahead.speed = 0.3;
  ahead.turn_rate = 0.5;
  ahead.left_delta = ahead.right_delta = 0.08;
  StepContext back = ahead;
  back.speed = -0.3;
  back.turn_rate = -0.5;
  back.left_delta = back.right_delta = -0.08;
  for (int c = 0; c <= static_cast<int>(kLastCarrier); ++c) {
    const auto carrier = static_cast<Carrier>(c);
    const auto change = [&](const StepContext& context) {
      WheelStep<double> step{0.006, 0.006};
      if (context.speed < 0.0) step.left = step.right = -0.006;
      const WheelStep<double> before = step;
      carry(carrier, context, 0.01, step);
      return std::array{step.left - before.left, step.right - before.right, step.side, step.yaw,
                        step.track - 1.0};
    };
    const auto forth = change(ahead), reverse = change(back);
    const bool signed_by_motion = carrier == Carrier::left_travel || carrier == Carrier::right_travel ||
                                  carrier == Carrier::both_travel || carrier == Carrier::sideways ||
                                  carrier == Carrier::turn_side;
    double largest = 0.0;
    for (std::size_t k = 0; k < forth.size(); ++k) {
      EXPECT_NEAR(reverse[k], signed_by_motion ? -forth[k] : forth[k], 1e-15) << to_string(carrier);
      largest = std::max(largest, std::abs(forth[k]));
    }
    EXPECT_GT(largest, 0.0) << to_string(carrier);
  }
}

TEST(Curve, survives_the_calibration_file) {
  const Curve curve{{Variable::time, Carrier::both_travel}, 0.0, 290.0, 61.5, 0};
  Curve tiles{{Variable::position, Carrier::both_travel}};
  tiles.wave = {3.0, -0.5};
  const Curve rug = other_shapes({{Variable::position, Carrier::both_travel}, -1.0, 1.0}, {}).front();
  const auto read = curves_from_json(curves_to_json({{curve, {0.01, -0.02}, "drift_with_time"},
                                                     {tiles, {0.01, 0.0, 0.0, 0.0}, ""},
                                                     {rug, std::vector<double>(16, 0.01), ""}}));
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read[2].curve, rug);
  EXPECT_EQ(read[1].curve.wave, tiles.wave);
  EXPECT_EQ(read[0].curve.law, curve.law);
  EXPECT_EQ(read[0].curve.period, curve.period);
  EXPECT_EQ(read[0].coefficients, (std::vector<double>{0.01, -0.02}));
  EXPECT_EQ(read[0].law_of, "drift_with_time");
  EXPECT_TRUE(curves_from_json(R"([{"variable":"mood","carrier":"track","low":0,"high":1}])").empty());
  EXPECT_TRUE(curves_from_json("[{").empty());
}

/// A fit whose last parameters are those of the effect.
FitResult fit_with(const std::vector<double>& values, double deviation) {
  FitResult fit;
  fit.parameters = to_vector(kBase, values.size());
  std::copy(values.begin(), values.end(), fit.parameters.data() + kBaseCount);
  fit.covariance =
      deviation * deviation * Eigen::MatrixXd::Identity(fit.parameters.size(), fit.parameters.size());
  return fit;
}

TEST(Plausibility, bounds_size_and_need_are_judged_both_ways) {
  const auto effect = find_effect("speed_dependent_radius");
  EXPECT_EQ(impossibility(*effect, fit_with({0.02, 0.0}, 1e-3)), "");
  EXPECT_EQ(impossibility(*effect, fit_with({1.3, 0.0}, 1e-3)),
            "kappa of 1.3 s/m is outside its physical range");
  EXPECT_NE(impossibility(*effect, fit_with({std::nan(""), 0.0}, 1e-3)), "");
  EXPECT_FALSE(is_negligible(*effect, fit_with({0.002, 0.0}, 1e-3)));
  EXPECT_TRUE(is_negligible(*effect, fit_with({0.001, 0.0}, 1e-3)));
  EXPECT_FALSE(is_superfluous(*effect, kBaseCount, fit_with({0.003, 0.0}, 1e-3)));
  EXPECT_TRUE(is_superfluous(*effect, kBaseCount, fit_with({0.001, 0.0}, 1e-3)));
  EXPECT_FALSE(spoils_base(*effect, fit_with({0.0, 0.0}, 1e-3), fit_with({0.0, 0.0}, 2.9e-3)));
  EXPECT_TRUE(spoils_base(*effect, fit_with({0.0, 0.0}, 1e-3), fit_with({0.0, 0.0}, 3.1e-3)));
  EXPECT_FALSE(
      spoils_base(*find_effect("drift_with_time"), fit_with({0.0, 0.0}, 1e-3), fit_with({0.0, 0.0}, 9e-3)));
}

TEST(Plausibility, the_shape_of_an_effect_is_no_size) {
  EXPECT_TRUE(is_negligible(*find_effect("tick_loss"), fit_with({1e-4, 0.0, 0.4, 0.02}, 1e-3)));
  EXPECT_FALSE(is_negligible(*find_effect("tick_loss"), fit_with({0.01, 0.0, 0.4, 0.02}, 1e-3)));
}

TEST(Score, tail_of_chi_squared_agrees_with_tables) {
  EXPECT_NEAR(chi_squared_tail(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(chi_squared_tail(16.812, 6), 0.01, 1e-5);
  EXPECT_EQ(chi_squared_tail(0.0, 3), 1.0);
  EXPECT_EQ(chi_squared_tail(7.0, 0), 1.0);
}

TEST(Proof, what_makes_drives_worse_is_refused) {
  const DriveModel model = lively_model();
  FitData data = measured(model, {}, {});
  for (SensorPair& pair : data.pairs) pair.follows_previous = &pair != &data.pairs.front();
  const FitTask task{{&data, 1}, std::vector<bool>(kBaseCount, false)};
  const auto fit = fit_joint(task.data, {}, to_vector(kBase));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const FittedModel right{{}, fit.value()};
  FittedModel wrong = right;
  wrong.fit.parameters(kTrackWidth) *= 1.02;
  EXPECT_TRUE(spoils_drives(task, right, wrong));
  EXPECT_FALSE(spoils_drives(task, wrong, right));
  EXPECT_FALSE(spoils_drives(task, right, right));
}

TEST(HeldOut, two_models_are_compared_on_the_same_pairs) {
  const Eigen::Vector3d variance(1e-6, 1e-6, 1e-6), usual(1e-3, 1e-3, 1e-3), gross(1.0, 1.0, 1.0);
  std::vector<HeldOutError> before(100, {usual, variance}), after = before;
  before[0].error = after[0].error = gross;  // a failed match
  before[1].error = gross;                   // what the second model explains
  const auto of_before = held_out_residual(before, after), of_after = held_out_residual(after, before);
  ASSERT_TRUE(of_before && of_after);
  EXPECT_EQ(of_before->pairs, 99U);
  EXPECT_EQ(of_after->pairs, 99U);
  EXPECT_NEAR(of_before->rms[2], std::sqrt((1.0 + 98e-6) / 99.0), 1e-12);
  EXPECT_NEAR(of_after->rms[2], 1e-3, 1e-12);
}

TEST(StretchErrors, a_fold_that_would_not_have_chosen_keeps_its_error) {
  StretchErrors before, after;
  before.position = {1.0, 2.0, 3.0};
  before.heading = {0.1, 0.2, 0.3};
  before.fold = {0, 1, 4};
  before.block = {0, 1, 2};
  after = before;
  after.position = {0.1, 0.2, 0.3};
  const StretchErrors mixed = where_selected(before, after, {true, false, true, true, false});
  EXPECT_EQ(mixed.position, (std::vector<double>{0.1, 2.0, 3.0}));
}

}  // namespace
}  // namespace odomcalib::calib
