// Bytes of real lidars (and of one simulated by others): every scan against figures of an independent
// decoder.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "drivers/decode/decode.hpp"
#include "tests/unit/drivers/decoded.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::lidar_captures_test {
namespace {

using nlohmann::json;
using test::of_type;

std::vector<json> decoded(const std::string& driver, const std::filesystem::path& file) {
  auto lines = test::lines_of(decode(driver, test::read_text(file), "", file.string()));
  test::expect_accounted_summary(lines.back());
  return lines;
}

/// Whole millimetres, 0 for no reading.
std::vector<int> millimetres(const json& scan) {
  std::vector<int> out;
  for (const json& range : scan["ranges"])
    out.push_back(range.is_null() ? 0 : static_cast<int>(std::lround(1000.0 * range.get<double>())));
  return out;
}

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// Values below 16 are error codes.
std::vector<int> without_codes(std::vector<int> raw) {
  for (int& value : raw) value = value < 16 ? 0 : value;
  return raw;
}

TEST(LidarCaptures, express_capsules_of_an_rplidar) {
  ODOMCALIB_CAPTURES(folder);
  const auto lines = decoded("rplidar", folder / "rplidar/express_capsules.txt");
  std::vector<double> angles, ranges;
  std::vector<std::size_t> turns;
  for (const json& scan : of_type(lines, "scan")) {
    turns.push_back(ranges.size());
    for (const json& angle : scan["angles"]) angles.push_back(-degrees(angle));
    for (const json& range : scan["ranges"])
      ranges.push_back(range.is_null() ? 0.0 : 1000.0 * range.get<double>());
  }
  ASSERT_EQ(ranges.size(), 128U);
  EXPECT_EQ(turns, (std::vector<std::size_t>{0, 76}));  // the one point with the start flag
  std::istringstream nodes(test::read_text(folder / "rplidar/express_nodes.csv"));
  std::size_t i = 0;
  for (std::string line; std::getline(nodes, line);) {
    int capsule = 0, index = 0, flag = 0, quality = 0, angle = 0, quarters = 0;
    if (std::sscanf(line.c_str(), "%d,%d,%d,%d,%d,%d", &capsule, &index, &flag, &quality, &angle,
                    &quarters) != 6)
      continue;
    ASSERT_LT(i, ranges.size());
    EXPECT_NEAR(ranges[i], quarters / 4.0, 1e-3);
    // The other decoder cuts angles off to 1/64 degree, and then to its own unit.
    EXPECT_NEAR(std::remainder(angles[i] - angle * 90.0 / 16'384.0, 360.0), 0.0,
                1.0 / 64.0 + 90.0 / 16'384.0);
    EXPECT_EQ(flag == 1, i == 76);
    ++i;
  }
  EXPECT_EQ(i, 128U);
  EXPECT_EQ(lines.back()["good"], 420);
}

TEST(LidarCaptures, handshake_of_an_rplidar) {
  ODOMCALIB_CAPTURES(folder);
  const auto lines = decoded("rplidar", folder / "rplidar/a1_handshake.txt");
  ASSERT_EQ(lines.size(), 8U);
  EXPECT_EQ(lines[0]["name"], "rplidar_health");
  EXPECT_EQ(lines[1]["model"], 0x18);
  EXPECT_EQ(lines[1]["firmware"], "1.29");
  EXPECT_EQ(lines[1]["hardware"], 7);
  EXPECT_EQ(lines[2]["sample_time_us"], 127.0);
  EXPECT_EQ(lines[3]["range_max"], 12.0);
  EXPECT_EQ(lines[4]["answer_type"], 0x84);
  EXPECT_EQ(lines[5]["mode_name"], "Sensitivity");
  EXPECT_EQ(lines.back()["skipped"], 0);
}

TEST(LidarCaptures, triangle_stream_of_a_ydlidar) {
  ODOMCALIB_CAPTURES(folder);
  const auto lines = decoded("ydlidar", folder / "ydlidar/triangle_stream.txt");
  std::vector<double> angles;
  std::vector<int> ranges;
  for (const json& scan : of_type(lines, "scan")) {
    for (const json& angle : scan["angles"]) angles.push_back(-degrees(angle));
    for (const int range : millimetres(scan)) ranges.push_back(range);
  }
  std::size_t i = 0;
  for (const json& packet : json::parse(test::read_text(folder / "ydlidar/triangle_expected.json"))) {
    if (packet["checksum_computed"] != packet["checksum_in_packet"]) continue;
    for (const json& point : packet["points"]) {
      ASSERT_LT(i, ranges.size());
      EXPECT_NEAR(std::remainder(angles[i] - point[0].get<double>(), 360.0), 0.0, 1e-3);
      EXPECT_EQ(ranges[i], point[1].get<double>());
      ++i;
    }
  }
  EXPECT_EQ(i, ranges.size());
  EXPECT_EQ(i, 41U);
  const json& summary = lines.back();
  EXPECT_EQ(summary["rejected"]["bad_checksum"], 1);
  EXPECT_EQ(summary["good"], 102);
  EXPECT_EQ(summary["buffered"], 54);
}

TEST(LidarCaptures, session_of_a_hokuyo_client) {
  ODOMCALIB_CAPTURES(folder);
  const auto path = folder / "hokuyo-utm30lx-ew-sim";
  const auto lines = decoded("hokuyo", path / "session.txt");
  const json expected = json::parse(test::read_text(path / "expected.json"));
  const auto scans = of_type(lines, "scan");
  ASSERT_EQ(scans.size(), expected["scans"].size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const json& told = expected["scans"][i];
    const auto ranges = millimetres(scans[i]);
    ASSERT_EQ(ranges.size(), told["n"].get<std::size_t>());
    EXPECT_NEAR(scans[i]["device_time"].get<double>(), told["t"].get<int>() * 1e-3, 1e-9);
    for (std::size_t k = 0; k < told["ranges_first"].size(); ++k)
      EXPECT_EQ(ranges[k], told["ranges_first"][k]);
    int sum = 1;  // step 100 reads 1, an error code
    for (const int range : ranges) sum += range;
    EXPECT_EQ(sum, told["ranges_sum"]);
    EXPECT_EQ(ranges[100], 0);
    EXPECT_EQ(ranges[540], 3200);
    EXPECT_NEAR(degrees(scans[i]["angle_min"]), -135.0, 1e-9);
    if (!told.contains("intens_sum")) continue;
    double intensities = 0.0;
    for (const json& value : scans[i]["intensities"]) intensities += value.get<double>();
    EXPECT_EQ(intensities, told["intens_sum"].get<double>());
  }
  EXPECT_EQ(lines.back()["rejected"]["bad_sum"], 0);
}

TEST(LidarCaptures, session_of_a_sick_lms111) {
  ODOMCALIB_CAPTURES(folder);
  const auto lines = decoded("cola", folder / "sick-lms111/lms111.txt");
  const json expected = json::parse(test::read_text(folder / "sick-lms111/lms111.expected.json"));
  const auto scans = of_type(lines, "scan");
  ASSERT_EQ(scans.size(), 172U);
  std::size_t i = 0;
  int before = -1;
  for (const json& told : expected["scans"]) {
    if (told["tgc"] == before) continue;  // the same telegram again
    before = told["tgc"];
    const json& scan = scans.at(i++);
    const json& channel = told["channels"][0];
    const auto ranges = millimetres(scan);
    ASSERT_EQ(ranges.size(), channel["n"].get<std::size_t>());
    EXPECT_EQ(scan["counter"], told["tgc"]);
    EXPECT_NEAR(scan["device_time"].get<double>(), told["t_up"].get<double>() * 1e-6, 1e-9);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(ranges[k], channel["first"][k]);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(ranges[ranges.size() - 3 + k], channel["last"][k]);
    EXPECT_NEAR(degrees(scan["angle_min"]), -45.0, 1e-9);
    EXPECT_NEAR(degrees(scan["angle_increment"]), 0.5, 1e-9);
  }
  EXPECT_EQ(i, 172U);
  EXPECT_EQ(lines.back()["rejected"]["repeated_scans"], 3);
  EXPECT_EQ(lines.back()["good"], 210'500);
  EXPECT_NEAR(scans.back()["time_increment"].get<double>(), 0.02011 * 0.5 / 360.0, 2e-8)
      << "measured, not nominal";
}

TEST(LidarCaptures, text_telegrams_of_a_sick_tim551) {
  ODOMCALIB_CAPTURES(folder);
  const auto lines = decoded("cola", folder / "sick-tim551/tim551_cola_a.txt");
  const json expected = json::parse(test::read_text(folder / "sick-tim551/tim551_cola_a.expected.json"));
  const auto scans = of_type(lines, "scan");
  ASSERT_EQ(scans.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const json& channels = expected[i]["channels"];
    EXPECT_EQ(millimetres(scans[i]), without_codes(channels[0]["values"]));
    EXPECT_EQ(scans[i]["intensities"].get<std::vector<double>>(),
              channels[1]["values"].get<std::vector<double>>());
    EXPECT_NEAR(degrees(scans[i]["angle_increment"]), 1.0, 1e-9);
    EXPECT_EQ(scans[i]["counter"], expected[i]["tgc"]);
  }
  EXPECT_EQ(lines.back()["skipped"], 0);
}

/// Blocks of a pcapng file: the TCP payload of each Ethernet frame that comes from `port`, in order.
std::string payloads(const std::string& file, unsigned port) {
  const auto u8 = [&](std::size_t at) -> std::size_t { return static_cast<unsigned char>(file[at]); };
  const auto u16 = [&](std::size_t at) { return u8(at) << 8U | u8(at + 1); };  // of a frame: big endian
  const auto u32 = [&](std::size_t at) {                                       // of the file: little endian
    return u8(at) | u8(at + 1) << 8U | u8(at + 2) << 16U | u8(at + 3) << 24U;
  };
  std::string out;
  for (std::size_t at = 0; at + 12 <= file.size(); at += u32(at + 4)) {
    if (u32(at) != 6) continue;  // enhanced packet
    const std::size_t ip = at + 28 + 14, tcp = ip + 4 * (u8(ip) & 15U);
    const std::size_t data = tcp + 4 * (u8(tcp + 12) >> 4U);
    if (u16(ip - 2) == 0x0800 && file[ip + 9] == 6 && u16(tcp) == port)
      out += file.substr(data, ip + u16(ip + 2) - data);
  }
  return out;
}

TEST(LidarCaptures, network_traffic_of_a_sick_tim781s) {
  ODOMCALIB_CAPTURES(folder);
  const std::string bytes = payloads(test::read_text(folder / "sick-tim781s/tim781s_1s.pcapng"), 2112);
  const auto scans = of_type(test::lines_of(decode("sick", bytes, "", "capture")), "scan");
  ASSERT_EQ(scans.size(), 16U);
  for (const json& scan : scans) {
    EXPECT_EQ(scan["ranges"].size(), 811U);
    EXPECT_NEAR(degrees(scan["angle_increment"]), 1.0 / 3.0, 1e-9) << "the field says 0.3333";
    EXPECT_NEAR(degrees(scan["angle_min"].get<double>() + 810 * scan["angle_increment"].get<double>()), 225.0,
                1e-6);
  }
  const auto first = millimetres(scans.front()), last = millimetres(scans.back());
  EXPECT_EQ(std::vector<int>(first.begin(), first.begin() + 6), (std::vector<int>{626, 657, 616, 0, 0, 0}));
  EXPECT_EQ(std::vector<int>(last.begin(), last.begin() + 6), (std::vector<int>{619, 615, 638, 0, 644, 0}));
  EXPECT_EQ(scans.back()["counter"].get<int>() - scans.front()["counter"].get<int>(), 15);
  EXPECT_NEAR((scans.back()["device_time"].get<double>() - scans.front()["device_time"].get<double>()) / 15,
              0.06667, 1e-4);
}

TEST(LidarCaptures, one_packet_of_a_neato_xv11) {
  ODOMCALIB_CAPTURES(folder);
  const auto lines = decoded("xv11", folder / "neato-xv11/xv11_packet.txt");
  const json packet = of_type(lines, "message").at(0);
  EXPECT_EQ(packet["index"], 17);
  EXPECT_NEAR(packet["rpm"].get<double>(), 305.67, 0.005);
  EXPECT_EQ(packet["weak"], (json::array({1, 0, 0, 0})));
  EXPECT_EQ(packet["intensities"], (json::array({96, 267, 724, 631})));
  const json scan = of_type(lines, "scan").at(0);
  EXPECT_TRUE(scan["partial"]);
  EXPECT_EQ(millimetres(scan), (std::vector<int>{216, 209, 204, 200}));
  EXPECT_NEAR(degrees(scan["angle_min"]), 68.0, 1e-6);
  EXPECT_NEAR(degrees(scan["angle_increment"]), 1.0, 1e-6);
}

}  // namespace
}  // namespace odomcalib::drivers::lidar_captures_test
