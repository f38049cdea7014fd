// Variables that left-out pairs go with.
#include <gtest/gtest.h>

#include <optional>

#include "calib/report/outlier_trace.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::report::outlier_trace_test {
namespace {

using selection::jerky_model;
using selection::kBase;
using selection::measured;

/// Trace of the outliers when these pairs are wrong by 20 mrad.
std::optional<OutlierTrace> traced(const vehicle::DriveModel& model, const std::vector<std::size_t>& wrong) {
  measurement::FitData data = measured(model, {}, {});
  for (const std::size_t k : wrong) data.pairs[k].motion.yaw += 0.02;
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
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
  const vehicle::DriveModel model = jerky_model();
  EXPECT_FALSE(traced(model, {}));
  EXPECT_FALSE(traced(model, {17, 140, 141, 333}));
}

TEST(OutlierTrace, says_when_something_happened) {
  const vehicle::DriveModel model = jerky_model();
  const auto trace = traced(model, pairs_between(200, 230, 1));
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->outliers, 30U);
  ASSERT_FALSE(trace->depends_on.empty());
  EXPECT_EQ(trace->depends_on.front(), vehicle::Covariate::time);
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
  const vehicle::DriveModel model = jerky_model();
  const measurement::FitData data = measured(model, {}, {});
  std::vector<std::size_t> fast;
  for (std::size_t k = 0; k < data.pairs.size(); ++k)
    if (data.pairs[k].motion.yaw > 0.5) fast.push_back(k);
  ASSERT_GT(fast.size(), 10U);
  const auto trace = traced(model, fast);
  ASSERT_TRUE(trace);
  ASSERT_FALSE(trace->depends_on.empty());
  EXPECT_EQ(trace->depends_on.front(), vehicle::Covariate::turn_rate) << to_text(*trace);
}

/// Where the scans of these pairs were taken.
std::vector<measurement::PlacedScan> places_of(const std::vector<measurement::SensorPair>& pairs) {
  std::vector<measurement::PlacedScan> places;
  math::Pose here;
  for (const measurement::SensorPair& pair : pairs) {
    places.push_back({pair.interval.begin, here, 1e-8 * Eigen::Matrix3d::Identity()});
    here = compose(here, pair.motion);
  }
  places.push_back({pairs.back().interval.end, here, 1e-8 * Eigen::Matrix3d::Identity()});
  return places;
}

enum class Guilty { wheels, matches };

/// Cause of outliers where the robot comes 30 mm less far than its wheels, or where a match says so.
OutlierCause cause_when(Guilty guilty) {
  const vehicle::DriveModel model = jerky_model();
  measurement::FitData data = measured(model, {}, {});
  if (guilty == Guilty::matches) data.places = places_of(data.pairs);
  for (const std::size_t k : pairs_between(3, 475, 31)) {
    const double way = std::hypot(data.pairs[k].motion.x, data.pairs[k].motion.y);
    data.pairs[k].motion.x -= 0.03 * data.pairs[k].motion.x / way;
    data.pairs[k].motion.y -= 0.03 * data.pairs[k].motion.y / way;
  }
  if (guilty == Guilty::wheels) data.places = places_of(data.pairs);
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  EXPECT_TRUE(fit);
  return cause_of_outliers({&data, 1}, {}, fit.value());
}

TEST(OutlierCause, a_map_tells_slip_from_failed_matches) {
  const OutlierCause slip = cause_when(Guilty::wheels), failed = cause_when(Guilty::matches);
  EXPECT_GE(slip.confirmed, 14U);
  EXPECT_EQ(slip.confirmed, slip.placed);
  EXPECT_NEAR(slip.farther, -0.03, 0.005);
  EXPECT_GE(failed.placed, 14U);
  EXPECT_EQ(failed.confirmed, 0U);
  EXPECT_EQ(failed.farther, 0.0);
}

TEST(OutlierCause, nothing_is_said_without_a_map) {
  const vehicle::DriveModel model = jerky_model();
  measurement::FitData data = measured(model, {}, {});
  for (const std::size_t k : pairs_between(3, 475, 31)) data.pairs[k].motion.yaw += 0.02;
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  ASSERT_TRUE(fit);
  auto trace = trace_outliers({&data, 1}, fit.value());
  ASSERT_TRUE(trace);
  trace->cause = cause_of_outliers({&data, 1}, {}, fit.value());
  EXPECT_EQ(trace->cause.placed, 0U);
  EXPECT_EQ(to_text(*trace).find("map"), std::string::npos) << to_text(*trace);
  EXPECT_NE(to_text(*trace).find("pairs of scans"), std::string::npos) << to_text(*trace);
  trace->of_poses = true;
  EXPECT_NE(to_text(*trace).find("pairs of poses"), std::string::npos) << to_text(*trace);
  trace->of_poses = false;
  trace->cause = {14, 12, -0.0123, 0.0};
  EXPECT_NE(
      to_text(*trace).find("the map confirms 12 of 14: there the robot moved otherwise than its wheels, "
                           "came 12.3 mm less far"),
      std::string::npos)
      << to_text(*trace);
}

}  // namespace
}  // namespace odomcalib::calib::report::outlier_trace_test
