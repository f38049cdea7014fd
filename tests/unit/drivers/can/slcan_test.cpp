#include <gtest/gtest.h>

#include "drivers/can/slcan_parser.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::slcan_test {
namespace {

using test::bytes_of;
using test::expect_accounted;
using Kind = SlcanItem::Kind;

CanFrame random_frame(test::Random& random) {
  CanFrame frame;
  frame.extended = (random() & 1) != 0;
  frame.remote = random() % 8 == 0;
  frame.id = random() & (frame.extended ? 0x1FFFFFFFU : 0x7FFU);
  frame.length = static_cast<std::uint8_t>(random() % 9);
  for (std::size_t i = 0; i < frame.length && !frame.remote; ++i) frame.data[i] = test::random_byte(random);
  return frame;
}

std::size_t frames_in(const std::vector<SlcanItem>& items) {
  std::size_t n = 0;
  for (const SlcanItem& item : items) n += item.kind == Kind::frame ? 1 : 0;
  return n;
}

TEST(Slcan, reads_back_every_frame_that_it_writes) {
  auto random = test::seeded(1);
  for (int i = 0; i < 1000; ++i) {
    const CanFrame frame = random_frame(random);
    SlcanParser parser;
    const auto items = parser.on_bytes(bytes_of(slcan_line(frame)));
    ASSERT_EQ(items.size(), 1U);
    ASSERT_EQ(items[0].kind, Kind::frame);
    test::expect_same(items[0].frame, frame);
    expect_accounted(parser.counters());
    EXPECT_EQ(parser.counters()["skipped"], 0U);
  }
}

TEST(Slcan, does_not_depend_on_how_the_bytes_are_cut) {
  auto random = test::seeded(2);
  std::string stream;
  for (int i = 0; i < 50; ++i) stream += slcan_line(random_frame(random));
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    SlcanParser parser;
    std::size_t n = frames_in(parser.on_bytes(bytes_of(stream.substr(0, cut))));
    expect_accounted(parser.counters());
    n += frames_in(parser.on_bytes(bytes_of(stream.substr(cut))));
    EXPECT_EQ(n, 50U);
    expect_accounted(parser.counters());
  }
}

TEST(Slcan, a_line_cut_off_at_any_place_is_not_a_frame) {
  const std::string line = "t1238DEADBEEF01020304\r";
  for (std::size_t length = 1; length + 1 < line.size(); ++length) {
    SlcanParser parser;
    EXPECT_EQ(frames_in(parser.on_bytes(bytes_of(line.substr(0, length) + "\r"))), 0U) << length;
    EXPECT_EQ(parser.counters()["bad_line"], 1U);
    expect_accounted(parser.counters());
  }
}

TEST(Slcan, rejects_lines_that_break_one_rule) {
  for (const std::string line : {"t8000", "t12390102030405060708", "t12G0", "t123", "T200000000", "T1234567",
                                 "t1232AAB", "t1231AABBCCDDEE", "t1231-1", "t1231 1", "t1231+1",
                                 "r1232AABBCC", "t1231AAEA60", "x", "q12", "t0x10", "T1FFFFFFF"}) {
    SlcanParser parser;
    EXPECT_EQ(frames_in(parser.on_bytes(bytes_of(line + "\r"))), 0U) << line;
    EXPECT_EQ(parser.counters()["bad_line"], 1U) << line;
    expect_accounted(parser.counters());
  }
}

TEST(Slcan, takes_the_time_stamp_when_there_is_one) {
  SlcanParser parser;
  const auto items = parser.on_bytes(bytes_of("t1231AAEA5F\r"));
  ASSERT_EQ(items.size(), 1U);
  EXPECT_EQ(items[0].stamp_ms, 59999);
}

TEST(Slcan, tells_done_refused_and_text_apart) {
  SlcanParser parser;
  const auto items = parser.on_bytes(bytes_of("\rz\r\aV1013\rN4242\rF00\rsb255000\r"));
  ASSERT_EQ(items.size(), 7U);
  EXPECT_EQ(items[0].kind, Kind::done);
  EXPECT_EQ(items[1].kind, Kind::done);
  EXPECT_EQ(items[2].kind, Kind::refused);
  EXPECT_EQ(items[3].text, "V1013");
  EXPECT_EQ(items[6].kind, Kind::bus_state);
  EXPECT_EQ(parser.counters()["refused_by_adapter"], 1U);
}

TEST(Slcan, skips_an_overlong_line_and_goes_on_after_its_end) {
  for (std::size_t length = 140; length < 400; ++length) {
    SlcanParser parser;
    const auto items = parser.on_bytes(bytes_of(std::string(length, 't') + "\rt1230\r"));
    EXPECT_EQ(frames_in(items), 1U) << length;
    EXPECT_EQ(parser.counters()["line_too_long"] + parser.counters()["bad_line"], 1U) << length;
    expect_accounted(parser.counters());
  }
}

TEST(Slcan, survives_noise_and_finds_the_next_frame) {
  auto random = test::seeded(3);
  for (int i = 0; i < 2000; ++i) {
    SlcanParser parser;
    test::ByteString noise(random() % 400);
    for (auto& byte : noise) byte = test::random_byte(random);
    (void)parser.on_bytes(noise);
    expect_accounted(parser.counters());
    const auto items = parser.on_bytes(bytes_of("\rt7DF2ABCD\r"));
    ASSERT_FALSE(items.empty());
    ASSERT_EQ(items.back().kind, Kind::frame);
    EXPECT_EQ(items.back().frame.id, 0x7DFU);
    expect_accounted(parser.counters());
  }
}

TEST(Slcan, one_changed_character_never_breaks_the_accounting) {
  const std::string line = "t1238DEADBEEF01020304\r";
  for (std::size_t at = 0; at < line.size(); ++at)
    for (int value = 0; value < 256; ++value) {
      std::string changed = line;
      changed[at] = static_cast<char>(value);
      SlcanParser parser;
      (void)parser.on_bytes(bytes_of(changed + "\rt1230\r"));
      expect_accounted(parser.counters());
      EXPECT_EQ(parser.counters()["buffered"], 0U);
    }
}

TEST(Slcan, lines_may_end_with_cr_lf) {
  SlcanParser parser;
  const auto items = parser.on_bytes(bytes_of("\r\nt1232AABB\r\nt1240\r\n\a\nV1013\r\n"));
  ASSERT_EQ(items.size(), 5U);
  EXPECT_EQ(frames_in(items), 2U);
  EXPECT_EQ(parser.counters()["bad_line"], 0U);
  EXPECT_EQ(parser.counters()["good"], parser.counters()["bytes_in"]);
  // Inside a line it is damage.
  EXPECT_EQ(frames_in(parser.on_bytes(bytes_of("t1\n232AABB\r"))), 0U);
  EXPECT_EQ(parser.counters()["bad_line"], 1U);
  expect_accounted(parser.counters());
}

TEST(Slcan, never_sends_an_error_frame) {
  CanFrame frame;
  frame.error = true;
  EXPECT_EQ(slcan_line(frame), "");
}

}  // namespace
}  // namespace odomcalib::drivers::slcan_test
