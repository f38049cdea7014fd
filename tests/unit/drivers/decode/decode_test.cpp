#include "drivers/decode/decode.hpp"

#include <gtest/gtest.h>
#include <linux/can.h>

#include <cmath>

#include "drivers/can/candump.hpp"
#include "drivers/can/socketcan.hpp"
#include "tests/unit/drivers/decoded.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::decode_test {
namespace {

using test::expect_accounted_summary;
using test::kProfiles;
using test::lines_of;

int count(const std::vector<nlohmann::json>& lines, const std::string& name) {
  int n = 0;
  for (const auto& line : lines) n += line.value("name", "") == name ? 1 : 0;
  return n;
}

TEST(Candump, reads_what_candump_writes) {
  const auto frame = parse_candump_line("(1436509052.249713) can0 044#2A366C2BBA");
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->id, 0x044U);
  EXPECT_EQ(frame->length, 5);
  EXPECT_NEAR(frame->t, 1436509052.249713, 1e-6);
  EXPECT_TRUE(parse_candump_line("(1.0) can0 12345678#AA R")->extended);
  EXPECT_EQ(parse_candump_line("(1.0) can0 123#R5")->length, 5);
  EXPECT_TRUE(parse_candump_line("(1.0) can0 20000004#0004000000000000")->error);
  EXPECT_EQ(parse_candump_line("(1.0) can0 080#")->length, 0);
  EXPECT_EQ(parse_candump_line("(1.0) can0 123#AA.BB")->length, 2);
}

TEST(Candump, refuses_cut_and_damaged_lines) {
  const std::string line = "(1.250000) can0 044#2A366C2BBA";
  for (std::size_t length = 0; length < line.size(); ++length) {
    const auto frame = parse_candump_line(line.substr(0, length));
    EXPECT_TRUE(!frame || frame->length < 5);
    EXPECT_FALSE(frame && length <= line.find('#'));
  }
  for (const char* bad :
       {"(x) can0 044#", "(1.0)can0 044#", "(1.0) can0 44#", "(1.0) can0 FFF#", "(1.0) can0 044#A",
        "(1.0) can0 044#0102030405060708FF", "(nan) can0 044#", "(1.0) can0 123##1AABB", "(1.0) can0 123#R9"})
    EXPECT_FALSE(parse_candump_line(bad)) << bad;
}

TEST(Candump, times_that_no_clock_says_are_refused_and_any_time_can_be_written) {
  EXPECT_FALSE(parse_candump_line("(" + std::string(60, '3') + ") can0 001#12"));
  EXPECT_FALSE(parse_candump_line("(-1" + std::string(20, '0') + ") can0 001#12"));
  CanFrame frame;
  for (const double t : {1e300, -1e300, 1e11}) {
    frame.t = t;
    EXPECT_GT(candump_line(frame, "can0").size(), 20U);
  }
  frame.t = 1436509052.249713;
  EXPECT_EQ(candump_line(frame, "can0"), "(1436509052.249713) can0 000#");
}

TEST(Candump, no_damaged_line_gives_a_frame_that_cannot_be_written_again) {
  auto random = test::seeded(12);
  const std::vector<std::string> good = {"(1436509052.249713) vcan0 044#2A366C2BBA",
                                         "(1.0) can0 12345678#AA",
                                         "(2.5) can1 123#R5",
                                         "(3.0) can0 20000004#0004000000000000",
                                         "(4.0) can0 080#",
                                         "(5.0) can0 7FF#11.22.33.44.55.66.77.88 R"};
  int accepted = 0;
  for (int i = 0; i < 6000; ++i) {
    std::string line = good[random() % good.size()];
    for (unsigned n = 1 + random() % 3; n > 0; --n) {
      const std::size_t at = random() % line.size();
      if (random() % 4 == 0)
        line.insert(at, 1, static_cast<char>(random() & 0x7F));
      else if (random() % 4 == 0)
        line.erase(at, 1);
      else
        line[at] =
            random() % 2 == 0 ? static_cast<char>(random() & 0xFF) : "0123456789AF#.R()"[random() % 17];
      if (line.empty()) break;
    }
    SCOPED_TRACE(line);
    const auto frame = parse_candump_line(line);
    if (!frame) continue;
    ++accepted;
    ASSERT_TRUE(std::isfinite(frame->t));
    ASSERT_LE(frame->length, 8);
    ASSERT_LE(frame->id, frame->extended || frame->error ? 0x1FFFFFFFU : 0x7FFU);
    const auto again = parse_candump_line(candump_line(*frame, "can0"));
    ASSERT_TRUE(again);
    test::expect_same(*again, *frame);
  }
  EXPECT_GT(accepted, 500);
}

TEST(Decode, the_commissioning_of_a_real_drive_is_read_completely) {
  ODOMCALIB_CAPTURES(folder);
  const auto lines = lines_of(
      decode("canopen:zlac8015d", test::read_text(folder / "zlac8015d/commissioning.log"), kProfiles, "log"));
  ASSERT_EQ(lines.size(), 216U);  // 215 frames and the summary
  EXPECT_EQ(count(lines, "sdo_request"), 82);
  EXPECT_EQ(count(lines, "sdo_answer"), 82);
  EXPECT_EQ(count(lines, "sdo_abort"), 0);
  EXPECT_EQ(lines[1]["value"], 0x14601460);
  expect_accounted_summary(lines.back());
  EXPECT_EQ(lines.back()["skipped"], 0);
  for (const auto& line : lines)
    EXPECT_NE(line["type"], "ticks") << "this log maps status and speed, no positions";
}

TEST(Decode, aborts_of_real_drives_are_put_into_words) {
  ODOMCALIB_CAPTURES(folder);
  const auto refused = lines_of(decode(
      "canopen:sim-dual", test::read_text(folder / "orientalmotor-blvd/aborts.log"), kProfiles, "log"));
  ASSERT_EQ(count(refused, "sdo_abort"), 2);
  EXPECT_EQ(refused[1]["object"], "60FE:01");
  EXPECT_EQ(refused[1]["code"], "06010002");
  const auto missing =
      lines_of(decode("canopen:sim-dual", test::read_text(folder / "ihsv60/startup.log"), kProfiles, "log"));
  ASSERT_EQ(count(missing, "sdo_abort"), 2);
  EXPECT_EQ(missing[10]["text"], "object does not exist (06020000h)");
  const auto two = lines_of(decode(
      "canopen:sim-dual", test::read_text(folder / "technosoft-ipos/enable_two_axes.log"), kProfiles, "log"));
  EXPECT_EQ(two.size(), 35U);
  EXPECT_EQ(count(two, "heartbeat"), 2);
  EXPECT_EQ(two[1]["state"], "boot-up");
}

TEST(Decode, positions_become_ticks_with_the_sign_of_the_mounting) {
  const std::string log = "(1.000000) can0 181#0A00000014000000\n(1.020000) can0 181#0B00000016000000\n(1.04";
  const auto lines = lines_of(decode("canopen:zlac8015d", log, kProfiles, "log"));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[1]["type"], "ticks");
  EXPECT_EQ(lines[1]["left"], 11);
  EXPECT_EQ(lines[1]["right"], -22);
  expect_accounted_summary(lines[2]);
  EXPECT_EQ(lines[2]["buffered"], 5);
}

TEST(Decode, emergencies_and_short_frames_are_told) {
  const std::string log =
      "(1.0) can0 081#1186200000000000\n(1.1) can0 081#1186\n(1.2) can0 181#00\n(1.3) can0 701#05\nrubbish\n";
  const auto lines = lines_of(decode("canopen:sim-dual", log, kProfiles, "log"));
  EXPECT_EQ(lines[0]["text"], "following error (8611h)");
  expect_accounted_summary(lines.back());
  EXPECT_EQ(lines.back()["rejected"]["bad_line"], 1);
  EXPECT_EQ(lines.back()["rejected"]["short_pdo"], 1);
  EXPECT_EQ(lines.back()["rejected"]["short_frame"], 1);
}

TEST(Decode, no_damaged_log_breaks_accounting_or_json) {
  auto random = test::seeded(10);
  for (int i = 0; i < 1500; ++i) {
    std::string log;
    for (int k = 0; k < 5; ++k) {
      std::ostringstream line;
      line << "(1." << k << ") can0 " << std::hex << std::uppercase << (0x100 + random() % 0x700) << "#";
      for (unsigned n = random() % 9; n > 0; --n) line << (16 + random() % 240);
      log += line.str() + "\n";
    }
    for (int k = 0; k < 3; ++k) log[random() % log.size()] = static_cast<char>(random() & 0x7F);
    const auto lines = lines_of(decode("canopen:sim-dual", log, kProfiles, "log"));
    ASSERT_FALSE(lines.empty());
    expect_accounted_summary(lines.back());
  }
}

TEST(Decode, unknown_drivers_and_profiles_are_refused) {
  EXPECT_EQ(decode("colander", "", kProfiles, "f").error().code, ErrorCode::usage);
  EXPECT_EQ(decode("canopen:", "", kProfiles, "f").error().code, ErrorCode::usage);
  EXPECT_EQ(decode("canopen:nothing", "", kProfiles, "f").error().code, ErrorCode::io);
}

TEST(SocketCanFrame, survives_the_way_to_the_kernel_and_back) {
  auto random = test::seeded(11);
  for (int i = 0; i < 2000; ++i) {
    CanFrame frame;
    frame.extended = random() % 2 == 0;
    frame.id = random() & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.remote = random() % 4 == 0;
    frame.length = static_cast<std::uint8_t>(random() % 9);
    for (std::size_t k = 0; k < frame.length && !frame.remote; ++k) frame.data[k] = test::random_byte(random);
    const auto back = from_kernel(to_kernel(frame), sizeof(can_frame));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->id, frame.id);
    EXPECT_EQ(back->extended, frame.extended);
    EXPECT_EQ(back->remote, frame.remote);
    EXPECT_EQ(back->data, frame.data);
  }
}

TEST(SocketCanFrame, rejects_partial_reads_and_wrong_lengths) {
  can_frame raw{};
  for (std::size_t size = 0; size <= 72; ++size) EXPECT_EQ(from_kernel(raw, size).has_value(), size == 16);
  raw.can_dlc = 9;
  EXPECT_FALSE(from_kernel(raw, 16));
  raw.can_dlc = 8;
  raw.can_id = CAN_ERR_FLAG | 0x40;
  EXPECT_TRUE(from_kernel(raw, 16)->error);
}

}  // namespace
}  // namespace odomcalib::drivers::decode_test
