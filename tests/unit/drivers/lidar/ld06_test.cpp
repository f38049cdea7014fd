#include "drivers/lidar/ld06/packet.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "drivers/decode/decode.hpp"
#include "drivers/lidar/lidar.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::ld06_test {
namespace {

using test::ByteString;
using test::expect_accounted;

constexpr double kPeriod = 12.0 / 4500.0;
constexpr double kTransmission = 47 * 10.0 / 230'400;

void put16(ByteString& out, unsigned value) {
  out.push_back(static_cast<std::uint8_t>(value));
  out.push_back(static_cast<std::uint8_t>(value >> 8));
}

/// A right packet; its checksum is calculated bit by bit here, not with the table under test.
ByteString packet(unsigned start_cdeg, unsigned span_cdeg, unsigned stamp_ms, unsigned speed = 3600,
                  unsigned mm = 1000) {
  ByteString out = {0x54, 0x2C};
  put16(out, speed);
  put16(out, start_cdeg % 36000);
  for (unsigned i = 0; i < 12; ++i) {
    put16(out, mm + i);
    out.push_back(static_cast<std::uint8_t>(200 + i));
  }
  put16(out, (start_cdeg + span_cdeg) % 36000);
  put16(out, stamp_ms % 30000);
  unsigned crc = 0;
  for (const auto byte : out) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = ((crc << 1) ^ ((crc & 0x80) != 0 ? 0x4D : 0)) & 0xFF;
  }
  out.push_back(static_cast<std::uint8_t>(crc));
  return out;
}

/// 10 Hz: 37.5 packets a turn, 9.6 degrees each. True end of packet k is kPeriod * (k + 1) on the device's
/// clock.
ByteString packet_number(unsigned k, double first_device_s = 0.0) {
  const double end = first_device_s + kPeriod * (k + 1);
  return packet(k * 960 % 36000, 880, static_cast<unsigned>(end * 1000.0) % 30000);
}

TEST(Ld06, reads_the_packet_of_the_data_sheet) {
  ODOMCALIB_CAPTURES(folder);
  const auto text =
      value_of(decode("ld06", test::read_text(folder / "ldrobot-ld06" / "ld06_packet.txt"), "", "test"));
  EXPECT_NE(text.find("\"speed_deg_s\":2152"), std::string::npos);
  EXPECT_NE(text.find("\"device_time\":6.714"), std::string::npos);
  EXPECT_NE(text.find("\"ranges\":[0.224,0.22,0.217,"), std::string::npos);
  EXPECT_NE(text.find("\"intensities\":[228,226,229,227,228,233,228,226,233,229,229,229]"),
            std::string::npos);
  EXPECT_NE(text.find("\"good\":47,\"skipped\":0,\"buffered\":0"), std::string::npos);
}

TEST(Ld06, rejects_a_packet_with_a_wrong_checksum) {
  const ByteString good = packet(0, 880, 5);
  for (std::size_t at = 0; at < good.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      ByteString bad = good;
      bad[at] = static_cast<std::uint8_t>(bad[at] ^ (1 << bit));
      ld06::PacketFinder finder(4500.0);
      EXPECT_TRUE(finder.on_bytes(bad).empty()) << "byte " << at << " bit " << bit;
      expect_accounted(finder.frames().counters());
      EXPECT_EQ(finder.frames().counters()["good"], 0U);
    }
}

TEST(Ld06, accepts_the_same_packet_unharmed) {
  ld06::PacketFinder finder(4500.0);
  EXPECT_EQ(finder.on_bytes(packet(0, 880, 5)).size(), 1U);
  EXPECT_EQ(finder.frames().counters()["good"], 47U);
}

TEST(Ld06, waits_for_the_rest_of_a_packet_cut_at_any_byte) {
  const ByteString good = packet(35900, 880, 5);
  for (std::size_t cut = 0; cut <= good.size(); ++cut) {
    ld06::PacketFinder finder(4500.0);
    const std::span<const std::uint8_t> all(good);
    auto found = finder.on_bytes(all.first(cut));
    EXPECT_EQ(found.size(), cut == good.size() ? 1U : 0U);
    expect_accounted(finder.frames().counters());
    const auto rest = finder.on_bytes(all.subspan(cut));
    EXPECT_EQ(found.size() + rest.size(), 1U);
    expect_accounted(finder.frames().counters());
  }
}

TEST(Ld06, finds_packets_between_noise) {
  auto random = test::seeded(4);
  for (int i = 0; i < 1500; ++i) {
    ld06::PacketFinder finder(4500.0);
    ByteString stream(random() % 60);
    for (auto& byte : stream) byte = random() % 4 == 0 ? 0x54 : test::random_byte(random);
    const ByteString good = packet(random() % 36000, 880, random() % 30000);
    stream.insert(stream.end(), good.begin(), good.end());
    // A false header in the noise may wait for 47 bytes: two more packets push it through.
    for (int k = 0; k < 2; ++k) stream.insert(stream.end(), good.begin(), good.end());
    EXPECT_EQ(finder.on_bytes(stream).size(), 3U);
    expect_accounted(finder.frames().counters());
  }
}

TEST(Ld06, rejects_a_span_that_does_not_fit_the_speed) {
  const auto counted = [](unsigned span, unsigned speed) {
    ld06::PacketFinder finder(4500.0);
    (void)finder.on_bytes(packet(100, span, 5, speed));
    expect_accounted(finder.frames().counters());
    return finder.frames().counters();
  };
  EXPECT_EQ(counted(880, 3600).at("packets"), 1U);
  EXPECT_EQ(counted(1750, 3600).at("packets"), 1U);
  EXPECT_EQ(counted(1770, 3600).at("bad_span"), 1U);
  EXPECT_EQ(counted(430, 3600).at("bad_span"), 1U);
  EXPECT_EQ(counted(0, 3600).at("bad_span"), 1U);
  EXPECT_EQ(counted(880, 0).at("motor_stopped"), 1U);
}

TEST(Ld06, rejects_angles_and_stamps_out_of_range) {
  for (const std::size_t offset : {4UL, 42UL, 44UL}) {
    ByteString bad = packet(100, 880, 5);
    bad[offset] = 0xFF;
    bad[offset + 1] = 0xFF;
    bad.back() = ld06::crc8(std::span<const std::uint8_t>(bad).first(46));
    ld06::PacketFinder finder(4500.0);
    EXPECT_TRUE(finder.on_bytes(bad).empty());
    EXPECT_EQ(finder.frames().counters()["bad_field"], 1U);
  }
}

std::unique_ptr<Lidar> make_ld06() { return std::move(make_lidar("ld06", {230400})).value(); }

std::vector<Scan> run(Lidar& lidar, unsigned packets, double lag_s = 0.001, double first_device_s = 0.0) {
  std::vector<Scan> scans;
  for (unsigned k = 0; k < packets; ++k) {
    lidar.on_bytes(packet_number(k, first_device_s), 100.0 + kPeriod * (k + 1) + kTransmission + lag_s);
    for (Scan& scan : test::whole_scans(lidar)) scans.push_back(std::move(scan));
    expect_accounted(lidar.counters());
  }
  return scans;
}

TEST(Ld06, drops_the_first_partial_turn_and_publishes_whole_ones) {
  const auto made = make_ld06();
  Lidar& lidar = *made;
  const auto scans = run(lidar, 400);
  ASSERT_EQ(scans.size(), 9U);
  EXPECT_EQ(lidar.counters()["partial_scans"], 1U);
  for (const Scan& scan : scans) {
    EXPECT_EQ(scan.ranges.size(), 450U);
    EXPECT_EQ(scan.angles.size(), scan.ranges.size());
    EXPECT_EQ(scan.times.size(), scan.ranges.size());
  }
}

TEST(Ld06, turns_clockwise_angles_into_negative_ones) {
  const auto made = make_ld06();
  Lidar& lidar = *made;
  const Scan scan = run(lidar, 200).at(0);
  EXPECT_LT(scan.angle_increment, 0.0);
  for (std::size_t i = 1; i < scan.angles.size(); ++i) EXPECT_LT(scan.angles[i], scan.angles[i - 1]);
  EXPECT_NEAR(scan.angle_increment, -0.8 * std::numbers::pi / 180.0, 1e-4);
}

TEST(Ld06, dates_beams_by_the_device_clock_within_a_millisecond) {
  const auto made = make_ld06();
  Lidar& lidar = *made;
  const auto scans = run(lidar, 8000, 0.0, 25.0);  // 21 s, the stamp wraps at 30 s
  ASSERT_GT(scans.size(), 200U);
  for (const Scan& scan : scans) {
    // Beam 0 is at a whole turn: device time is a multiple of 0.1 s, first sample ends 1/4500 s later.
    const double since_start = scan.t - 100.0 - 1.0 / 4500.0;
    EXPECT_NEAR(since_start, 0.1 * std::round(since_start * 10.0), 0.0012) << since_start;
    EXPECT_NEAR(scan.times.back(), 449.0 / 4500.0, 0.001);
  }
}

TEST(Ld06, follows_the_least_delayed_bytes) {
  auto random = test::seeded(5);
  const auto made = make_ld06();
  Lidar& lidar = *made;
  std::vector<Scan> scans;
  for (unsigned k = 0; k < 4000; ++k) {
    const double jitter = 0.016 * static_cast<double>(random() % 1000) / 1000.0;  // a USB latency timer
    lidar.on_bytes(packet_number(k), 100.0 + kPeriod * (k + 1) + kTransmission + jitter);
    for (Scan& scan : test::whole_scans(lidar)) scans.push_back(std::move(scan));
  }
  ASSERT_GT(scans.size(), 90U);
  for (std::size_t i = 10; i < scans.size(); ++i) {
    const double since_start = scans[i].t - 100.0 - 1.0 / 4500.0;
    EXPECT_NEAR(since_start, 0.1 * std::round(since_start * 10.0), 0.0025);
  }
}

// A busy host reads late, in pieces of what the port holds: that says nothing about when the beams were
// taken.
TEST(Ld06, late_reads_in_pieces_tear_no_turn_apart) {
  const auto made = make_ld06();
  Lidar& lidar = *made;
  ByteString waiting;
  std::size_t published = 0;
  for (unsigned k = 0; k < 400; ++k) {
    const ByteString bytes = packet_number(k);
    waiting.insert(waiting.end(), bytes.begin(), bytes.end());
    const bool busy = k < 60 || (k > 120 && k < 160);
    const double now = 100.0 + kPeriod * (k + 1) + kTransmission;
    for (std::size_t at = 0; !busy && at < waiting.size(); at += 1024) {
      const auto rest = std::span<const std::uint8_t>(waiting).subspan(at);
      lidar.on_bytes(rest.first(std::min<std::size_t>(1024, rest.size())), now);
    }
    if (!busy) waiting.clear();
    published += test::whole_scans(lidar).size();
  }
  EXPECT_EQ(published, 9U);
  EXPECT_EQ(lidar.counters()["partial_scans"], 1U);
  EXPECT_EQ(lidar.counters()["lost_packets"], 0U);
}

TEST(Ld06, counts_a_turn_with_a_hole_instead_of_publishing_it) {
  const auto made = make_ld06();
  Lidar& lidar = *made;
  unsigned published = 0;
  for (unsigned k = 0; k < 375; ++k) {
    if (k >= 100 && k < 106) continue;  // 16 ms lost
    lidar.on_bytes(packet_number(k), 100.0 + kPeriod * (k + 1));
    for (const Scan& scan : test::whole_scans(lidar)) {
      EXPECT_EQ(scan.ranges.size(), 450U);
      ++published;
    }
  }
  EXPECT_EQ(published, 7U);
  EXPECT_EQ(lidar.counters()["short_scans"], 1U);
}

TEST(Ld06, what_the_sensor_did_not_see_is_no_reading) {
  const auto made = make_ld06();
  Lidar& lidar = *made;
  std::vector<Scan> scans;
  for (unsigned k = 0; k < 200; ++k) {
    const unsigned end_ms = static_cast<unsigned>(kPeriod * (k + 1) * 1000.0);
    lidar.on_bytes(packet(k * 960 % 36000, 880, end_ms, 3600, k % 2 == 0 ? 0 : 13000),
                   100.0 + kPeriod * (k + 1));
    for (Scan& scan : test::whole_scans(lidar)) scans.push_back(std::move(scan));
  }
  ASSERT_FALSE(scans.empty());
  for (const float range : scans[0].ranges) EXPECT_EQ(range, 0.0F);
}

TEST(Ld06, starts_anew_after_a_reset) {
  const auto made = make_ld06();
  Lidar& lidar = *made;
  (void)run(lidar, 60);
  lidar.reset();
  expect_accounted(lidar.counters());
  EXPECT_EQ(run(lidar, 30).size(), 0U);
}

TEST(Lidar, unknown_types_are_refused_with_the_known_ones) {
  const auto made = make_lidar("ld99", {230400});
  ASSERT_FALSE(made.ok());
  EXPECT_NE(made.error().text().find("ld06"), std::string::npos);
  EXPECT_TRUE(make_lidar("ld19", {230400}).ok());
}

}  // namespace
}  // namespace odomcalib::drivers::ld06_test
