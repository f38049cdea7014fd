// What the robot does at the moment may change anything that it moves by: each law is found as what it is.
#include <gtest/gtest.h>

#include <tuple>

#include "calib/curves/basis.hpp"
#include "calib/curves/curve_effect.hpp"
#include "calib/curves/curve_on_drives.hpp"
#include "calib/tracing/search.hpp"
#include "tests/unit/calib/tracing_support.hpp"

namespace odomcalib::calib {
namespace {

struct FreeLawCase {
  Law law;
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
  for (const Carrier carrier : {Carrier::both_path, Carrier::left_travel, Carrier::sideways_path})
    all.push_back({{Variable::speed, carrier}, hump});
  all.push_back({{Variable::left_speed, Carrier::right_travel}, hump});
  all.push_back({kOfEachWheel, hump});
  for (const Carrier carrier : {Carrier::right_path, Carrier::sideways_path, Carrier::yaw_path})
    all.push_back({{Variable::turn_rate, carrier}, hump});
  for (const Carrier carrier : {Carrier::left_travel, Carrier::yaw_path})
    all.push_back({{Variable::lateral_acceleration, carrier}, slope});
  for (const Carrier carrier : {Carrier::both_travel, Carrier::track, Carrier::yaw_path})
    all.push_back({{Variable::acceleration, carrier}, slope});
  all.push_back({{Variable::time, Carrier::scale}, slope});
  return all;
}

class FreeLaws : public testing::TestWithParam<FreeLawCase> {};

TEST_P(FreeLaws, are_found_as_what_they_are) {
  const DriveModel model = jerky_model();
  const DriveModel* const models[] = {&model};
  Curve curve{GetParam().law};
  std::tie(curve.low, curve.high) = range_of(curve.law.variable, models);
  ASSERT_EQ(basis_size(curve), GetParam().coefficients.size());
  const SearchResult result = searched(measured(model, {make_curve_effect(curve)}, GetParam().coefficients));
  EXPECT_TRUE(result.findings.empty()) << result.findings.front().effect->name();
  ASSERT_FALSE(result.curves.empty()) << "seed " << kSeed;
  EXPECT_EQ(result.curves.front().curve.law, GetParam().law)
      << result.curves.front().effect->name() << ", seed " << kSeed;
}

INSTANTIATE_TEST_SUITE_P(Curve, FreeLaws, testing::ValuesIn(free_law_cases()));

}  // namespace
}  // namespace odomcalib::calib
