// A value that a second program writes in between is told from one at which the robot stands.
#include "proto/recording/second_writer.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odomcalib::second_writer_test {
namespace {

std::vector<Values> drive() {
  std::vector<Values> samples;
  for (int k = 0; k < 600; ++k) {
    const double way = k < 100 ? 0.0 : 0.05 * (k - 100);
    samples.push_back({way, 0.9 * way + std::sin(0.01 * k), 0.0});
  }
  return samples;
}

std::vector<Values> with_value(const Values& value, std::size_t every, std::size_t times = 1) {
  std::vector<Values> out;
  std::size_t k = 0;
  for (const Values& sample : drive()) {
    out.push_back(sample);
    if (k++ % every == 0) out.insert(out.end(), times, value);
  }
  return out;
}

std::size_t left(const std::vector<Values>& samples) {
  return samples.size() - of_second_writer(samples).size();
}

TEST(SecondWriter, is_found_at_any_rate) {
  EXPECT_NEAR(static_cast<double>(left(with_value({0.0, 0.0, 0.0}, 10))), 600.0, 2.0);
  EXPECT_NEAR(static_cast<double>(left(with_value({0.0, 0.0, 0.0}, 1))), 600.0, 2.0);
  EXPECT_NEAR(static_cast<double>(left(with_value({0.0, 0.0, 0.0}, 1, 2))), 600.0, 2.0) << "twice as often";
  EXPECT_EQ(left(with_value({-7.0, 3.0, 0.0}, 5)), 600U) << "a value that is not zero";
}

TEST(SecondWriter, is_none_where_the_robot_stands_or_stops_now_and_then) {
  EXPECT_TRUE(of_second_writer(drive()).empty());
  EXPECT_TRUE(of_second_writer({}).empty());
  std::vector<Values> speeds;  // of a robot that stops every two seconds
  for (int k = 0; k < 1000; ++k) speeds.push_back(k % 100 < 20 ? Values{} : Values{3.0, 3.0, 0.0});
  EXPECT_TRUE(of_second_writer(speeds).empty());
  std::vector<Values> rocking;  // a count that comes and goes
  for (int k = 0; k < 400; ++k) rocking.push_back({k % 7 == 0 ? 1.0 : 0.0, 0.0, 0.0});
  EXPECT_TRUE(of_second_writer(rocking).empty());
}

TEST(SecondWriter, is_none_where_single_values_were_read_wrong) {
  std::vector<Values> samples = drive();
  samples[200] = samples[350] = samples[420] = {-50.0, 3.0, 0.0};
  EXPECT_TRUE(of_second_writer(samples).empty());
}

}  // namespace
}  // namespace odomcalib::second_writer_test
