// The statements of a report on parameters stand in one table: it has all parameters, and no others.
#include "calib/terms/parameter_meaning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

TEST(ParameterMeaning, has_labels_that_tell_the_parameters_of_an_effect_apart) {
  Names labels;
  for (const ParameterMeaning& row : parameter_meanings()) {
    EXPECT_TRUE(labels.emplace(row.effect, row.label).second) << row.effect << " " << row.label << " twice";
    EXPECT_EQ(row.label.find("kappa"), std::string_view::npos) << row.effect;
    EXPECT_GE(row.factor, 1.0) << row.effect << " " << row.parameter;
  }
}

TEST(ParameterMeaning, has_sentences_with_whole_choices) {
  for (const ParameterMeaning& row : parameter_meanings()) {
    const auto count = [&row](char c) { return std::count(row.said.begin(), row.said.end(), c); };
    EXPECT_EQ(count('['), count(']')) << row.said;
    EXPECT_EQ(count('['), count('|')) << row.said;
    EXPECT_EQ(row.said.empty() ? 0 : 1, count('{')) << row.said;
  }
}

}  // namespace
}  // namespace odomcalib::calib::terms::parameter_meaning_test
