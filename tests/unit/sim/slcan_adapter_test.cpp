#include "tests/sim/wires/slcan_adapter.hpp"

#include <gtest/gtest.h>

namespace odomcalib::sim::slcan_adapter_test {
namespace {

SlcanAdapter opened() {
  SlcanAdapter adapter;
  adapter.from_host("S6\rO\r");
  adapter.take_output();
  return adapter;
}

TEST(SlcanAdapter, opens_with_a_bitrate_and_answers_each_command) {
  SlcanAdapter adapter;
  adapter.from_host("\r\r\rC\r");
  EXPECT_EQ(adapter.take_output(), "\r\r\r\a");
  adapter.from_host("V\rN\rS6\rO\r");
  EXPECT_EQ(adapter.take_output(), "V0101\rN0815\r\r\r");
  EXPECT_TRUE(adapter.hears_bus());
  adapter.from_host("S6\r");
  EXPECT_EQ(adapter.take_output(), "\a") << "only while closed";
  adapter.from_host("C\r");
  EXPECT_EQ(adapter.take_output(), "\r");
}

TEST(SlcanAdapter, refuses_to_open_without_a_bitrate_and_to_send_while_closed) {
  SlcanAdapter adapter;
  adapter.from_host("O\rt1230\r");
  EXPECT_EQ(adapter.take_output(), "\a\a");
}

TEST(SlcanAdapter, passes_frames_both_ways_in_either_case_of_hex) {
  SlcanAdapter adapter = opened();
  adapter.from_host("t6018401860000000000");  // length 8, only 15 digits follow
  adapter.from_host("\r");
  EXPECT_EQ(adapter.take_output(), "\a");
  adapter.from_host("t60184018100000aBcDeF\rT1ABCDEF020102\r");
  const auto frames = adapter.take_frames();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0], make_frame(0x601, {0x40, 0x18, 0x10, 0, 0, 0xAB, 0xCD, 0xEF}));
  EXPECT_TRUE(frames[1].extended);
  EXPECT_EQ(frames[1].id, 0x1ABCDEF0U);
  EXPECT_EQ(adapter.take_output(), "\r\r");
  adapter.from_bus(make_frame(0x181, {1, 0xA2}), 0.0);
  EXPECT_EQ(adapter.take_output(), "t181201A2\r");
}

TEST(SlcanAdapter, lines_may_come_in_pieces) {
  SlcanAdapter adapter = opened();
  for (const char byte : std::string("t123211")) adapter.from_host({&byte, 1});
  EXPECT_TRUE(adapter.take_frames().empty());
  adapter.from_host("22\r");
  ASSERT_EQ(adapter.take_frames().size(), 1U);
}

TEST(SlcanAdapter, remote_frames_carry_a_length_and_no_data) {
  SlcanAdapter adapter = opened();
  adapter.from_host("r7014\r");
  const auto frames = adapter.take_frames();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].remote);
  EXPECT_EQ(frames[0].length, 4);
  EXPECT_EQ(slcan_line(frames[0]), "r7014");
}

TEST(SlcanAdapter, the_wrong_bitrate_hears_nothing) {
  SlcanAdapter adapter;
  adapter.from_host("S5\rO\rt1230\r");
  adapter.take_output();
  adapter.from_bus(make_frame(0x181, {1}), 0.0);
  EXPECT_EQ(adapter.take_output(), "");
  EXPECT_TRUE(adapter.take_frames().empty());
}

TEST(SlcanAdapter, stamps_count_milliseconds_of_the_minute) {
  SlcanAdapter adapter;
  adapter.from_host("S6\rZ1\rO\r");
  adapter.take_output();
  adapter.from_bus(make_frame(0x181, {1}), 59.9996);
  adapter.from_bus(make_frame(0x181, {1}), 60.001);
  EXPECT_EQ(adapter.take_output(), "t181101EA5F\rt1811010001\r");
}

}  // namespace
}  // namespace odomcalib::sim::slcan_adapter_test
