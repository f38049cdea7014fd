#include "tests/sim/wires/ld06_stream.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/sim/world/rooms.hpp"

namespace odomcalib::sim::ld06_stream_test {
namespace {

/// The packet printed in the manufacturer's data sheet.
const std::vector<std::uint8_t> kDataSheet{
    0x54, 0x2C, 0x68, 0x08, 0xAB, 0x7E, 0xE0, 0x00, 0xE4, 0xDC, 0x00, 0xE2, 0xD9, 0x00, 0xE5, 0xD5,
    0x00, 0xE3, 0xD3, 0x00, 0xE4, 0xD0, 0x00, 0xE9, 0xCD, 0x00, 0xE4, 0xCA, 0x00, 0xE2, 0xC7, 0x00,
    0xE9, 0xC5, 0x00, 0xE5, 0xC2, 0x00, 0xE5, 0xC0, 0x00, 0xE5, 0xBE, 0x82, 0x3A, 0x1A, 0x50};

TEST(Ld06Stream, encodes_the_packet_of_the_data_sheet_byte_for_byte) {
  Ld06Packet packet;
  packet.speed = 2152;
  packet.start_angle = 324.27;
  packet.end_angle = 334.70;
  packet.time = 6.7145;
  const std::array<int, 12> millimetres{224, 220, 217, 213, 211, 208, 205, 202, 199, 197, 194, 192};
  const std::array<int, 12> intensity{228, 226, 229, 227, 228, 233, 228, 226, 233, 229, 229, 229};
  for (std::size_t i = 0; i < 12; ++i)
    packet.points.push_back({0, 0, 0.0, 0.0, 0.001 * millimetres[i], static_cast<double>(intensity[i])});
  EXPECT_EQ(encode_ld06(packet), kDataSheet);
  EXPECT_EQ(ld06_checksum(std::span(kDataSheet).first(46)), 0x50);
}

class Stream : public testing::Test {
 protected:
  Stream() : room(box_room(4, 4, 2, 2)), head(room, {}, options, 1), stream(options, 12.0, 0.0) {}

  std::vector<std::uint8_t> run(double until) {
    std::vector<Beam> beams;
    head.advance(now, {}, until, {}, beams);
    now = until;
    for (const Beam& beam : beams) stream.add(beam);
    return stream.take(until);
  }

  LidarOptions options;
  Room room;
  LidarHead head;
  Ld06Stream stream;
  double now = 0.0;
};

TEST_F(Stream, sends_a_packet_each_twelve_beams_with_continuous_angles) {
  const auto bytes = run(2.0);
  ASSERT_GT(bytes.size() / 47, 740U);
  ASSERT_EQ(bytes.size() % 47, 0U);
  int expected = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 47) {
    const auto packet = std::span(bytes).subspan(at, 47);
    EXPECT_EQ(ld06_checksum(packet.first(46)), packet[46]);
    const int start = packet[4] | packet[5] << 8, end = packet[42] | packet[43] << 8;
    EXPECT_EQ(start, expected);
    EXPECT_EQ((end - start + 36'000) % 36'000, 880);
    expected = (start + 960) % 36'000;
  }
}

TEST_F(Stream, stamps_are_milliseconds_of_the_last_beam_modulo_30000) {
  const auto bytes = run(20.0);
  int before = -1, wraps = 0;
  for (std::size_t at = 0; at + 47 <= bytes.size(); at += 47) {
    const int stamp = bytes[at + 44] | bytes[at + 45] << 8;
    EXPECT_LT(stamp, 30'000);
    if (before >= 0 && stamp < before) ++wraps;
    before = stamp;
  }
  EXPECT_EQ(wraps, 1);  // from 12 s to 32 s of the device clock
}

TEST_F(Stream, a_packet_arrives_after_its_transmission_time) {
  const double last_beam = options.first_turn_starts + 11.0 / (450 * 9.97);
  EXPECT_TRUE(run(last_beam + 47.0 / 23'040.0).empty());
  EXPECT_EQ(run(last_beam + 47.0 / 23'040.0 + 0.0004).size(), 47U);
}

TEST_F(Stream, faults_cut_halve_blind_and_thin_out) {
  stream.faults.cut = true;
  EXPECT_TRUE(run(0.5).empty());
  stream.faults = {};
  stream.faults.half_packets = true;
  EXPECT_EQ(run(1.0).size() % 23, 0U);
  stream.faults = {};
  run(1.1);
  stream.faults.share_lost = 0.3;
  const double packets = static_cast<double>(run(2.1).size()) / 47.0;
  EXPECT_NEAR(packets / 373.9, 0.7, 0.02);
  stream.faults = {};
  run(2.2);
  stream.faults.blind = true;
  run(2.3);
  const auto bytes = run(2.4);
  EXPECT_EQ(bytes[6] | bytes[7], 0);
}

TEST_F(Stream, after_a_power_cycle_speed_and_angles_are_invalid_for_a_fifth_of_a_second) {
  run(1.0);
  stream.restart(1.0);
  const auto early = run(1.1);
  EXPECT_EQ(early[2] | early[3], 0);
  run(1.25);
  const auto late = run(1.3);
  EXPECT_NE(late[2] | late[3], 0);
}

}  // namespace
}  // namespace odomcalib::sim::ld06_stream_test
