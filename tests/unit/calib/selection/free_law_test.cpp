// What the robot does at the moment may change anything that it moves by: each law is found as what it is.
#include <gtest/gtest.h>

#include <tuple>

#include "calib/selection/search.hpp"
#include "calib/terms/curve_effect.hpp"
#include "calib/terms/curve_on_drives.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection {
namespace {

struct FreeLawCase {
  vehicle::Law law;
  std::vector<double> coefficients;
};

std::ostream& operator<<(std::ostream& out, const FreeLawCase& c) {
  return out << to_string(c.law.variable) << " on " << to_string(c.law.carrier);
}

/// Zero but for one function.
std::vector<double> only(std::size_t function, std::size_t count, double value) {
  std::vector<double> all(count, 0.0);
  all[function] = value;
  return all;
}

std::vector<FreeLawCase> free_law_cases() {
  const std::vector<double> hump = only(1, 6, 0.015), slope = only(0, 4, 0.015);
  std::vector<FreeLawCase> all;
  for (const vehicle::Carrier carrier :
       {vehicle::Carrier::both_path, vehicle::Carrier::left_travel, vehicle::Carrier::sideways_path})
    all.push_back({{vehicle::Variable::speed, carrier}, hump});
  all.push_back({{vehicle::Variable::left_speed, vehicle::Carrier::right_travel}, hump});
  all.push_back({vehicle::kOfEachWheel, hump});
  for (const vehicle::Carrier carrier :
       {vehicle::Carrier::right_path, vehicle::Carrier::sideways_path, vehicle::Carrier::yaw_path})
    all.push_back({{vehicle::Variable::turn_rate, carrier}, hump});
  for (const vehicle::Carrier carrier : {vehicle::Carrier::left_travel, vehicle::Carrier::yaw_path})
    all.push_back({{vehicle::Variable::lateral_acceleration, carrier}, slope});
  for (const vehicle::Carrier carrier :
       {vehicle::Carrier::both_travel, vehicle::Carrier::track, vehicle::Carrier::yaw_path})
    all.push_back({{vehicle::Variable::acceleration, carrier}, slope});
  all.push_back({{vehicle::Variable::time, vehicle::Carrier::scale}, slope});
  return all;
}

class FreeLaws : public testing::TestWithParam<FreeLawCase> {};

TEST_P(FreeLaws, are_found_as_what_they_are) {
  const vehicle::DriveModel model = jerky_model();
  const vehicle::DriveModel* const models[] = {&model};
  terms::Curve curve{GetParam().law};
  std::tie(curve.low, curve.high) = terms::range_of(curve.law.variable, models);
  ASSERT_EQ(function_count(curve), GetParam().coefficients.size());
  const SearchResult result = searched(measured(model, {make_curve_effect(curve)}, GetParam().coefficients));
  EXPECT_TRUE(result.findings.empty()) << result.findings.front().effect->name();
  ASSERT_FALSE(result.curves.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.curves.front().curve.law, GetParam().law)
      << result.curves.front().effect->name() << ", seed " << kSeed;
}

INSTANTIATE_TEST_SUITE_P(Curve, FreeLaws, testing::ValuesIn(free_law_cases()));

}  // namespace
}  // namespace odomcalib::calib::selection
