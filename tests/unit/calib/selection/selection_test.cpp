// From residual to missing effect, on wheels and sensor motions made from the model alone.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <set>

#include "calib/selection/candidate_columns.hpp"
#include "calib/selection/law_shape.hpp"
#include "calib/selection/plausibility.hpp"
#include "calib/selection/search.hpp"
#include "calib/terms/candidate_curves.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/curve_effect.hpp"
#include "calib/vehicle/placed_effects.hpp"
#include "calib/vehicle/step_context.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection {
namespace {

TEST(Tracing, adds_nothing_when_nothing_is_missing) {
  const vehicle::DriveModel model = lively_model();
  const SearchResult result = searched(measured(model, {}, {}));
  EXPECT_TRUE(result.findings.empty());
  EXPECT_TRUE(result.curves.empty());
  EXPECT_EQ(result.model.fit.parameters.size(), vehicle::kBaseCount);
}

/// Sum of squares of what the search doubts about the base.
double doubt_of(const SearchResult& result) {
  double sum = 0.0;
  for (const Eigen::VectorXd& doubt : result.doubts) sum += doubt.squaredNorm();
  return std::sqrt(sum);
}

TEST(Tracing, a_name_that_is_plain_in_few_stretches_only_stays_a_doubt_about_the_lengths) {
  const vehicle::DriveModel model = lively_model();
  measurement::FitData data = measured(model, {}, {});
  const measurement::FitData with =
      measured(model, {terms::find_effect("direction_dependent_diameter")}, {0.03, 0.03});
  for (const auto& [first, count] :
       {std::pair{20, 40}, std::pair{430, 40}})  // of 475, so that it is no event
    std::copy_n(with.pairs.begin() + first, count, data.pairs.begin() + first);
  const SearchResult result = searched(data);
  EXPECT_TRUE(result.findings.empty());
  ASSERT_FALSE(result.considered.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.considered.front().outcome, "no gain on held-out data");
  EXPECT_GT(doubt_of(result), 1e-5);
  EXPECT_EQ(doubt_of(searched(measured(model, {}, {}))), 0.0);
}

TEST(Tracing, so_does_a_curve_that_is_plain_in_one_half_only) {
  const vehicle::DriveModel model = jerky_model();
  const terms::Curve law{{vehicle::Variable::left_acceleration, vehicle::Carrier::left_travel}, -1.0, 1.0};
  measurement::FitData data = measured(model, {}, {});
  const measurement::FitData with = measured(model, {make_curve_effect(law)}, {0.03, 0.0, 0.0, 0.0});
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
    const vehicle::DriveModel model = lively_model(c.haste);
    const SearchResult result = searched(measured(model, {terms::find_effect(c.name)}, c.values));
    ASSERT_EQ(result.findings.size(), 1U) << c.name << ", seed " << kSeed;
    EXPECT_EQ(result.findings[0].effect->name(), c.name);
    EXPECT_LE(result.findings[0].proof.family_p_value, 0.003) << c.name;
    for (std::size_t k = 0; k < c.values.size(); ++k) {
      const auto index = static_cast<Eigen::Index>(vehicle::kBaseCount + k);
      EXPECT_NEAR(result.model.fit.parameters(index), c.values[k],
                  4.0 * std::sqrt(result.model.fit.covariance(index, index)) + 1e-3)
          << c.name << " " << k;
    }
  }
}

TEST(Tracing, a_curve_on_the_ground_of_the_second_best_name_takes_no_name_from_it) {
  const vehicle::DriveModel model = lively_model();
  // A wheel out of round by more than its first harmonic, on a carpet that explains a little more than that.
  const auto wheel =
      terms::make_curve_effect({{vehicle::Variable::left_phase, vehicle::Carrier::left_travel}});
  const SearchResult result = searched(
      measured(model, {terms::find_effect("carpet"), wheel}, {0.014, 0.0, 0.01, 0.01, 0.007, 0.0, 0.0, 0.0}));
  std::set<std::string> names;
  for (const Finding& finding : result.findings) names.insert(finding.effect->name());
  EXPECT_EQ(names, (std::set<std::string>{"carpet", "wheel_eccentricity"})) << "seed " << kSeed;
  for (const AddedCurve& curve : result.curves) EXPECT_NE(curve.law_of, nullptr);
}

// A refit may begin in a shape that scores little and come to one that was not among those that were scored.
TEST(Tracing, a_name_is_held_against_curves_in_the_best_of_its_shapes) {
  const vehicle::DriveModel model = jerky_model();
  for (const double threshold : {0.16, 0.22, 0.28}) {
    const auto data = measured(model, {terms::find_effect("tick_loss")}, {0.02, 0.0, threshold, 0.005});
    const SearchResult result = searched(data);
    ASSERT_EQ(result.findings.size(), 1U) << threshold << " seed " << kSeed;
    EXPECT_EQ(result.findings[0].effect->name(), "tick_loss");
    EXPECT_FALSE(result.has_unnamed()) << threshold;
  }
}

TEST(Tracing, shapes_that_are_tried_are_not_fitted) {
  for (const char* name : {"drift_with_time", "caster_kick"}) {
    const auto parameters = terms::find_effect(name)->parameters();
    EXPECT_TRUE(std::any_of(
        parameters.begin(), parameters.end(),
        [](const vehicle::EffectParameter& parameter) { return parameter.fixed && parameter.start != 0.0; }))
        << name;
    EXPECT_FALSE(parameters.front().fixed) << name;
  }
}

TEST(Tracing, says_which_variable_when_it_has_no_name) {
  const vehicle::DriveModel model = lively_model();
  const terms::Curve swing = on_basis(
      {{vehicle::Variable::left_phase, vehicle::Carrier::left_travel}, 0.0, 1.0}, terms::Harmonics{5});
  const SearchResult result = searched(measured(model, {make_curve_effect(swing)}, {0.03, 0.01}));
  EXPECT_TRUE(result.findings.empty());
  ASSERT_TRUE(result.has_unnamed());
  EXPECT_EQ(result.curves[0].curve.law, swing.law);
  EXPECT_EQ(result.curves[0].curve.basis, terms::Basis(terms::Harmonics{5}));
}

TEST(Tracing, a_clock_is_asked_before_what_happened_before) {
  const vehicle::DriveModel model = lively_model();
  const SearchResult result = searched(measured(model, {terms::find_effect("time_offset")}, {0.03, 0.0}));
  ASSERT_EQ(result.findings.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.findings[0].effect->name(), "time_offset");
  EXPECT_TRUE(result.curves.empty());
}

TEST(Tracing, a_wheel_that_keeps_what_the_last_push_did_is_flagged) {
  const vehicle::DriveModel model = lively_model(3.0);
  const terms::Curve seat{{vehicle::Variable::previous_push, vehicle::Carrier::track}, -1.0, 1.0};
  const SearchResult result = searched(measured(model, {make_curve_effect(seat)}, {0.01, 0.0, 0.0, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law.variable, vehicle::Variable::previous_push);
}

TEST(Tracing, a_wheel_that_slips_while_it_is_braked_follows_one_law_both_ways) {
  const vehicle::DriveModel model = jerky_model();
  terms::Curve brake{{vehicle::Variable::left_acceleration, vehicle::Carrier::left_travel}, -1.0, 1.0};
  brake.with_motion = true;
  const SearchResult result = searched(measured(model, {make_curve_effect(brake)}, {0.01, -0.01, 0.0, 0.0}));
  ASSERT_EQ(result.curves.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, brake.law);
  EXPECT_TRUE(result.curves[0].curve.with_motion);
  EXPECT_TRUE(result.findings.empty());
}

TEST(Tracing, slip_of_braking_or_of_driving_alone_keeps_its_name) {
  const vehicle::DriveModel model = jerky_model();
  for (const double side : {-1.0, 1.0}) {
    const SearchResult result =
        searched(measured(model, {terms::find_effect("acceleration_slip")}, {0.03, side}));
    ASSERT_EQ(result.findings.size(), 1U) << "seed " << kSeed;
    EXPECT_EQ(result.findings[0].effect->name(), "acceleration_slip");
    EXPECT_EQ(result.findings[0].effect->parameters()[1].start, side);
    const auto& effects = result.model.effects;
    const auto place = std::find(effects.begin(), effects.end(), result.findings[0].effect);
    const auto first = first_parameter(effects, static_cast<std::size_t>(place - effects.begin()));
    EXPECT_NEAR(result.model.fit.parameters(first), 0.03, 0.003);
    EXPECT_TRUE(result.curves.empty());
  }
}

TEST(Tracing, a_base_that_turns_back_after_stops_is_named) {
  const vehicle::DriveModel model = stopping_model();
  const auto data = measured(model, {terms::find_effect("stop_settling")}, {-0.004, 0.0, 0.0, 0.0});
  const SearchResult result = searched(data);
  ASSERT_EQ(result.findings.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.findings[0].effect->name(), "stop_settling");
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount), -0.004, 0.0008);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount + 1), 0.0, 0.0005);
}

TEST(Tracing, a_mast_that_sways_is_flagged_and_kept_out_of_odometry) {
  const vehicle::DriveModel model = jerky_model();
  const terms::Curve sway{{vehicle::Variable::turn_acceleration, vehicle::Carrier::sensor_yaw}, -3.0, 3.0};
  const SearchResult result = searched(measured(model, {make_curve_effect(sway)}, {0.03, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, sway.law);
  EXPECT_EQ(result.curves[0].effect->storage(), vehicle::Storage::driver);
}

TEST(Tracing, what_is_plain_but_too_small_to_be_told_stays_a_doubt_about_the_lengths) {
  const vehicle::DriveModel model = jerky_model();
  const terms::Curve sway{{vehicle::Variable::turn_acceleration, vehicle::Carrier::sensor_yaw}, -3.0, 3.0};
  const SearchResult result = searched(measured(model, {make_curve_effect(sway)}, {0.001, 0.0}));
  EXPECT_TRUE(result.curves.empty()) << "seed " << kSeed;
  ASSERT_FALSE(result.considered.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.considered.front().outcome, "too small to matter");
  EXPECT_GT(doubt_of(result), 1e-6);
}

TEST(Tracing, a_mast_that_follows_late_gets_its_lag) {
  const vehicle::DriveModel model = jerky_model();
  terms::Curve sway{{vehicle::Variable::turn_acceleration, vehicle::Carrier::sensor_yaw}, -3.0, 3.0};
  for (sway.memory = 0; sway.memory < vehicle::kSwayLags.size(); ++sway.memory) {
    const SearchResult result = searched(measured(model, {make_curve_effect(sway)}, {0.03, 0.0}));
    ASSERT_TRUE(result.has_unnamed()) << vehicle::kSwayLags[sway.memory] << " s, seed " << kSeed;
    EXPECT_EQ(result.curves[0].curve.law, sway.law);
    EXPECT_EQ(result.curves[0].curve.memory, sway.memory);
  }
}

// Slow or coarse ticks blur when a turn speeds up, which looks like a sensor that sways a little.
TEST(Tracing, a_sway_that_ticks_can_hide_is_not_believed) {
  const auto hidden = [](double period, double angle, double sway) {
    wheels::WheelTrack track;
    track.tick_period = period;
    track.tick_angle = angle;
    const vehicle::DriveModel model(track, {});
    const vehicle::DriveModel* models[] = {&model};
    estimation::FitResult fit;
    fit.parameters = vehicle::to_vector(kBase, 2);
    fit.parameters.tail<2>() << sway, 0.0;
    return is_hidden_by_ticks(
        {{vehicle::Variable::turn_acceleration, vehicle::Carrier::sensor_yaw}, -4.0, 4.0}, fit, models);
  };
  EXPECT_FALSE(hidden(0.02, 1e-3, 0.002));
  EXPECT_TRUE(hidden(0.1, 1e-3, 0.002));
  EXPECT_TRUE(hidden(0.02, 2e-2, 0.002));
  EXPECT_FALSE(hidden(0.1, 1e-3, 0.03));
}

TEST(Tracing, a_narrow_peak_gets_splines_and_the_wheel_a_wider_deviation) {
  const vehicle::DriveModel model = lively_model();
  const terms::Curve peak = on_basis(
      {{vehicle::Variable::left_speed, vehicle::Carrier::left_travel}, -0.3, 0.3}, terms::Splines{8});
  const std::vector<double> values = {0.0, 0.0, 0.0, -0.03, -0.03, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  const SearchResult result = searched(measured(model, {make_curve_effect(peak)}, values));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, peak.law);
  EXPECT_TRUE(terms::basis_as<terms::Splines>(result.curves[0].curve));
  double doubt = 0.0;
  for (const Eigen::VectorXd& d : result.doubts) doubt = std::hypot(doubt, d(vehicle::kLeftRadius));
  const double deviation =
      std::hypot(doubt, std::sqrt(result.model.fit.covariance(vehicle::kLeftRadius, vehicle::kLeftRadius)));
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kLeftRadius), kBase.left_radius, 3.0 * deviation);
}

TEST(Tracing, a_law_that_takes_a_fifth_is_found_as_well) {
  const vehicle::DriveModel model = jerky_model();
  terms::Curve curve{{vehicle::Variable::left_acceleration, vehicle::Carrier::left_travel}, -1.0, 1.0};
  const SearchResult result = searched(measured(model, {make_curve_effect(curve)}, {0.2, 0.0, 0.0, 0.0}));
  ASSERT_FALSE(result.curves.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.curves.front().curve.law, curve.law);
  EXPECT_TRUE(result.curves.front().curve.strong);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kLeftRadius), kBase.left_radius, 2e-4);
}

TEST(Tracing, what_other_shapes_would_make_of_a_length_is_doubted_by_their_probability) {
  const vehicle::DriveModel model = lively_model(2.0);
  const auto doubts = [&](const char* name, double kappa) {
    const auto effect = terms::find_effect(name);
    std::vector<double> values = vehicle::start_of({effect});
    values.front() = kappa;
    const measurement::FitData data = measured(model, {effect}, values);
    const FitTask task{{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)};
    const auto plain = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
    const auto found = plain ? with_effect(task, {{}, plain.value()}, effect, {}) : std::nullopt;
    EXPECT_TRUE(found) << name << ", seed " << kSeed;
    return found ? doubts_of_shape(task, *found, 0) : std::vector<Eigen::VectorXd>{};
  };
  const auto sum = [](const std::vector<Eigen::VectorXd>& all) {
    double of_squares = 0.0;
    for (const Eigen::VectorXd& doubt : all)
      of_squares += doubt(vehicle::kTrackWidth) * doubt(vehicle::kTrackWidth);
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
  const vehicle::DriveModel model = lively_model();
  const vehicle::DriveModel fast = lively_model(3.0);
  const auto doubt = [](const vehicle::DriveModel& drive, const char* name,
                        const std::vector<double>& values) {
    const measurement::FitData data = measured(drive, {}, {});
    FittedModel found{{terms::find_effect(name)}, {}};
    found.fit.parameters = vehicle::to_vector(kBase, values.size());
    std::copy(values.begin(), values.end(), found.fit.parameters.data() + vehicle::kBaseCount);
    return doubt_of_extrapolation({{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)}, found, {0});
  };
  const double slow =
      doubt(model, "speed_dependent_radius", {0.02, 0.0})(vehicle::kLeftRadius) / kBase.left_radius;
  EXPECT_GT(slow, 1e-5);
  EXPECT_NEAR(doubt(fast, "speed_dependent_radius", {0.02, 0.0})(vehicle::kLeftRadius) / kBase.left_radius,
              3.0 * slow, 0.3 * slow);
  EXPECT_EQ(doubt(model, "wheel_eccentricity", {0.01, 0.0})(vehicle::kLeftRadius), 0.0) << "of either sign";
  EXPECT_EQ(doubt(model, "carpet", {0.01, 0.0})(vehicle::kLeftRadius), 0.0) << "of either sign";
  EXPECT_NEAR(doubt(model, "turn_direction_asymmetry", {0.01})(vehicle::kTrackWidth),
              0.005 * kBase.track_width, 1e-6)
      << "either way of turning may be the normal one";
}

/// A wheel that goes 2 % farther whichever way it turns is, as a name and a curve, one of 2 % that shrinks by
/// four when it rolls back; its diameter may be that of either way, or what lies between.
TEST(Tracing, a_name_and_an_unsigned_law_beside_it_leave_all_between_their_extremes_open) {
  const vehicle::DriveModel model = lively_model();
  const measurement::FitData data = measured(model, {}, {});
  terms::Curve unsigned_way{{vehicle::Variable::left_speed, vehicle::Carrier::left_path}, -0.5, 0.5};
  FittedModel found{{terms::find_effect("direction_dependent_diameter"), make_curve_effect(unsigned_way)},
                    {}};
  std::vector<double> values(2 + function_count(unsigned_way), 0.0);
  values[0] = -0.04;
  found.fit.parameters = vehicle::to_vector(kBase, values.size());
  std::copy(values.begin(), values.end(), found.fit.parameters.data() + vehicle::kBaseCount);
  const FitTask task{{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)};
  EXPECT_EQ(doubt_of_extrapolation(task, found, {0})(vehicle::kLeftRadius), 0.0)
      << "the name alone: forward is normal";
  EXPECT_NEAR(doubt_of_extrapolation(task, found, {0, 1})(vehicle::kLeftRadius), 0.02 * kBase.left_radius,
              1e-6);
  EXPECT_EQ(doubt_of_extrapolation(task, found, {0, 1})(vehicle::kRightRadius), 0.0);
}

TEST(Tracing, tiles_are_flagged_as_a_matter_of_the_place) {
  const vehicle::DriveModel model = lively_model();
  terms::Curve tiles{{vehicle::Variable::position, vehicle::Carrier::both_travel}};
  tiles.basis = terms::Wave{2.4, 1.8};  // every third of a metre
  const SearchResult result = searched(measured(model, {make_curve_effect(tiles)}, {0.0, 0.0, 0.06, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, tiles.law);
  const auto& wave = std::get<terms::Wave>(result.curves[0].curve.basis);
  EXPECT_NEAR(std::hypot(wave.along_x, wave.along_y), 3.0, 0.3);
  EXPECT_EQ(result.curves[0].effect->storage(), vehicle::Storage::nowhere);
}

/// Wheels as a first-order low pass shows them.
wheels::WheelTrack filtered(wheels::WheelTrack track, double lag) {
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
  const vehicle::DriveModel model = jerky_model();
  wheels::WheelTrack late = filtered(model.track(), kLag);
  auto context = vehicle::make_context(late, kBase);
  const vehicle::DriveModel seen(std::move(late), std::move(context));
  measurement::FitData data = measured(model, {}, {});
  data.model = &seen;
  const vehicle::EffectList offset = {terms::find_effect("time_offset")};
  const auto fitted = [&](bool pure_delay) {
    estimation::FitOptions options;
    options.fixed = std::vector<bool>(vehicle::kBaseCount + vehicle::count_parameters(offset), false);
    options.fixed.back() = pure_delay;
    return fit_joint({&data, 1}, offset, vehicle::to_vector(kBase, vehicle::count_parameters(offset)),
                     options);
  };
  const auto fit = fitted(false), delayed = fitted(true);
  ASSERT_TRUE(fit && delayed) << "seed " << kSeed;
  const auto& p = fit.value().parameters;
  EXPECT_NEAR(p(vehicle::kBaseCount), -kLag, 2e-3);
  EXPECT_NEAR(p(vehicle::kBaseCount + 1), kLag * kLag / 2.0, 0.3 * kLag * kLag / 2.0);
  EXPECT_LT(fit.value().rms.norm(), 0.5 * delayed.value().rms.norm());
}

TEST(Tracing, a_centre_of_turning_that_moves_is_flagged) {
  const vehicle::DriveModel model = jerky_model();
  const terms::Curve curve{{vehicle::Variable::speed, vehicle::Carrier::turn_side}, -0.4, 0.4};
  const SearchResult result =
      searched(measured(model, {make_curve_effect(curve)}, {0.002, 0.004, 0.006, 0.008, 0.0, 0.0}));
  ASSERT_EQ(result.curves.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.curves.front().curve.law, curve.law);
}

TEST(Tracing, but_beside_a_mast_that_sways_it_is_the_head_that_moves) {
  const vehicle::DriveModel model = jerky_model();
  const terms::Curve sway{{vehicle::Variable::turn_acceleration, vehicle::Carrier::sensor_yaw}, -3.0, 3.0};
  const terms::Curve sideways{{vehicle::Variable::speed, vehicle::Carrier::turn_side}, -0.4, 0.4};
  const SearchResult result = searched(measured(model, {make_curve_effect(sway), make_curve_effect(sideways)},
                                                {0.03, 0.0, 0.002, 0.004, 0.006, 0.008, 0.0, 0.0}));
  ASSERT_FALSE(result.curves.empty()) << "seed " << kSeed;
  for (const AddedCurve& added : result.curves)
    EXPECT_NE(added.curve.law.carrier, vehicle::Carrier::turn_side);
}

TEST(Tracing, a_wheel_whose_counts_are_older_than_the_others_is_named) {
  constexpr double kLag = 0.025;  // s
  const vehicle::DriveModel model = jerky_model();
  wheels::WheelTrack late = model.track();
  for (std::size_t k = 1; k < late.left.size(); ++k)
    late.left[k] -= kLag / (late.t[k] - late.t[k - 1]) * (model.track().left[k] - model.track().left[k - 1]);
  auto context = vehicle::make_context_of_moment(late, kBase, 0);
  const vehicle::DriveModel seen(std::move(late), std::move(context));
  measurement::FitData data = measured(model, {}, {});
  data.model = &seen;
  const auto fit =
      estimation::fit_joint({&data, 1}, {terms::find_effect("time_offset")}, vehicle::to_vector(kBase, 2));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const SearchResult result = search_effects({&data, 1}, {terms::find_effect("time_offset")}, fit.value(),
                                             std::vector<bool>(vehicle::kBaseCount, false), [](double) {});
  ASSERT_FALSE(result.findings.empty());
  EXPECT_EQ(result.findings.front().effect->name(), "encoder_lag");
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount + 2), kLag, 3e-3);
}

TEST(Tracing, columns_of_curves_are_their_derivatives) {
  const vehicle::DriveModel model = lively_model();
  const measurement::FitData data = measured(model, {}, {});
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const vehicle::DriveModel* models[] = {&model};
  for (const terms::Curve& curve : terms::candidate_curves(models)) {
    const auto effect = make_curve_effect(curve);
    const Candidate by_response{effect, curve, "a"}, by_jets{effect, std::nullopt, "b"};
    const auto columns = candidate_columns({&data, 1}, {}, fit.value(), {by_response, by_jets});
    EXPECT_LE((columns[0] - columns[1]).norm(), 1e-9 * columns[1].norm()) << effect->name();
  }
}

TEST(Tracing, how_long_a_robot_remembers_is_found_out) {
  const vehicle::DriveModel model = jerky_model();
  const terms::Curve twist{{vehicle::Variable::previous_turn, vehicle::Carrier::left_travel}, -1.0, 1.0, 0};
  const SearchResult result = searched(measured(model, {make_curve_effect(twist)}, {0.01, 0.0, 0.0, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, twist.law);
  EXPECT_EQ(result.curves[0].curve.memory, 0U);
}

TEST(Tracing, a_seat_that_only_the_opposite_push_changes_is_no_fading_memory) {
  const vehicle::DriveModel model = lively_model(3.0);
  const std::size_t hard = vehicle::kMemorySpans.size() + 2;
  const terms::Curve seat{{vehicle::Variable::previous_push, vehicle::Carrier::track}, -1.0, 1.0, hard};
  const SearchResult result = searched(measured(model, {make_curve_effect(seat)}, {0.01}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, seat.law);
  EXPECT_EQ(result.curves[0].curve.memory, hard);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount), 0.01, 5e-4);
}

// Of a slight seat a fading memory shows too little to be found and put right afterwards.
TEST(Tracing, a_slight_seat_is_found_as_what_it_is) {
  const vehicle::DriveModel model = jerky_model();
  const std::size_t hard = vehicle::kMemorySpans.size() + 2;
  const terms::Curve seat{{vehicle::Variable::previous_push, vehicle::Carrier::track}, -1.0, 1.0, hard};
  const SearchResult result = searched(measured(model, {make_curve_effect(seat)}, {0.001}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.curves[0].curve.law, seat.law);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kTrackWidth), kBase.track_width, 2e-4);
}

TEST(Tracing, several_recordings_share_no_zero_of_time_heading_or_phase) {
  const vehicle::DriveModel model = lively_model();
  const std::vector<const vehicle::DriveModel*> one = {&model}, two = {&model, &model};
  const auto begins = [](const terms::Curve& c) { return begins_with_the_recording(c.law.variable); };
  const auto alone = terms::candidate_curves(one), together = terms::candidate_curves(two);
  EXPECT_TRUE(std::any_of(alone.begin(), alone.end(), begins));
  EXPECT_TRUE(std::none_of(together.begin(), together.end(), begins));
}

}  // namespace
}  // namespace odomcalib::calib::selection
