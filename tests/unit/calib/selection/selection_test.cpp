// From residual to missing effect, on wheels and sensor motions made from the model alone.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <set>

#include "calib/selection/candidate_columns.hpp"
#include "calib/selection/hyperparameters.hpp"
#include "calib/selection/plausibility.hpp"
#include "calib/selection/search.hpp"
#include "calib/terms/candidate_smooths.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/vehicle/placed_effects.hpp"
#include "calib/vehicle/step_context.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::selection_test {
namespace {

TEST(Selection, adds_nothing_when_nothing_is_missing) {
  const vehicle::DriveModel model = lively_model();
  const SearchResult result = searched(measured(model, {}, {}));
  EXPECT_TRUE(result.findings.empty());
  EXPECT_TRUE(result.smooths.empty());
  EXPECT_EQ(result.model.fit.parameters.size(), vehicle::kBaseCount);
}

/// Sum of squares of what the search doubts about the base.
double uncertainty_of(const SearchResult& result) {
  double sum = 0.0;
  for (const Eigen::VectorXd& uncertainty : result.model_uncertainties) sum += uncertainty.squaredNorm();
  return std::sqrt(sum);
}

TEST(Selection, a_name_that_is_plain_in_few_stretches_only_stays_a_doubt_about_the_lengths) {
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
  EXPECT_GT(uncertainty_of(result), 1e-5);
  EXPECT_EQ(uncertainty_of(searched(measured(model, {}, {}))), 0.0);
}

TEST(Selection, so_does_a_curve_that_is_plain_in_one_half_only) {
  const vehicle::DriveModel model = jerky_model();
  const terms::SmoothTerm dependence{
      {vehicle::Covariate::left_acceleration, vehicle::Channel::left_travel}, -1.0, 1.0};
  measurement::FitData data = measured(model, {}, {});
  const measurement::FitData with =
      measured(model, {make_smooth_term_effect(dependence)}, {0.03, 0.0, 0.0, 0.0});
  std::copy(with.pairs.begin(), with.pairs.begin() + 120, data.pairs.begin());
  const SearchResult result = searched(data);
  EXPECT_TRUE(result.smooths.empty());
  ASSERT_FALSE(result.considered.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.considered.front().outcome, "no gain on held-out data");
  EXPECT_GT(uncertainty_of(result), 1e-6);
}

TEST(Selection, names_what_is_in_the_catalogue_and_finds_its_size) {
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
    EXPECT_LE(result.findings[0].validation.family_p_value, 0.003) << c.name;
    for (std::size_t k = 0; k < c.values.size(); ++k) {
      const auto index = static_cast<Eigen::Index>(vehicle::kBaseCount + k);
      EXPECT_NEAR(result.model.fit.parameters(index), c.values[k],
                  4.0 * std::sqrt(result.model.fit.covariance(index, index)) + 1e-3)
          << c.name << " " << k;
    }
  }
}

TEST(Selection, a_curve_on_the_ground_of_the_second_best_name_takes_no_name_from_it) {
  const vehicle::DriveModel model = lively_model();
  // A wheel out of round by more than its first harmonic, on a carpet that explains a little more than that.
  const auto wheel =
      terms::make_smooth_term_effect({{vehicle::Covariate::left_phase, vehicle::Channel::left_travel}});
  const SearchResult result = searched(
      measured(model, {terms::find_effect("carpet"), wheel}, {0.014, 0.0, 0.01, 0.01, 0.007, 0.0, 0.0, 0.0}));
  std::set<std::string> names;
  for (const Finding& finding : result.findings) names.insert(finding.effect->name());
  EXPECT_EQ(names, (std::set<std::string>{"carpet", "wheel_eccentricity"})) << "seed " << kSeed;
  for (const AddedSmoothTerm& smooth : result.smooths) EXPECT_NE(smooth.named_term, nullptr);
}

// A refit may begin in a shape that scores little and come to one that was not among those that were scored.
TEST(Selection, a_name_is_held_against_curves_in_the_best_of_its_shapes) {
  const vehicle::DriveModel model = jerky_model();
  for (const double threshold : {0.16, 0.22, 0.28}) {
    const auto data = measured(model, {terms::find_effect("tick_loss")}, {0.02, 0.0, threshold, 0.005});
    const SearchResult result = searched(data);
    ASSERT_EQ(result.findings.size(), 1U) << threshold << " seed " << kSeed;
    EXPECT_EQ(result.findings[0].effect->name(), "tick_loss");
    EXPECT_FALSE(result.has_unnamed()) << threshold;
  }
}

TEST(Selection, shapes_that_are_tried_are_not_fitted) {
  for (const char* name : {"drift_with_time", "caster_kick"}) {
    const auto parameters = terms::find_effect(name)->parameters();
    EXPECT_TRUE(std::any_of(
        parameters.begin(), parameters.end(),
        [](const vehicle::EffectParameter& parameter) { return parameter.fixed && parameter.start != 0.0; }))
        << name;
    EXPECT_FALSE(parameters.front().fixed) << name;
  }
}

TEST(Selection, says_which_variable_when_it_has_no_name) {
  const vehicle::DriveModel model = lively_model();
  const terms::SmoothTerm swing = on_basis(
      {{vehicle::Covariate::left_phase, vehicle::Channel::left_travel}, 0.0, 1.0}, terms::Harmonics{5});
  const SearchResult result = searched(measured(model, {make_smooth_term_effect(swing)}, {0.03, 0.01}));
  EXPECT_TRUE(result.findings.empty());
  ASSERT_TRUE(result.has_unnamed());
  EXPECT_EQ(result.smooths[0].smooth.dependence, swing.dependence);
  EXPECT_EQ(result.smooths[0].smooth.basis, terms::Basis(terms::Harmonics{5}));
}

TEST(Selection, a_clock_is_asked_before_what_happened_before) {
  const vehicle::DriveModel model = lively_model();
  const SearchResult result = searched(measured(model, {terms::find_effect("time_offset")}, {0.03, 0.0}));
  ASSERT_EQ(result.findings.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.findings[0].effect->name(), "time_offset");
  EXPECT_TRUE(result.smooths.empty());
}

TEST(Selection, a_wheel_that_keeps_what_the_last_push_did_is_flagged) {
  const vehicle::DriveModel model = lively_model(3.0);
  const terms::SmoothTerm seat{
      {vehicle::Covariate::previous_acceleration, vehicle::Channel::track}, -1.0, 1.0};
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(seat)}, {0.01, 0.0, 0.0, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.smooths[0].smooth.dependence.covariate, vehicle::Covariate::previous_acceleration);
}

TEST(Selection, a_wheel_that_slips_while_it_is_braked_follows_one_law_both_ways) {
  const vehicle::DriveModel model = jerky_model();
  terms::SmoothTerm brake{{vehicle::Covariate::left_acceleration, vehicle::Channel::left_travel}, -1.0, 1.0};
  brake.with_motion = true;
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(brake)}, {0.01, -0.01, 0.0, 0.0}));
  ASSERT_EQ(result.smooths.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.smooths[0].smooth.dependence, brake.dependence);
  EXPECT_TRUE(result.smooths[0].smooth.with_motion);
  EXPECT_TRUE(result.findings.empty());
}

TEST(Selection, slip_of_braking_or_of_driving_alone_keeps_its_name) {
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
    EXPECT_TRUE(result.smooths.empty());
  }
}

TEST(Selection, a_base_that_turns_back_after_stops_is_named) {
  const vehicle::DriveModel model = stopping_model();
  const auto data = measured(model, {terms::find_effect("stop_settling")}, {-0.004, 0.0, 0.0, 0.0});
  const SearchResult result = searched(data);
  ASSERT_EQ(result.findings.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.findings[0].effect->name(), "stop_settling");
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount), -0.004, 0.0008);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount + 1), 0.0, 0.0005);
}

TEST(Selection, a_mast_that_sways_is_flagged_and_kept_out_of_odometry) {
  const vehicle::DriveModel model = jerky_model();
  const terms::SmoothTerm sway{
      {vehicle::Covariate::turn_acceleration, vehicle::Channel::sensor_yaw}, -3.0, 3.0};
  const SearchResult result = searched(measured(model, {make_smooth_term_effect(sway)}, {0.03, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.smooths[0].smooth.dependence, sway.dependence);
  EXPECT_EQ(result.smooths[0].effect->storage(), vehicle::Storage::driver);
}

TEST(Selection, what_is_plain_but_too_small_to_be_told_stays_a_doubt_about_the_lengths) {
  const vehicle::DriveModel model = jerky_model();
  const terms::SmoothTerm sway{
      {vehicle::Covariate::turn_acceleration, vehicle::Channel::sensor_yaw}, -3.0, 3.0};
  const SearchResult result = searched(measured(model, {make_smooth_term_effect(sway)}, {0.001, 0.0}));
  EXPECT_TRUE(result.smooths.empty()) << "seed " << kSeed;
  ASSERT_FALSE(result.considered.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.considered.front().outcome, "too small to matter");
  EXPECT_GT(uncertainty_of(result), 1e-6);
}

TEST(Selection, a_mast_that_follows_late_gets_its_lag) {
  const vehicle::DriveModel model = jerky_model();
  terms::SmoothTerm sway{{vehicle::Covariate::turn_acceleration, vehicle::Channel::sensor_yaw}, -3.0, 3.0};
  for (sway.memory = 0; sway.memory < vehicle::kSwayLags.size(); ++sway.memory) {
    const SearchResult result = searched(measured(model, {make_smooth_term_effect(sway)}, {0.03, 0.0}));
    ASSERT_TRUE(result.has_unnamed()) << vehicle::kSwayLags[sway.memory] << " s, seed " << kSeed;
    EXPECT_EQ(result.smooths[0].smooth.dependence, sway.dependence);
    EXPECT_EQ(result.smooths[0].smooth.memory, sway.memory);
  }
}

// Slow or coarse ticks blur when a turn speeds up, which looks like a sensor that sways a little.
TEST(Selection, a_sway_that_ticks_can_hide_is_not_believed) {
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
        {{vehicle::Covariate::turn_acceleration, vehicle::Channel::sensor_yaw}, -4.0, 4.0}, fit, models);
  };
  EXPECT_FALSE(hidden(0.02, 1e-3, 0.002));
  EXPECT_TRUE(hidden(0.1, 1e-3, 0.002));
  EXPECT_TRUE(hidden(0.02, 2e-2, 0.002));
  EXPECT_FALSE(hidden(0.1, 1e-3, 0.03));
}

TEST(Selection, a_narrow_peak_gets_splines_and_the_wheel_a_wider_deviation) {
  const vehicle::DriveModel model = lively_model();
  const terms::SmoothTerm peak = on_basis(
      {{vehicle::Covariate::left_speed, vehicle::Channel::left_travel}, -0.3, 0.3}, terms::Splines{8});
  const std::vector<double> values = {0.0, 0.0, 0.0, -0.03, -0.03, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  const SearchResult result = searched(measured(model, {make_smooth_term_effect(peak)}, values));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.smooths[0].smooth.dependence, peak.dependence);
  EXPECT_TRUE(terms::basis_as<terms::Splines>(result.smooths[0].smooth));
  double uncertainty = 0.0;
  for (const Eigen::VectorXd& d : result.model_uncertainties)
    uncertainty = std::hypot(uncertainty, d(vehicle::kLeftRadius));
  const double deviation = std::hypot(
      uncertainty, std::sqrt(result.model.fit.covariance(vehicle::kLeftRadius, vehicle::kLeftRadius)));
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kLeftRadius), kBase.left_radius, 3.0 * deviation);
}

TEST(Selection, a_law_that_takes_a_fifth_is_found_as_well) {
  const vehicle::DriveModel model = jerky_model();
  terms::SmoothTerm smooth{{vehicle::Covariate::left_acceleration, vehicle::Channel::left_travel}, -1.0, 1.0};
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(smooth)}, {0.2, 0.0, 0.0, 0.0}));
  ASSERT_FALSE(result.smooths.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.smooths.front().smooth.dependence, smooth.dependence);
  EXPECT_TRUE(result.smooths.front().smooth.strong);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kLeftRadius), kBase.left_radius, 2e-4);
}

TEST(Selection, what_other_shapes_would_make_of_a_length_is_doubted_by_their_probability) {
  const vehicle::DriveModel model = lively_model(2.0);
  const auto model_uncertainties = [&](const char* name, double kappa) {
    const auto effect = terms::find_effect(name);
    std::vector<double> values = vehicle::start_of({effect});
    values.front() = kappa;
    const measurement::FitData data = measured(model, {effect}, values);
    const FitTask task{{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)};
    const auto plain = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
    const auto found = plain ? with_effect(task, {{}, plain.value()}, effect, {}) : std::nullopt;
    EXPECT_TRUE(found) << name << ", seed " << kSeed;
    return found ? uncertainties_of_shape(task, *found, 0) : std::vector<Eigen::VectorXd>{};
  };
  const auto sum = [](const std::vector<Eigen::VectorXd>& all) {
    double of_squares = 0.0;
    for (const Eigen::VectorXd& uncertainty : all)
      of_squares += uncertainty(vehicle::kTrackWidth) * uncertainty(vehicle::kTrackWidth);
    return std::sqrt(of_squares);
  };
  const auto weak = model_uncertainties("track_depends_on_motion", 0.002),
             strong = model_uncertainties("track_depends_on_motion", 0.05);
  EXPECT_EQ(weak.size(), 3U);
  EXPECT_GT(sum(weak), 1e-5) << "m; any shape may be right";
  EXPECT_LT(sum(strong), sum(weak)) << "the data tell which";
  EXPECT_TRUE(model_uncertainties("lateral_slip", 0.03).empty()) << "scales no length";
}

TEST(Selection, lengths_are_extrapolated_to_where_no_effect_is) {
  const vehicle::DriveModel model = lively_model();
  const vehicle::DriveModel fast = lively_model(3.0);
  const auto uncertainty = [](const vehicle::DriveModel& drive, const char* name,
                              const std::vector<double>& values) {
    const measurement::FitData data = measured(drive, {}, {});
    FittedModel found{{terms::find_effect(name)}, {}};
    found.fit.parameters = vehicle::to_vector(kBase, values.size());
    std::copy(values.begin(), values.end(), found.fit.parameters.data() + vehicle::kBaseCount);
    return uncertainty_of_extrapolation({{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)}, found,
                                        {0});
  };
  const double slow =
      uncertainty(model, "speed_dependent_radius", {0.02, 0.0})(vehicle::kLeftRadius) / kBase.left_radius;
  EXPECT_GT(slow, 1e-5);
  EXPECT_NEAR(
      uncertainty(fast, "speed_dependent_radius", {0.02, 0.0})(vehicle::kLeftRadius) / kBase.left_radius,
      3.0 * slow, 0.3 * slow);
  EXPECT_EQ(uncertainty(model, "wheel_eccentricity", {0.01, 0.0})(vehicle::kLeftRadius), 0.0)
      << "of either sign";
  EXPECT_EQ(uncertainty(model, "carpet", {0.01, 0.0})(vehicle::kLeftRadius), 0.0) << "of either sign";
  EXPECT_NEAR(uncertainty(model, "turn_direction_asymmetry", {0.01})(vehicle::kTrackWidth),
              0.005 * kBase.track_width, 1e-6)
      << "either way of turning may be the normal one";
}

/// A wheel that goes 2 % farther whichever way it turns is, as a name and a smooth term, one of 2 % that
/// shrinks by four when it rolls back; its diameter may be that of either way, or what lies between.
TEST(Selection, a_name_and_an_unsigned_law_beside_it_leave_all_between_their_extremes_open) {
  const vehicle::DriveModel model = lively_model();
  const measurement::FitData data = measured(model, {}, {});
  terms::SmoothTerm unsigned_way{{vehicle::Covariate::left_speed, vehicle::Channel::left_path}, -0.5, 0.5};
  FittedModel found{
      {terms::find_effect("direction_dependent_diameter"), make_smooth_term_effect(unsigned_way)}, {}};
  std::vector<double> values(2 + function_count(unsigned_way), 0.0);
  values[0] = -0.04;
  found.fit.parameters = vehicle::to_vector(kBase, values.size());
  std::copy(values.begin(), values.end(), found.fit.parameters.data() + vehicle::kBaseCount);
  const FitTask task{{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)};
  EXPECT_EQ(uncertainty_of_extrapolation(task, found, {0})(vehicle::kLeftRadius), 0.0)
      << "the name alone: forward is normal";
  EXPECT_NEAR(uncertainty_of_extrapolation(task, found, {0, 1})(vehicle::kLeftRadius),
              0.02 * kBase.left_radius, 1e-6);
  EXPECT_EQ(uncertainty_of_extrapolation(task, found, {0, 1})(vehicle::kRightRadius), 0.0);
}

TEST(Selection, tiles_are_flagged_as_a_matter_of_the_place) {
  const vehicle::DriveModel model = lively_model();
  terms::SmoothTerm tiles{{vehicle::Covariate::position, vehicle::Channel::both_travel}};
  tiles.basis = terms::Wave{2.4, 1.8};  // every third of a metre
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(tiles)}, {0.0, 0.0, 0.06, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.smooths[0].smooth.dependence, tiles.dependence);
  const auto& wave = std::get<terms::Wave>(result.smooths[0].smooth.basis);
  EXPECT_NEAR(std::hypot(wave.along_x, wave.along_y), 3.0, 0.3);
  EXPECT_EQ(result.smooths[0].effect->storage(), vehicle::Storage::nowhere);
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

TEST(Selection, a_filter_of_the_encoder_is_a_delay_that_smooths) {
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

TEST(Selection, a_centre_of_turning_that_moves_is_flagged) {
  const vehicle::DriveModel model = jerky_model();
  const terms::SmoothTerm smooth{{vehicle::Covariate::speed, vehicle::Channel::turn_side}, -0.4, 0.4};
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(smooth)}, {0.002, 0.004, 0.006, 0.008, 0.0, 0.0}));
  ASSERT_EQ(result.smooths.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.smooths.front().smooth.dependence, smooth.dependence);
}

TEST(Selection, but_beside_a_mast_that_sways_it_is_the_head_that_moves) {
  const vehicle::DriveModel model = jerky_model();
  const terms::SmoothTerm sway{
      {vehicle::Covariate::turn_acceleration, vehicle::Channel::sensor_yaw}, -3.0, 3.0};
  const terms::SmoothTerm sideways{{vehicle::Covariate::speed, vehicle::Channel::turn_side}, -0.4, 0.4};
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(sway), make_smooth_term_effect(sideways)},
                        {0.03, 0.0, 0.002, 0.004, 0.006, 0.008, 0.0, 0.0}));
  ASSERT_FALSE(result.smooths.empty()) << "seed " << kSeed;
  for (const AddedSmoothTerm& added : result.smooths)
    EXPECT_NE(added.smooth.dependence.channel, vehicle::Channel::turn_side);
}

TEST(Selection, a_wheel_whose_counts_are_older_than_the_others_is_named) {
  constexpr double kLag = 0.025;  // s
  const vehicle::DriveModel model = jerky_model();
  wheels::WheelTrack late = model.track();
  for (std::size_t k = 1; k < late.left.size(); ++k)
    late.left[k] -= kLag / (late.t[k] - late.t[k - 1]) * (model.track().left[k] - model.track().left[k - 1]);
  auto context = vehicle::make_context_of_moment(late, kBase);
  const vehicle::DriveModel seen(std::move(late), {std::move(context), nullptr});
  measurement::FitData data = measured(model, {}, {});
  data.model = &seen;
  const auto fit =
      estimation::fit_joint({&data, 1}, {terms::find_effect("time_offset")}, vehicle::to_vector(kBase, 2));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const SearchResult result =
      search_effects({&data, 1}, {terms::find_effect("time_offset")}, fit.value(),
                     std::vector<bool>(vehicle::kBaseCount, false), {}, [](double) {});
  ASSERT_FALSE(result.findings.empty());
  EXPECT_EQ(result.findings.front().effect->name(), "encoder_lag");
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount + 2), kLag, 3e-3);
}

TEST(Selection, columns_of_curves_are_their_derivatives) {
  const vehicle::DriveModel model = lively_model();
  const measurement::FitData data = measured(model, {}, {});
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const vehicle::DriveModel* models[] = {&model};
  for (const terms::SmoothTerm& smooth : terms::candidate_smooths(models)) {
    const auto effect = make_smooth_term_effect(smooth);
    const Candidate by_response{effect, smooth, "a"}, by_jets{effect, std::nullopt, "b"};
    const auto columns = candidate_columns({&data, 1}, {}, fit.value(), {by_response, by_jets});
    EXPECT_LE((columns[0] - columns[1]).norm(), 1e-9 * columns[1].norm()) << effect->name();
  }
}

TEST(Selection, how_long_a_robot_remembers_is_found_out) {
  const vehicle::DriveModel model = jerky_model();
  const terms::SmoothTerm twist{
      {vehicle::Covariate::previous_turn, vehicle::Channel::left_travel}, -1.0, 1.0, 0};
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(twist)}, {0.01, 0.0, 0.0, 0.0}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.smooths[0].smooth.dependence, twist.dependence);
  EXPECT_EQ(result.smooths[0].smooth.memory, 0U);
}

TEST(Selection, a_seat_that_only_the_opposite_push_changes_is_no_fading_memory) {
  const vehicle::DriveModel model = lively_model(3.0);
  const std::size_t hard = vehicle::kMemorySpans.size() + 2;
  const terms::SmoothTerm seat{
      {vehicle::Covariate::previous_acceleration, vehicle::Channel::track}, -1.0, 1.0, hard};
  const SearchResult result = searched(measured(model, {make_smooth_term_effect(seat)}, {0.01}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.smooths[0].smooth.dependence, seat.dependence);
  EXPECT_GE(result.smooths[0].smooth.memory, vehicle::kMemorySpans.size())
      << "which threshold it is, this drive leaves open";
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount), 0.01, 5e-4);
}

// A fading memory shows too little of a slight seat to be found and put right afterwards.
TEST(Selection, a_slight_seat_is_found_as_what_it_is) {
  const vehicle::DriveModel model = jerky_model();
  const std::size_t hard = vehicle::kMemorySpans.size() + 2;
  const terms::SmoothTerm seat{
      {vehicle::Covariate::previous_acceleration, vehicle::Channel::track}, -1.0, 1.0, hard};
  const SearchResult result = searched(measured(model, {make_smooth_term_effect(seat)}, {0.001}));
  ASSERT_TRUE(result.has_unnamed()) << "seed " << kSeed;
  EXPECT_EQ(result.smooths[0].smooth.dependence, seat.dependence);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kTrackWidth), kBase.track_width, 2e-4);
}

TEST(Selection, several_recordings_share_no_zero_of_time_heading_or_phase) {
  const vehicle::DriveModel model = lively_model();
  const std::vector<const vehicle::DriveModel*> one = {&model}, two = {&model, &model};
  const auto begins = [](const terms::SmoothTerm& c) {
    return begins_with_the_recording(c.dependence.covariate);
  };
  const auto alone = terms::candidate_smooths(one), together = terms::candidate_smooths(two);
  EXPECT_TRUE(std::any_of(alone.begin(), alone.end(), begins));
  EXPECT_TRUE(std::none_of(together.begin(), together.end(), begins));
}

}  // namespace
}  // namespace odomcalib::calib::selection::selection_test
