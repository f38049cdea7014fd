// The row of an effect states the words that a report has for each of its parameters.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/terms/catalogue.hpp"
#include "proto/angles.hpp"

namespace odomcalib::calib::terms::parameter_meaning_test {
namespace {

/// A parameter of a catalogue and what its row says of it.
struct Row {
  std::string effect, parameter, unit;
  ParameterMeaning meaning;
};

std::vector<Row> rows_of_catalogues() {
  std::vector<Row> rows;
  const auto add = [&rows](const auto& catalogue) {
    for (const auto& effect : catalogue)
      for (const auto& parameter : effect->parameters())
        rows.push_back({effect->name(), parameter.name, parameter.unit, parameter.meaning});
  };
  add(effect_catalogue());
  add(lidar_catalogue(false));
  return rows;
}

TEST(ParameterMeaning, is_stated_by_each_parameter_of_the_catalogues) {
  EXPECT_GE(rows_of_catalogues().size(), 50U);
  for (const Row& row : rows_of_catalogues()) {
    EXPECT_FALSE(row.meaning.is.empty()) << row.effect << " " << row.parameter;
    EXPECT_GE(row.meaning.factor, 1.0) << row.effect << " " << row.parameter;
  }
}

TEST(ParameterMeaning, shows_angles_in_degrees) {
  for (const Row& row : rows_of_catalogues()) {
    EXPECT_EQ(row.unit == "rad", row.meaning.unit == "deg") << row.effect << " " << row.parameter;
    if (row.unit == "rad") {
      EXPECT_EQ(row.meaning.factor, odomcalib::kDegrees) << row.effect << " " << row.parameter;
    }
  }
}

TEST(ParameterMeaning, is_found_by_the_names_of_effect_and_parameter) {
  for (const Row& row : rows_of_catalogues()) {
    const ParameterMeaning* found = meaning_of(row.effect, row.parameter);
    ASSERT_NE(found, nullptr) << row.effect << " " << row.parameter;
    EXPECT_EQ(found->is, row.meaning.is) << row.effect << " " << row.parameter;
  }
  EXPECT_EQ(meaning_of("backlash", "offset"), nullptr) << "a parameter of another effect";
  EXPECT_EQ(meaning_of("no_effect", "offset"), nullptr);
}

TEST(ParameterMeaning, has_labels_that_tell_the_parameters_of_an_effect_apart) {
  std::set<std::pair<std::string, std::string_view>> labels;
  for (const Row& row : rows_of_catalogues()) {
    const std::string_view label = row.meaning.label;
    EXPECT_TRUE(labels.emplace(row.effect, label).second) << row.effect << " " << label << " twice";
    EXPECT_EQ(label.find("kappa"), std::string_view::npos) << row.effect;
  }
}

TEST(ParameterMeaning, has_sentences_with_whole_choices) {
  for (const Row& row : rows_of_catalogues()) {
    const std::string_view said = row.meaning.said;
    const auto count = [said](char c) { return std::count(said.begin(), said.end(), c); };
    EXPECT_EQ(count('['), count(']')) << said;
    EXPECT_EQ(count('['), count('|')) << said;
    EXPECT_EQ(said.empty() ? 0 : 1, count('{')) << said;
  }
}

}  // namespace
}  // namespace odomcalib::calib::terms::parameter_meaning_test
