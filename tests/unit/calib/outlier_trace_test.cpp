// What left-out pairs go with.
#include <gtest/gtest.h>

#include <optional>

#include "calib/tracing/outlier_trace.hpp"
#include "tests/unit/calib/tracing_support.hpp"

namespace odomcalib::calib {
namespace {

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

}  // namespace
}  // namespace odomcalib::calib
