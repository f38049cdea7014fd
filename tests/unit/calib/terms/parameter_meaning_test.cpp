// What a report says of a parameter stands in one table: it has all of them, and no others.
#include "calib/terms/parameter_meaning.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "calib/terms/catalogue.hpp"
#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::terms::parameter_meaning_test {
namespace {

using Names = std::set<std::pair<std::string, std::string>>;

template <typename EffectOrLidarEffect>
void add_parameters(const EffectOrLidarEffect& effect, Names& names) {
  for (const auto& parameter : effect.parameters()) names.emplace(effect.name(), parameter.name);
}

Names of_catalogues() {
  Names names;
  for (const auto& effect : effect_catalogue()) add_parameters(*effect, names);
  for (const bool all_round : {false, true})
    for (const auto& effect : lidar_catalogue(all_round)) add_parameters(*effect, names);
  return names;
}

TEST(ParameterMeaning, stands_in_the_table_for_each_parameter_of_the_catalogues_and_no_other) {
  Names told;
  for (const ParameterMeaning& row : parameter_meanings())
    EXPECT_TRUE(told.emplace(row.effect, row.parameter).second)
        << row.effect << " " << row.parameter << " twice";
  EXPECT_EQ(told, of_catalogues());
}

}  // namespace
}  // namespace odomcalib::calib::terms::parameter_meaning_test
