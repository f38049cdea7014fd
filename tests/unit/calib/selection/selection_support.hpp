// Wheels and sensor motions made from the model alone, and what the search makes of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "calib/selection/search.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "calib/vehicle/step_context.hpp"

namespace odomcalib::calib::selection {

inline const wheels::BaseParameters kBase{0.075, 0.074, 0.4, {0.1, 0.02, 0.3}};
inline constexpr unsigned kSeed = 4711;

/// Four minutes in which both wheels speed up, slow down and reverse on their own.
/// @param haste times the usual pace, over the same ground
inline vehicle::DriveModel lively_model(double haste = 1.0) {
  wheels::WheelTrack track;
  for (int k = 0; k <= 6000; ++k) {
    track.t.push_back(0.04 * k);
    const double t = haste * 0.04 * k;
    track.left.push_back(9.0 * std::sin(0.31 * t) + 4.0 * std::sin(0.113 * t) + 0.4 * t);
    track.right.push_back(8.0 * std::sin(0.43 * t + 0.5) + 5.0 * std::sin(0.097 * t) + 0.5 * t);
    track.segment.push_back(0);
  }
  const auto context = vehicle::make_context(track, kBase);
  return {std::move(track), context};
}

/// Four minutes, or another duration in s, of steady motions with short ramps between them.
inline vehicle::DriveModel jerky_model(double duration = 240.0) {
  constexpr double kStep = 0.04, kRamp = 0.4, kLeg = 2.0;  // s
  std::mt19937 engine(kSeed);
  std::uniform_real_distribution<double> speed(-5.0, 5.0);
  wheels::WheelTrack track;
  double left = 0.0, right = 0.0, from[2] = {}, to[2] = {};
  for (int k = 0; k <= std::lround(duration / kStep); ++k) {
    const double in_leg = std::fmod(kStep * k, kLeg);
    if (in_leg < kStep / 2.0)
      for (int side = 0; side < 2; ++side) from[side] = to[side], to[side] = speed(engine);
    const double share = std::min(in_leg / kRamp, 1.0);
    track.t.push_back(kStep * k);
    track.left.push_back(left += kStep * (from[0] + share * (to[0] - from[0])));
    track.right.push_back(right += kStep * (from[1] + share * (to[1] - from[1])));
    track.segment.push_back(0);
  }
  const auto context = vehicle::make_context(track, kBase);
  return {std::move(track), context};
}

/// Four minutes of straights and turns on the spot, both ways, a stop of a second after each.
inline vehicle::DriveModel stopping_model() {
  constexpr double kStep = 0.04, kRamp = 0.4, kMove = 2.0, kLeg = 3.0;  // s
  wheels::WheelTrack track;
  double left = 0.0, right = 0.0;
  for (int k = 0; k <= 6000; ++k) {
    const double in_leg = std::fmod(kStep * k, kLeg);
    const int leg = static_cast<int>(kStep * k / kLeg);
    const double share = std::clamp(std::min(in_leg, kMove - in_leg) / kRamp, 0.0, 1.0);
    const double way = leg % 5 < 2 ? 1.0 : -1.0, speed = way * (3.0 + leg % 3) * share;
    track.t.push_back(kStep * k);
    track.left.push_back(left += kStep * (leg % 2 == 0 ? speed : -speed));
    track.right.push_back(right += kStep * speed);
    track.segment.push_back(0);
  }
  const auto context = vehicle::make_context(track, kBase);
  return {std::move(track), context};
}

/// Measurements of a sensor with 0.5 mm and 0.5 mrad of noise, had the robot these effects.
inline measurement::FitData measured(const vehicle::DriveModel& model, const vehicle::EffectList& effects,
                                     const std::vector<double>& values,
                                     const std::vector<vehicle::Interval>& intervals) {
  Eigen::VectorXd p = vehicle::to_vector(kBase, values.size());
  std::copy(values.begin(), values.end(), p.data() + vehicle::kBaseCount);
  const auto motions = model.predict(vehicle::as_span(p), effects, intervals);
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> noise(0.0, 5e-4);
  measurement::FitData data{&model, {}};
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    const math::Pose& m = motions[k];
    data.pairs.push_back({intervals[k],
                          {m.x + noise(engine), m.y + noise(engine), m.yaw + noise(engine)},
                          Eigen::Vector3d::Constant(25e-8).asDiagonal(),
                          false});
  }
  return data;
}

/// Every half second.
inline measurement::FitData measured(const vehicle::DriveModel& model, const vehicle::EffectList& effects,
                                     const std::vector<double>& values) {
  std::vector<vehicle::Interval> intervals;
  for (double t = 0.513; t < 238.0; t += 0.5) intervals.push_back({t, t + 0.5});
  return measured(model, effects, values, intervals);
}

/// Result of the search on these data.
inline SearchResult searched(const measurement::FitData& data, const RuleSet& rules = {}) {
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  EXPECT_TRUE(fit) << "seed " << kSeed;
  return search_effects({&data, 1}, {}, fit.value(), std::vector<bool>(vehicle::kBaseCount, false), rules,
                        [](double) {});
}

}  // namespace odomcalib::calib::selection
