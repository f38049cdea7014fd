// Damaged files, messages and calls, well over a thousand of each kind: an answer or an error that says
// where, never a number that is not finite, never a crash.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "proto/calibration/calibration.hpp"
#include "proto/control/control.hpp"
#include "proto/recording/pose_graph.hpp"
#include "proto/wire/event_log.hpp"
#include "proto/wire/messages.hpp"
#include "tests/unit/proto/support.hpp"

namespace odomcalib::malformed_test {
namespace {

constexpr int kCases = 1500;

class Random {
 public:
  explicit Random(unsigned usual) {
    const char* given = std::getenv("ODOMCALIB_TEST_SEED");
    const unsigned seed = given != nullptr ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : usual;
    std::printf("seed %u\n", seed);
    engine_.seed(seed);
  }
  /// Below n; 0 when n is 0.
  std::size_t below(std::size_t n) { return n == 0 ? 0 : engine_() % n; }
  char byte() { return static_cast<char>(engine_()); }

 private:
  std::mt19937 engine_;
};

/// One of the ways in which bytes go wrong.
void damage_bytes(std::string& bytes, Random& random) {
  const std::size_t at = random.below(bytes.size());
  switch (random.below(6)) {
    case 0:
      bytes.resize(at);
      break;
    case 1:
      bytes.erase(at, 1 + random.below(20));
      break;
    case 2:
      bytes.insert(at, bytes.substr(random.below(bytes.size()), random.below(60)));
      break;
    case 3:
      bytes.insert(at, 1 + random.below(8), random.byte());
      break;
    default:
      if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
  }
}

/// Puts a number or a word where a number stood: limits, overflow, what is not finite, the wrong type.
void damage_number(std::string& text, Random& random) {
  constexpr std::array kWords = {
      "0",          "-0",   "1",     "-1",       "1e308", "-1e308", "1e999", "1e-320",
      "4294967296", "NaN",  "-NaN",  "Infinity", "nan",   "-inf",   "0x10",  "9223372036854775808",
      "2147483648", "null", "\"1\"", "[1,2]",    "{}",    "true",   "",      "18446744073709551615",
      "1.5.2",      "+1",   "1e",    "-",        ".",     "00012",  "1,2",   "999999999999999999999999"};
  std::size_t at = text.find_first_of("0123456789", random.below(text.size()));
  if (at == std::string::npos) return;
  const std::size_t end = std::min(text.find_first_not_of("0123456789.e-", at), text.size());
  text.replace(at, end - at, kWords[random.below(kWords.size())]);
}

/// Whatever text is made of `good`, several times over.
void for_damaged(const std::string& good, unsigned seed,
                 const std::function<void(const std::string&)>& take) {
  Random random(seed);
  for (int i = 0; i < kCases; ++i) {
    std::string text = good;
    for (std::size_t n = 1 + random.below(4); n > 0 && !text.empty(); --n)
      random.below(2) == 0 ? damage_bytes(text, random) : damage_number(text, random);
    SCOPED_TRACE(text);
    take(text);
    if (testing::Test::HasFatalFailure()) return;
  }
  for (std::size_t size = 0; size < good.size(); ++size) take(good.substr(0, size));
}

template <typename Sample>
void expect_ordered(const std::vector<Sample>& samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_TRUE(std::isfinite(samples[i].t));
    if (i > 0) {
      ASSERT_LT(samples[i - 1].t, samples[i].t);
    }
  }
}

void expect_sound(const Scan& scan) {
  ASSERT_TRUE(scan.angles.empty() || scan.angles.size() == scan.ranges.size());
  ASSERT_TRUE(scan.times.empty() || scan.times.size() == scan.ranges.size());
  for (const float range : scan.ranges) ASSERT_TRUE(std::isfinite(range) && range >= 0.0F);
  for (const float angle : scan.angles) ASSERT_TRUE(std::isfinite(angle));
}

void expect_sound_recording(const std::string& bytes) {
  const RobotDescription robot = test::example_robot();
  const auto result = read_recording_bytes(bytes, "damaged", &robot);
  if (!result.ok()) {
    ASSERT_FALSE(result.error().where.empty());
    return;
  }
  const Recording& recording = result.value();
  expect_ordered(recording.ticks);
  expect_ordered(recording.scans);
  expect_ordered(recording.poses);
  expect_ordered(recording.gyro);
  for (const Scan& scan : recording.scans) expect_sound(scan);
  for (const PoseSample& pose : recording.poses)
    ASSERT_TRUE(std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw));
  for (const GyroSample& gyro : recording.gyro) ASSERT_TRUE(std::isfinite(gyro.yaw_rate));
}

const std::string kScanLine =
    R"({"type":"scan","t":0.05,"angle_min":-1.5,"angle_increment":0.1,"time_increment":0.001,"range_min":0.1,)"
    R"("range_max":8,"ranges":[1.5,2.25,null,7.5]})"
    "\n";

TEST(Damaged, json_lines_give_finite_sorted_samples_or_an_error) {
  for_damaged(test::kRobotLine +
                  std::string("{\"type\":\"ticks\",\"t\":0.01,\"left\":0,\"right\":0}\n"
                              "{\"type\":\"ticks\",\"t\":0.02,\"left\":7,\"right\":9}\n") +
                  kScanLine +
                  "{\"type\":\"pose\",\"t\":0.06,\"x\":1.5,\"y\":2,\"yaw\":0.25}\n"
                  "{\"type\":\"gyro\",\"t\":0.07,\"yaw_rate\":0.5}\n"
                  "{\"type\":\"scan\",\"t\":0.08,\"angles\":[0.1,0.2],\"times\":[0,0.01],\"ranges\":[1,2]}\n",
              101, expect_sound_recording);
}

TEST(Damaged, tuples_give_finite_sorted_samples_or_an_error) {
  for_damaged(
      "{\"T\":1.5,\"phi_l\":1.25,\"phi_r\":1.5,\"sm\":[0.01,0.02,0.03]}\n"
      "{\"T\":1.5,\"phi_l\":2.25,\"phi_r\":1.5,\"sm\":[0.01,0.02,0.03]}",
      102, expect_sound_recording);
}

TEST(Damaged, carmen_logs_give_finite_sorted_samples_or_an_error) {
  for_damaged(
      "PARAM robot_frontlaser_offset 0.1 0 host 0\n"
      "ODOM 0.1 0.2 0.3 0.1 0 0 1000.5 host 0.5\n"
      "FLASER 3 1.5 2.5 3.5 0.1 0.2 0.3 0.1 0.2 0.3 1000.75 host 0.75\n"
      "ODOM 0.2 0.2 0.3 0.1 0 0 1001.5 host 1.5\n"
      "ROBOTLASER1 0 -1.5 3.14 1.5 8 0.01 0 2 1.5 2.5 0 0.1 0.2 0.3 0.1 0.2 0.3 0 0 0 0 0 1002 host 2\n",
      103, expect_sound_recording);
}

std::string event_bytes(std::uint32_t number, const std::string& channel, const std::string& data) {
  const auto big = [](std::uint64_t value, unsigned bytes) {
    std::string out;
    for (unsigned i = bytes; i-- > 0;) out += static_cast<char>(value >> (8 * i));
    return out;
  };
  return big(0xEDA1DA01, 4) + big(number, 8) + big(1'700'000'000'000'000 + number, 8) +
         big(channel.size(), 4) + big(data.size(), 4) + channel + data;
}

messages::Stamp stamp_of(std::int64_t i) {
  return {1'700'000'000'000'000 + i * 10'000, 1'000'000'000 + i * 10'000'000};
}

Scan example_scan() {
  Scan scan;
  scan.sensor = "front";
  scan.angle_min = -0.5;
  scan.angle_increment = 0.25;
  scan.range_min = 0.0625;
  scan.range_max = 8.5;
  scan.ranges = {1.5F, 0.0F, 3.25F};
  scan.angles = {0.25F, 0.5F, 0.75F};
  scan.times = {0.0F, 0.01F, 0.02F};
  scan.intensities = {7.0F, 8.0F, 9.0F};
  return scan;
}

std::string example_log() {
  TickSample ticks;
  ticks.left = 100;
  ticks.right = 120;
  std::string out =
      event_bytes(0, "ODOMCALIB_ROBOT", messages::encode(stamp_of(0).utime, test::example_robot()));
  out += event_bytes(1, "ODOMCALIB_TICKS", messages::encode(stamp_of(1), TickSample{}));
  out += event_bytes(2, "ODOMCALIB_TICKS", messages::encode(stamp_of(2), ticks));
  out += event_bytes(3, "ODOMCALIB_SCAN", messages::encode(stamp_of(3), example_scan()));
  return out + event_bytes(4, "ODOMCALIB_GYRO", messages::encode(stamp_of(4), GyroSample{0.0, 0.5}));
}

TEST(Damaged, lcm_logs_give_finite_sorted_samples_or_an_error) {
  for_damaged(example_log(), 104, expect_sound_recording);
}

TEST(Damaged, lcm_logs_account_for_every_byte) {
  for_damaged(example_log(), 105, [](const std::string& bytes) {
    EventLogReader log(bytes);
    while (log.next()) continue;
    ASSERT_EQ(bytes.size(), log.counters().good + log.counters().skipped + log.counters().cut_off);
  });
}

/// Every decoder sees the bytes. That numbers are finite is checked where messages become samples.
void expect_bounded_or_refused(const std::string& bytes) {
  int accepted = 0;
  if (const auto scan = messages::decode_scan(bytes)) {
    ASSERT_LE(4 * (scan->scan.ranges.size() + scan->scan.angles.size()), bytes.size());
    ++accepted;
  }
  if (const auto text = messages::decode_json(bytes)) {
    ASSERT_LE(text->json.size() + text->format.size(), bytes.size());
    ++accepted;
  }
  if (const auto event = messages::decode_event(bytes)) {
    ASSERT_LE(event->code.size() + event->text.size(), bytes.size());
    ++accepted;
  }
  accepted += messages::decode_robot(bytes).has_value() + messages::decode_ticks(bytes).has_value() +
              messages::decode_pose(bytes).has_value() + messages::decode_gyro(bytes).has_value();
  ASSERT_LE(accepted, 1) << "one fingerprint, one type";
}

TEST(Damaged, messages_are_bounded_by_their_bytes_or_refused) {
  const std::vector<std::string> all{
      messages::encode(1, test::example_robot()),
      messages::encode(stamp_of(1), TickSample{}),
      messages::encode(stamp_of(1), example_scan()),
      messages::encode(stamp_of(1), PoseSample{0, 1.5, 2.5, 0.5}),
      messages::encode(stamp_of(1), GyroSample{0, 0.5}),
      messages::encode_event(stamp_of(1), messages::Severity::info, "code", "text"),
      messages::encode_json(1, "form", "{}"),
  };
  unsigned seed = 110;
  for (const std::string& good : all) {
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      std::string bytes = good;
      bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
      expect_bounded_or_refused(bytes);
    }
    for_damaged(good, seed++, expect_bounded_or_refused);
  }
}

TEST(Damaged, messages_with_a_flipped_bit_in_their_fingerprint_are_refused) {
  const std::string good = messages::encode(stamp_of(1), example_scan());
  for (std::size_t bit = 0; bit < 64; ++bit) {
    std::string bytes = good;
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
    EXPECT_FALSE(messages::decode_scan(bytes)) << bit;
  }
}

TEST(Damaged, pose_graphs_are_sound_or_refused_with_a_place) {
  for_damaged(
      "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1.5 0.25 0.1\nVERTEX2 2 2 0 0\nVERTEX_XY 9 1 1\nFIX 0\n"
      "EDGE_SE2 0 1 1.5 0.25 0.1 10 1 2 20 3 30\nEDGE2 1 2 1 0 0 10 1 20 30 2 3\n"
      "EDGE_SE2_XY 1 9 1 0 1 0 1\n# remark\n",
      120, [](const std::string& text) {
        const auto graph = read_pose_graph_text(text, "damaged");
        if (!graph.ok()) {
          ASSERT_NE(graph.error().text().find("damaged"), std::string::npos);
          return;
        }
        for (const auto& vertex : graph.value().vertices)
          ASSERT_TRUE(std::isfinite(vertex.x) && std::isfinite(vertex.y) && std::isfinite(vertex.yaw));
        for (const auto& edge : graph.value().edges) {
          ASSERT_TRUE(edge.from < graph.value().vertices.size() && edge.to < graph.value().vertices.size());
          ASSERT_NE(edge.from, edge.to);
          for (const double number : edge.motion) ASSERT_TRUE(std::isfinite(number));
          for (const double number : edge.information) ASSERT_TRUE(std::isfinite(number));
        }
      });
}

TEST(Damaged, calls_are_refused_or_survive_their_own_encoding) {
  std::string good = control::encode_call({.method = "org.odomcalib.Calibration.Straight",
                                           .parameters = nlohmann::ordered_json::parse(
                                               R"({"lease":"a1","distance":-1.5,"list":[1,2,{"x":null}]})"),
                                           .oneway = true});
  good.pop_back();
  for_damaged(good, 121, [](const std::string& text) {
    const auto call = control::decode_call(text);
    if (!call.ok()) {
      ASSERT_EQ(call.error().code, ErrorCode::format);
      return;
    }
    std::string again = control::encode_call(call.value());
    again.pop_back();
    const auto back = control::decode_call(again);
    ASSERT_TRUE(back.ok());
    ASSERT_EQ(back.value().method, call.value().method);
    ASSERT_EQ(back.value().parameters, call.value().parameters);
  });
}

TEST(Damaged, replies_are_refused_or_read) {
  std::string good =
      control::encode_error({ErrorCode::device, "the drive says \"no\"", "6040:00", "switch it off and on"});
  good.pop_back();
  for_damaged(good, 122, [](const std::string& text) {
    const auto reply = control::decode_reply(text);
    if (reply.ok())
      (void)control::error_of(reply.value());
    else
      ASSERT_EQ(reply.error().code, ErrorCode::format);
  });
}

TEST(Damaged, calibrations_are_refused_with_a_place_or_survive_writing) {
  Calibration calibration;
  calibration.robot = test::example_robot();
  for_damaged(to_json(calibration), 123, [](const std::string& text) {
    const auto read = calibration_from_json(text, "cal.json");
    if (!read.ok()) {
      ASSERT_NE(read.error().text().find("cal.json"), std::string::npos) << read.error().text();
      return;
    }
    const std::string written = to_json(read.value());
    const auto again = calibration_from_json(written, "cal.json");
    ASSERT_TRUE(again.ok()) << again.error().text();
    ASSERT_EQ(to_json(again.value()), written);
  });
}

}  // namespace
}  // namespace odomcalib::malformed_test
