#include <gtest/gtest.h>

#include <array>

#include "drivers/base/canopen/pdo.hpp"
#include "drivers/base/canopen/sdo_client.hpp"
#include "drivers/base/canopen/words.hpp"
#include "drivers/base/cia402/drive_state.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::canopen::sdo_test {
namespace {

constexpr std::uint8_t kNode = 1;

CanFrame answer(std::initializer_list<int> bytes) {
  CanFrame frame;
  frame.id = 0x580 + kNode;
  for (const int byte : bytes) frame.data[frame.length++] = static_cast<std::uint8_t>(byte);
  frame.length = 8;
  return frame;
}

SdoRequest read_of(std::uint16_t index, std::uint8_t sub) {
  SdoRequest request;
  request.object = {index, sub};
  return request;
}

SdoRequest write_of(std::uint16_t index, std::uint8_t sub, std::vector<std::uint8_t> data) {
  SdoRequest request = read_of(index, sub);
  request.write = true;
  request.data = std::move(data);
  request.retries = 1;
  return request;
}

std::vector<int> sent(SdoClient& client) {
  const auto frames = client.take_frames();
  if (frames.empty()) return {};
  EXPECT_EQ(frames.back().id, 0x600U + kNode);
  EXPECT_EQ(frames.back().length, 8);
  return {frames.back().data.begin(), frames.back().data.end()};
}

TEST(Sdo, reads_the_status_word_of_the_recorded_drive) {
  SdoClient client(kNode);
  ASSERT_TRUE(client.start(read_of(0x6041, 0), 0.0));
  EXPECT_EQ(sent(client), (std::vector<int>{0x40, 0x41, 0x60, 0, 0, 0, 0, 0}));
  client.on_frame(answer({0x43, 0x41, 0x60, 0x00, 0x60, 0x14, 0x60, 0x14}), 0.001);
  const auto result = client.take_result();
  ASSERT_TRUE(result && !result->error);
  EXPECT_EQ(decode(result->data, {4, false}), 0x14601460);
}

TEST(Sdo, writes_one_to_four_bytes_in_one_frame) {
  const std::array<int, 5> command = {0, 0x2F, 0x2B, 0x27, 0x23};
  for (std::size_t n = 1; n <= 4; ++n) {
    SdoClient client(kNode);
    ASSERT_TRUE(client.start(write_of(0x1017, 0, std::vector<std::uint8_t>(n, 0xF4)), 0.0));
    const auto bytes = sent(client);
    EXPECT_EQ(bytes[0], command[n]);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(bytes[4 + i], i < n ? 0xF4 : 0);
    client.on_frame(answer({0x60, 0x17, 0x10, 0x00}), 0.001);
    const auto result = client.take_result();
    EXPECT_TRUE(result && !result->error);
  }
}

TEST(Sdo, reads_a_string_in_segments) {
  SdoClient client(kNode);
  (void)client.start(read_of(0x1008, 0), 0.0);
  client.on_frame(answer({0x41, 0x08, 0x10, 0x00, 15, 0, 0, 0}), 0.0);
  EXPECT_EQ(sent(client)[0], 0x60);
  client.on_frame(answer({0x00, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}), 0.0);
  EXPECT_EQ(sent(client)[0], 0x70);
  client.on_frame(answer({0x10, 'h', 'i', 'j', 'k', 'l', 'm', 'n'}), 0.0);
  EXPECT_EQ(sent(client)[0], 0x60);
  client.on_frame(answer({0x0D, 'o'}), 0.0);
  const auto result = client.take_result();
  ASSERT_TRUE(result && !result->error);
  EXPECT_EQ(std::string(result->data.begin(), result->data.end()), "abcdefghijklmno");
}

TEST(Sdo, writes_any_length_in_segments_that_a_server_can_join) {
  for (std::size_t n = 5; n <= 60; ++n) {
    std::vector<std::uint8_t> data(n);
    for (std::size_t i = 0; i < n; ++i) data[i] = static_cast<std::uint8_t>(i + 1);
    SdoClient client(kNode);
    ASSERT_TRUE(client.start(write_of(0x2000, 1, data), 0.0));
    EXPECT_EQ(sent(client), (std::vector<int>{0x21, 0x00, 0x20, 0x01, static_cast<int>(n), 0, 0, 0}));
    client.on_frame(answer({0x60, 0x00, 0x20, 0x01}), 0.0);
    std::vector<std::uint8_t> joined;
    bool toggle = false;
    for (bool last = false; !last; toggle = !toggle) {
      const auto bytes = sent(client);
      ASSERT_EQ(bytes.size(), 8U);
      EXPECT_EQ((bytes[0] & 0x10) != 0, toggle);
      last = (bytes[0] & 1) != 0;
      for (int i = 0; i < 7 - ((bytes[0] >> 1) & 7); ++i)
        joined.push_back(static_cast<std::uint8_t>(bytes[1 + static_cast<std::size_t>(i)]));
      client.on_frame(answer({toggle ? 0x30 : 0x20}), 0.0);
    }
    EXPECT_EQ(joined, data);
    EXPECT_FALSE(client.busy());
  }
}

TEST(Sdo, an_abort_is_reported_with_object_and_reason) {
  SdoClient client(kNode);
  (void)client.start(write_of(0x6072, 0, {0x10, 0x27}), 0.0);
  client.on_frame(answer({0x80, 0x72, 0x60, 0x00, 0x02, 0x00, 0x01, 0x06}), 0.001);
  const auto result = client.take_result();
  ASSERT_TRUE(result && result->error);
  EXPECT_EQ(result->abort, 0x06010002U);
  EXPECT_NE(result->error->text().find("6072:00"), std::string::npos);
  EXPECT_NE(result->error->text().find("read-only"), std::string::npos);
}

TEST(Sdo, an_abort_in_the_middle_of_segments_ends_the_transfer) {
  SdoClient client(kNode);
  (void)client.start(read_of(0x1008, 0), 0.0);
  client.on_frame(answer({0x41, 0x08, 0x10, 0x00, 15}), 0.0);
  client.on_frame(answer({0x80, 0x08, 0x10, 0x00, 0x24, 0x00, 0x00, 0x08}), 0.0);
  const auto result = client.take_result();
  ASSERT_TRUE(result && result->error);
  EXPECT_EQ(result->abort, 0x08000024U);
}

TEST(Sdo, an_answer_for_another_object_is_not_taken) {
  SdoClient client(kNode);
  (void)client.start(read_of(0x6041, 0), 0.0);
  client.on_frame(answer({0x43, 0x42, 0x60, 0x00, 1}), 0.0);
  client.on_frame(answer({0x43, 0x41, 0x60, 0x01, 1}), 0.0);
  EXPECT_FALSE(client.take_result().has_value());
  EXPECT_EQ(client.counters()["sdo_unexpected"], 2U);
  client.on_frame(answer({0x43, 0x41, 0x60, 0x00, 7}), 0.0);
  EXPECT_EQ(client.take_result()->data[0], 7);
}

TEST(Sdo, a_late_answer_after_the_last_time_out_is_only_counted) {
  SdoClient client(kNode);
  (void)client.start(read_of(0x6041, 0), 0.0);
  for (double now = 0.0; now < 3.0; now += 0.1) client.on_time(now);
  const auto result = client.take_result();
  ASSERT_TRUE(result && result->error);
  EXPECT_EQ(result->error->code, ErrorCode::timeout);
  EXPECT_EQ(client.counters()["sdo_timeouts"], 3U);  // first try and two repetitions
  client.on_frame(answer({0x43, 0x41, 0x60, 0x00, 7}), 3.1);
  EXPECT_FALSE(client.take_result().has_value());
  EXPECT_EQ(client.counters()["sdo_unexpected"], 1U);
}

TEST(Sdo, tells_the_node_when_it_gives_up) {
  SdoClient client(kNode);
  (void)client.start(write_of(0x6072, 0, {1}), 0.0);
  (void)client.take_frames();
  client.on_time(0.6);
  const auto frames = client.take_frames();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].data[0], 0x80);
  EXPECT_EQ(frames[1].data[0], 0x2F);
}

// A bus may deliver a frame twice: the second one has the toggle bit of the segment before.
TEST(Sdo, segments_that_come_twice_are_taken_once) {
  SdoClient client(kNode);
  (void)client.start(read_of(0x1008, 0), 0.0);
  for (const auto& frame :
       {answer({0x41, 0x08, 0x10, 0x00, 15, 0, 0, 0}), answer({0x00, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}),
        answer({0x10, 'h', 'i', 'j', 'k', 'l', 'm', 'n'}), answer({0x0D, 'o'})})
    for (int twice = 0; twice < 2; ++twice) client.on_frame(frame, 0.0);
  const auto result = client.take_result();
  ASSERT_TRUE(result && !result->error);
  EXPECT_EQ(std::string(result->data.begin(), result->data.end()), "abcdefghijklmno");
  EXPECT_EQ(client.counters()["sdo_unexpected"], 4U);

  (void)client.start(write_of(0x2000, 1, std::vector<std::uint8_t>(10, 7)), 0.0);
  for (const auto& frame : {answer({0x60, 0x00, 0x20, 0x01}), answer({0x20}), answer({0x30})})
    for (int twice = 0; twice < 2; ++twice) client.on_frame(frame, 0.0);
  const auto written = client.take_result();
  ASSERT_TRUE(written && !written->error);
  EXPECT_EQ(client.counters()["sdo_unexpected"], 7U);
}

// A finished request may be answered once more: a read while the object is written, a write while it is read.
TEST(Sdo, a_late_answer_of_another_kind_for_the_same_object_is_not_taken) {
  SdoClient client(kNode);
  const CanFrame of_read = answer({0x43, 0x00, 0x21, 0x01, 1}), of_write = answer({0x60, 0x00, 0x21, 0x01});
  (void)client.start(write_of(0x2100, 1, {2, 0, 0, 0}), 0.0);
  client.on_frame(of_read, 0.0);
  EXPECT_TRUE(client.busy());
  client.on_frame(of_write, 0.0);
  ASSERT_FALSE(client.take_result()->error.has_value());
  (void)client.start(read_of(0x2100, 1), 0.0);
  client.on_frame(of_write, 0.0);
  EXPECT_TRUE(client.busy());
  client.on_frame(of_read, 0.0);
  ASSERT_FALSE(client.take_result()->error.has_value());
  EXPECT_EQ(client.counters()["sdo_unexpected"], 2U);
  EXPECT_EQ(client.counters()["sdo_bad"], 0U);
}

TEST(Sdo, announced_and_received_sizes_must_agree) {
  for (const int announced : {0, 1, 6, 8, 15}) {
    SdoClient client(kNode);
    (void)client.start(read_of(0x1008, 0), 0.0);
    client.on_frame(answer({0x41, 0x08, 0x10, 0x00, announced}), 0.0);
    client.on_frame(answer({0x01, 1, 2, 3, 4, 5, 6, 7}), 0.0);
    EXPECT_TRUE(client.take_result()->error.has_value()) << announced;
  }
  SdoClient client(kNode);
  (void)client.start(read_of(0x1008, 0), 0.0);
  client.on_frame(answer({0x41, 0x08, 0x10, 0x00, 7}), 0.0);
  client.on_frame(answer({0x01, 1, 2, 3, 4, 5, 6, 7}), 0.0);
  EXPECT_FALSE(client.take_result()->error.has_value());
}

TEST(Sdo, a_transfer_is_bounded_even_when_the_node_announces_no_size) {
  SdoClient client(kNode);
  (void)client.start(read_of(0x1008, 0), 0.0);
  client.on_frame(answer({0x40, 0x08, 0x10, 0x00}), 0.0);
  bool toggle = false;
  int segments = 0;
  while (client.busy() && segments < 1000) {
    client.on_frame(answer({toggle ? 0x10 : 0x00, 1, 2, 3, 4, 5, 6, 7}), 0.0);
    toggle = !toggle;
    ++segments;
  }
  EXPECT_LT(segments, 200);
  EXPECT_TRUE(client.take_result()->error.has_value());
}

TEST(Sdo, any_sequence_of_answers_ends_in_one_result_or_none) {
  auto random = test::seeded(6);
  for (int run = 0; run < 3000; ++run) {
    SdoClient client(kNode);
    const bool write = random() % 2 == 0;
    (void)client.start(
        write ? write_of(0x2100, 1, std::vector<std::uint8_t>(1 + random() % 20)) : read_of(0x2100, 1), 0.0);
    int results = 0;
    for (int i = 0; i < 30; ++i) {
      CanFrame frame =
          answer({static_cast<int>(random() % 256), 0x00, 0x21, 0x01, test::random_byte(random)});
      frame.length = random() % 10 == 0 ? static_cast<std::uint8_t>(random() % 8) : std::uint8_t{8};
      client.on_frame(frame, 0.0);
      if (const auto result = client.take_result()) {
        ++results;
        EXPECT_LE(result->data.size(), kSdoMostBytes);
      }
    }
    EXPECT_LE(results, 1);
    EXPECT_EQ(client.busy(), results == 0);
  }
}

TEST(Pdo, no_frame_is_read_beyond_what_it_carries) {
  auto random = test::seeded(9);
  constexpr std::array<std::uint8_t, 5> kBits = {8, 16, 24, 32, 64};
  int cut = 0;
  for (int run = 0; run < 5000; ++run) {
    Pdo pdo;
    std::size_t bytes = 0;
    while (bytes < 8 && pdo.entries.size() < 8) {
      const std::uint8_t bits = kBits[random() % kBits.size()];
      if (bytes + bits / 8 > 8) break;
      pdo.entries.push_back({{0x6000, static_cast<std::uint8_t>(pdo.entries.size())}, bits});
      bytes += bits / 8;
    }
    CanFrame frame;
    frame.length = static_cast<std::uint8_t>(random() % 9);
    for (auto& byte : frame.data) byte = test::random_byte(random);
    EXPECT_EQ(mapped_bytes(pdo), bytes);
    std::size_t end = 0;
    for (const PdoEntry& entry : pdo.entries) {
      end += entry.bits / 8U;
      const auto number = unpack(pdo, frame, entry.object);
      EXPECT_EQ(number.has_value(), frame.length >= end);
      if (number && entry.bits < 64) {
        EXPECT_EQ(*number >> entry.bits, 0U);
      }
      cut += number ? 0 : 1;
    }
    EXPECT_FALSE(unpack(pdo, frame, {0x7000, 0}));
  }
  EXPECT_GT(cut, 1000);
}

TEST(Sdo, other_nodes_and_services_are_not_touched) {
  SdoClient client(kNode);
  CanFrame frame = answer({0x43});
  frame.id = 0x582;
  EXPECT_FALSE(client.on_frame(frame, 0.0));
  frame.id = 0x581;
  frame.extended = true;
  EXPECT_FALSE(client.on_frame(frame, 0.0));
}

TEST(Numbers, survive_encoding_in_every_type) {
  auto random = test::seeded(7);
  for (int i = 0; i < 2000; ++i)
    for (const std::uint8_t bytes : std::array<std::uint8_t, 4>{1, 2, 4, 8})
      for (const bool is_signed : {false, true}) {
        const NumberType type{bytes, is_signed};
        const auto value = static_cast<std::int64_t>(random()) * (random() % 2 == 0 ? 1 : -1);
        EXPECT_TRUE(!fits(value, type) || decode(encode(value, type), type) == value);
        EXPECT_TRUE(bytes != 4 || !is_signed ||
                    fits(value, type) == (value == static_cast<std::int32_t>(value)));
      }
}

TEST(Cia402, masks_vendor_bits_of_recorded_status_words) {
  using enum DriveState;
  for (const int word : {0x1460, 0x0650})
    EXPECT_EQ(decode_status(static_cast<std::uint16_t>(word)), switch_on_disabled);
  for (const int word : {0x1421, 0x0631}) EXPECT_EQ(decode_status(static_cast<std::uint16_t>(word)), ready);
  EXPECT_EQ(decode_status(0x0633), switched_on);
  for (const int word : {0x0237, 0x0637, 0x1037, 0x1237, 0x1427, 0x4427, 0x8237, 0x8637})
    EXPECT_EQ(decode_status(static_cast<std::uint16_t>(word)), enabled);
  EXPECT_EQ(decode_status(0x0007), quick_stop_active);
  EXPECT_EQ(decode_status(0x0218), fault);
  EXPECT_EQ(decode_status(0x021F), fault_reaction);
}

TEST(Cia402, never_skips_a_state_and_lets_the_axis_that_is_further_back_decide) {
  using enum DriveState;
  EXPECT_EQ(control_word_towards_enabled(switch_on_disabled, switched_on, false), kShutdown);
  EXPECT_EQ(control_word_towards_enabled(switched_on, ready, false), kSwitchOn);
  EXPECT_EQ(control_word_towards_enabled(enabled, switched_on, false), kEnableOperation);
  EXPECT_EQ(control_word_towards_enabled(enabled, fault, true), kFaultReset);
  EXPECT_EQ(control_word_towards_enabled(enabled, fault, false), kDisableVoltage);
}

TEST(Words, name_codes_and_do_not_invent_names) {
  EXPECT_EQ(abort_text(0x06020000), "object does not exist (06020000h)");
  EXPECT_EQ(abort_text(0x12345678), "unknown abort code (12345678h)");
  EXPECT_EQ(emergency_text(0x8611), "following error (8611h)");
  EXPECT_EQ(emergency_text(0x2399), "current (2399h)");
}

}  // namespace
}  // namespace odomcalib::drivers::canopen::sdo_test
