#include "proto/base_quantities.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace odomcalib::base_quantities_test {
namespace {

// row_of() looks a row up by its place.
TEST(BaseQuantities, stand_in_the_order_of_their_identifiers) {
  for (std::size_t k = 0; k < kBaseQuantities.size(); ++k)
    EXPECT_EQ(static_cast<std::size_t>(kBaseQuantities.at(k).id), k) << kBaseQuantities.at(k).name;
}

TEST(BaseQuantities, have_names_of_their_own_that_lead_back) {
  std::set<std::string> names, symbols, meanings;
  for (const BaseQuantityRow& row : kBaseQuantities) {
    EXPECT_EQ(base_quantity_from(row.name), row.id);
    EXPECT_TRUE(is_name_of(row.name, row.id));
    names.insert(row.name);
    symbols.insert(row.symbol);
    meanings.insert(row.meaning);
  }
  EXPECT_EQ(names.size(), kBaseQuantities.size());
  EXPECT_EQ(symbols.size(), kBaseQuantities.size());
  EXPECT_EQ(meanings.size(), kBaseQuantities.size());
  for (const char* other : {"", "track", "track_widths", "offset"})
    EXPECT_EQ(base_quantity_from(other), std::nullopt) << other;
}

TEST(BaseQuantities, are_those_that_the_file_format_promises) {
  const auto is = [](BaseQuantity quantity, const std::string& name, const std::string& unit) {
    return row_of(quantity).name == name && row_of(quantity).unit == unit;
  };
  EXPECT_TRUE(is(BaseQuantity::left_wheel_diameter, "left_wheel_diameter", "m"));
  EXPECT_TRUE(is(BaseQuantity::right_wheel_diameter, "right_wheel_diameter", "m"));
  EXPECT_TRUE(is(BaseQuantity::track_width, "track_width", "m"));
  EXPECT_TRUE(is(BaseQuantity::lidar_x, "lidar_x", "m"));
  EXPECT_TRUE(is(BaseQuantity::lidar_y, "lidar_y", "m"));
  EXPECT_TRUE(is(BaseQuantity::lidar_yaw, "lidar_yaw", "rad"));
}

TEST(BaseQuantities, are_lengths_of_the_drive_or_of_the_lidar) {
  for (const BaseQuantityRow& row : kBaseQuantities) {
    const bool of_lidar = std::string(row.name).starts_with("lidar_");
    EXPECT_EQ(is_drive_length(row.name), !of_lidar) << row.name;
    EXPECT_EQ(member_of(row.id) == nullptr, of_lidar) << row.name;
  }
  EXPECT_FALSE(is_drive_length("offset"));
}

TEST(BaseQuantities, have_the_nominal_value_that_the_robot_states) {
  RobotDescription robot{0.15, 0.16, 0.4, 2000.0, {}, "", ""};
  EXPECT_EQ(nominal_value(robot, BaseQuantity::left_wheel_diameter), 0.15);
  EXPECT_EQ(nominal_value(robot, BaseQuantity::right_wheel_diameter), 0.16);
  EXPECT_EQ(nominal_value(robot, BaseQuantity::track_width), 0.4);
  EXPECT_EQ(nominal_value(robot, BaseQuantity::lidar_yaw), std::nullopt) << "nobody stated where it sits";
  robot.lidar_pose = {0.1, 0.0, -3.0};
  robot.track_width = 0.0;
  EXPECT_EQ(nominal_value(robot, BaseQuantity::track_width), std::nullopt) << "zero is no length";
  EXPECT_EQ(nominal_value(robot, BaseQuantity::lidar_x), 0.1);
  EXPECT_EQ(nominal_value(robot, BaseQuantity::lidar_y), 0.0);
  EXPECT_EQ(nominal_value(robot, BaseQuantity::lidar_yaw), -3.0);
}

}  // namespace
}  // namespace odomcalib::base_quantities_test
