// The momentary motion of the robot may change anything that it moves by: each law is found as what it is.
#include <gtest/gtest.h>

#include <tuple>

#include "calib/selection/search.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::free_term_test {
namespace {

struct FreeTermCase {
  vehicle::Dependence dependence;
  std::vector<double> coefficients;
};

std::ostream& operator<<(std::ostream& out, const FreeTermCase& c) {
  return out << to_string(c.dependence.covariate) << " on " << to_string(c.dependence.channel);
}

/// Zero but for one function.
std::vector<double> only(std::size_t function, std::size_t count, double value) {
  std::vector<double> all(count, 0.0);
  all[function] = value;
  return all;
}

std::vector<FreeTermCase> free_term_cases() {
  const std::vector<double> hump = only(1, 6, 0.015), slope = only(0, 4, 0.015);
  std::vector<FreeTermCase> all;
  for (const vehicle::Channel channel :
       {vehicle::Channel::both_path, vehicle::Channel::left_travel, vehicle::Channel::sideways_path})
    all.push_back({{vehicle::Covariate::speed, channel}, hump});
  all.push_back({{vehicle::Covariate::left_speed, vehicle::Channel::right_travel}, hump});
  all.push_back({vehicle::kOfEachWheel, hump});
  for (const vehicle::Channel channel :
       {vehicle::Channel::right_path, vehicle::Channel::sideways_path, vehicle::Channel::yaw_path})
    all.push_back({{vehicle::Covariate::turn_rate, channel}, hump});
  for (const vehicle::Channel channel : {vehicle::Channel::left_travel, vehicle::Channel::yaw_path})
    all.push_back({{vehicle::Covariate::lateral_acceleration, channel}, slope});
  for (const vehicle::Channel channel :
       {vehicle::Channel::both_travel, vehicle::Channel::track, vehicle::Channel::yaw_path})
    all.push_back({{vehicle::Covariate::acceleration, channel}, slope});
  all.push_back({{vehicle::Covariate::time, vehicle::Channel::scale}, slope});
  return all;
}

class FreeTerms : public testing::TestWithParam<FreeTermCase> {};

TEST_P(FreeTerms, are_found_as_what_they_are) {
  const vehicle::DriveModel model = jerky_model();
  const vehicle::DriveModel* const models[] = {&model};
  terms::SmoothTerm smooth{GetParam().dependence};
  std::tie(smooth.low, smooth.high) = terms::range_of(smooth.dependence.covariate, models);
  ASSERT_EQ(function_count(smooth), GetParam().coefficients.size());
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(smooth)}, GetParam().coefficients));
  EXPECT_TRUE(result.findings.empty()) << result.findings.front().effect->name();
  ASSERT_FALSE(result.smooths.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.smooths.front().smooth.dependence, GetParam().dependence)
      << result.smooths.front().effect->name() << ", seed " << kSeed;
}

INSTANTIATE_TEST_SUITE_P(SmoothTerm, FreeTerms, testing::ValuesIn(free_term_cases()));

}  // namespace
}  // namespace odomcalib::calib::selection::free_term_test
