// Logs of controllers through `decode`: real captures, and frames written down from the protocols.
#include <gtest/gtest.h>

#include "drivers/can/candump.hpp"
#include "drivers/decode/decode.hpp"
#include "tests/unit/drivers/decoded.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::decode_controllers_test {
namespace {

using nlohmann::json;
using test::kProfiles;
using test::named;

std::vector<json> lines_of(const std::string& driver, const std::string& text) {
  return test::lines_of(decode(driver, text, kProfiles, "test"));
}

void expect_all_good(const std::vector<json>& lines) {
  ASSERT_FALSE(lines.empty());
  const json& summary = lines.back();
  EXPECT_EQ(summary["bytes_in"], summary["good"]);
  for (const auto& [name, count] : summary["rejected"].items()) EXPECT_EQ(count, 0) << name;
}

#define CAPTURE(text, path)     \
  ODOMCALIB_CAPTURES(captures); \
  const std::string text = test::read_text(captures / (path))

TEST(Captures, agilex_hunter_counts_in_24_bits) {
  CAPTURE(text, "agilex/hunter_se.log");
  const auto lines = lines_of("agilex:agilex-hunter", text);
  expect_all_good(lines);
  const auto motors = named(lines, "motor");
  ASSERT_EQ(motors.size(), 6U);
  EXPECT_EQ(
      motors[0],
      json::parse(
          R"({"type":"message","t":0.0,"name":"motor","motor":1,"rpm":0,"current_A":1.5,"pulses":84})"));
  EXPECT_EQ(motors[1]["pulses"], -342);
  EXPECT_EQ(motors[2]["pulses"], -1161);
  EXPECT_EQ(motors[2]["current_A"], 0.7);
  const auto state = named(lines, "state");
  EXPECT_EQ(state[0]["battery_V"], 25.9);
  EXPECT_EQ(state[0]["counter"], 0xB1);
  EXPECT_EQ(state[1]["counter"], 0xB2);
  EXPECT_EQ(named(lines, "motion")[0]["steering_rad"], -0.001);
  const auto driver = named(lines, "motor_driver");
  EXPECT_EQ(driver[0]["voltage_V"], 26.3);
  EXPECT_EQ(driver[0]["driver_degC"], 39);
  EXPECT_EQ(driver[0]["motor_degC"], -40);
  EXPECT_EQ(driver[0]["state"], 0x40);
  const auto ticks = named(lines, "ticks");
  ASSERT_EQ(ticks.size(), 2U);
  EXPECT_EQ(ticks[0]["left"], -63);
  EXPECT_EQ(ticks[0]["right"], 18);
}

TEST(Captures, zlac8015d_commissioning) {
  CAPTURE(text, "zlac8015d/commissioning.log");
  const auto lines = lines_of("canopen:zlac8015d", text);
  expect_all_good(lines);
  EXPECT_EQ(lines.size(), 216U);
  EXPECT_EQ(named(lines, "sdo_request").size(), 82U);
  EXPECT_EQ(named(lines, "sdo_answer").size(), 82U);
  EXPECT_TRUE(named(lines, "sdo_abort").empty());
  EXPECT_EQ(lines[1]["value"], 0x14601460);
  const auto heartbeats = named(lines, "heartbeat");
  EXPECT_EQ(heartbeats[0]["state"], "pre-operational");
  EXPECT_EQ(heartbeats.back()["state"], "operational");
  EXPECT_NEAR(heartbeats[1]["t"].get<double>() - heartbeats[0]["t"].get<double>(), 0.2495, 0.001);
  // The mapping that the log sets: RPDO1 6040h and packed speeds, TPDO2 mode and error code.
  const auto speeds = named(lines, "tpdo1");
  EXPECT_EQ(speeds.back()["states"], json::parse(R"(["switch-on disabled","switch-on disabled"])"));
  EXPECT_TRUE(speeds.back()["values"].contains("606C:03"));
  EXPECT_EQ(named(lines, "tpdo2").back()["values"], json::parse(R"({"6061:00":3,"603F:00":0})"));
  EXPECT_EQ(named(lines, "rpdo1").back()["values"]["6040:00"], 2);
  const auto ready = std::find_if(lines.begin(), lines.end(), [](const json& line) {
    return line.contains("states") && line["states"][0] == "ready to switch on";
  });
  ASSERT_NE(ready, lines.end());
  EXPECT_EQ((*ready)["values"]["6041:00"].get<std::uint32_t>() & 0xFFFF, 0x1421U);
}

TEST(Captures, technosoft_ipos_walks_through_the_states) {
  CAPTURE(text, "technosoft-ipos/enable_two_axes.log");
  const auto lines = lines_of("canopen:cia402-pair", text);
  expect_all_good(lines);
  std::vector<std::string> states;
  for (const json& line : named(lines, "tpdo1"))
    if (line["node"] == 2 && (states.empty() || states.back() != line["states"][0]))
      states.push_back(line["states"][0]);
  EXPECT_EQ(states, (std::vector<std::string>{"switch-on disabled", "ready to switch on", "switched on",
                                              "operation enabled"}));
  EXPECT_EQ(named(lines, "tpdo1").back()["values"]["6041:00"], 0x8637);
  EXPECT_EQ(named(lines, "tpdo2").back()["values"]["6061:00"], -2);
  EXPECT_EQ(named(lines, "heartbeat").size(), 2U);
}

TEST(Captures, ihsv60_goes_on_without_6502h) {
  CAPTURE(text, "ihsv60/startup.log");
  const auto lines = lines_of("canopen:cia402-pair", text);
  expect_all_good(lines);
  EXPECT_EQ(named(lines, "sdo_abort")[0]["code"], "06020000");
  EXPECT_EQ(named(lines, "tpdo2")[0]["values"]["6041:00"], 0x1037);
  EXPECT_EQ(named(lines, "tpdo2")[0]["states"][0], "operation enabled");
}

TEST(Captures, orientalmotor_blvd_names_object_and_reason) {
  CAPTURE(text, "orientalmotor-blvd/aborts.log");
  const auto lines = lines_of("canopen:cia402-pair", text);
  expect_all_good(lines);
  const auto aborts = named(lines, "sdo_abort");
  ASSERT_EQ(aborts.size(), 2U);
  EXPECT_EQ(aborts[0]["object"], "60FE:01");
  EXPECT_EQ(aborts[1]["object"], "6072:00");
  EXPECT_EQ(aborts[1]["text"], "write of a read-only object (06010002h)");
}

TEST(Captures, objects_of_the_pair_profile_are_those_of_a_data_sheet) {
  CAPTURE(sheet, "eds/cia402_slave.eds");
  const auto type_of = [&](const std::string& object) {
    const std::size_t at = sheet.find("[" + object + "]");
    if (at == std::string::npos) return std::string();
    const std::size_t key = sheet.find("DataType=", at);
    return sheet.substr(key + 9, sheet.find_first_of("\r\n", key) - key - 9);
  };
  EXPECT_EQ(type_of("6040"), "0x0006");  // u16
  EXPECT_EQ(type_of("6041"), "0x0006");
  EXPECT_EQ(type_of("6060"), "0x0002");  // i8
  EXPECT_EQ(type_of("6064"), "0x0004");  // i32
  EXPECT_EQ(type_of("60FF"), "0x0004");
  EXPECT_EQ(type_of("6092"), "");  // this drive has no feed constant: its profile must not name it
}

TEST(Decode, a_pair_on_sync_gives_ticks_of_one_instant) {
  const std::string log =
      "(1.000000) can0 602#2F001A0000000000\n(1.000100) can0 602#23001A0120006360\n(1.000200) can0 "
      "602#2F001A0001000000\n(1.000300) can0 603#2F001A0000000000\n(1.000400) can0 603#23001A0120006360\n"
      "(1.000500) can0 603#2F001A0001000000\n(2.000000) can0 080#\n(2.000500) can0 182#64000000\n(2.000500) "
      "can0 "
      "183#9CFFFFFF\n";
  const auto ticks = named(lines_of("canopen:cia402-pair", log), "ticks");
  ASSERT_EQ(ticks.size(), 1U);
  EXPECT_EQ(ticks[0]["left"], 100);
  EXPECT_EQ(ticks[0]["right"], 100);  // mounted mirrored
}

TEST(Decode, vesc_tachometers_are_big_endian_and_interpolated) {
  const std::string log =
      "(1.000) can0 00001B02#0000006401690000\n(1.005) can0 00001B01#FFFFFF9C01690000\n(1.020) can0 "
      "00001B02#0000007801690000\n(1.021) can0 00000902#000003E800640123\n(1.030) can0 00000301#00000BB8\n";
  const auto lines = lines_of("vesc", log);
  expect_all_good(lines);
  const auto ticks = named(lines, "ticks");
  ASSERT_EQ(ticks.size(), 1U);
  EXPECT_EQ(ticks[0]["t"], 1.005);
  EXPECT_EQ(ticks[0]["left"], -100);
  EXPECT_EQ(ticks[0]["right"], -105);  // a quarter of the way from 100 to 120, mirrored
  EXPECT_EQ(named(lines, "status")[0]["electrical_rpm"], 1000);
  EXPECT_EQ(named(lines, "status")[0]["current_A"], 10);
  EXPECT_EQ(named(lines, "status_5")[0]["input_voltage_V"], 36.1);
  EXPECT_EQ(named(lines, "set_rpm")[0]["electrical_rpm"], 3000);
}

TEST(Decode, odrive_counts_are_little_endian) {
  const std::string log =
      "(1.000) can0 021#00000000080000\n(1.001) can0 02A#E803000000000000\n(1.001) can0 "
      "04A#18FCFFFF00000000\n"
      "(1.002) can0 029#0000C03F0000003F\n(1.003) can0 029#0000C07F00000000\n";
  const auto lines = lines_of("odrive", log);
  const auto ticks = named(lines, "ticks");
  ASSERT_EQ(ticks.size(), 1U);
  EXPECT_EQ(ticks[0]["left"], 1000);
  EXPECT_EQ(ticks[0]["right"], 1000);
  EXPECT_EQ(named(lines, "heartbeat")[0]["state"], 8);
  EXPECT_EQ(named(lines, "estimates")[0]["position_turns"], 1.5);
  EXPECT_EQ(lines.back()["rejected"]["bad_frames"], 1);  // a position that is not a number
}

TEST(Decode, segway_positions_have_the_low_word_first) {
  const auto ticks = named(lines_of("segway", "(1.0) can0 403#86A00001FFFFFFFF\n"), "ticks");
  ASSERT_EQ(ticks.size(), 1U);
  EXPECT_EQ(ticks[0]["left"], 100000);
  EXPECT_EQ(ticks[0]["right"], -1);
}

TEST(Decode, serial_bases_are_read_from_bytes) {
  const auto board = lines_of("ros_arduino", "12 -7\r\nOK\r\nInvalid Command\r\n20 -9\r\n1x 2\r\n");
  const auto ticks = named(board, "ticks");
  ASSERT_EQ(ticks.size(), 2U);
  EXPECT_EQ(ticks[1]["left"], 20);
  EXPECT_EQ(ticks[1]["right"], -9);
  EXPECT_EQ(board.back()["rejected"]["bad_line"], 1);
  EXPECT_EQ(board.back()["rejected"]["invalid_command"], 1);
  // 90h, 1000 and -1000; the sum is calculated by hand.
  const auto base = lines_of("arcos", "FA FB 0B 90 E8 03 00 00 18 FC FF FF 90 00");
  ASSERT_EQ(base.size(), 2U);
  EXPECT_EQ(base[0]["left"], 1000);
  EXPECT_EQ(base[0]["right"], -1000);
  expect_all_good(base);
}

TEST(Decode, fd_frames_are_refused_by_name_and_times_may_be_absolute) {
  const auto lines = lines_of(
      "canopen:zlac8015d",
      "(1436509052.249713) can0 701#05\n(1436509052.250) can0 123##1AABB\nrubbish\n(1.0) can0 701#7F\n");
  EXPECT_EQ(lines[0]["t"], 1436509052.249713);
  EXPECT_EQ(lines.back()["rejected"]["fd_frame"], 1);
  EXPECT_EQ(lines.back()["rejected"]["bad_line"], 1);
}

TEST(Decode, a_profile_must_be_of_the_named_protocol) {
  EXPECT_EQ(decode("vesc:zlac8015d", "", kProfiles, "f").error().code, ErrorCode::usage);
  EXPECT_EQ(decode("canopen:vesc", "", kProfiles, "f").error().code, ErrorCode::usage);
}

TEST(Candump, what_is_written_is_read_back) {
  auto random = test::seeded(21);
  for (int i = 0; i < 3000; ++i) {
    CanFrame frame;
    frame.t = 1e-6 * static_cast<double>(random());
    frame.extended = random() % 2 == 0;
    frame.error = !frame.extended && random() % 8 == 0;
    frame.id = random() & (frame.extended || frame.error ? 0x1FFFFFFFU : 0x7FFU);
    frame.remote = !frame.error && random() % 4 == 0;
    frame.length = static_cast<std::uint8_t>(random() % 9);
    for (std::size_t k = 0; k < frame.length && !frame.remote; ++k) frame.data[k] = test::random_byte(random);
    const auto back = parse_candump_line(candump_line(frame, "can0"));
    ASSERT_TRUE(back) << candump_line(frame, "can0");
    EXPECT_NEAR(back->t, frame.t, 1e-6);
    EXPECT_EQ(back->id, frame.id);
    EXPECT_EQ(back->extended, frame.extended);
    EXPECT_EQ(back->error, frame.error);
    EXPECT_EQ(back->remote, frame.remote);
    EXPECT_EQ(back->length, frame.length);
    EXPECT_EQ(back->data, frame.data);
  }
}

}  // namespace
}  // namespace odomcalib::drivers::decode_controllers_test
