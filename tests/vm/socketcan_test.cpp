// The kernel's CAN sockets under drivers/can: frames, errors, losses, times, and interfaces that come and go.
#include <linux/can/error.h>
#include <poll.h>
#include <sys/time.h>

#include <array>
#include <chrono>
#include <numeric>
#include <thread>

#include "tests/vm/can_bench.hpp"

namespace odomcalib::vm {
namespace {

using drivers::CanFrame;

class SocketCan : public ::testing::Test {
 protected:
  SocketCan() : transport_(opened("socketcan:vcan0")) {}
  CanFrame only_frame() {
    const auto frames = frames_from(*transport_, 1);
    EXPECT_EQ(frames.size(), 1U);
    return frames.empty() ? CanFrame{} : frames.front();
  }
  /// The kernel begins to stamp frames a little after the first socket asks for it.
  static void wait_for_stamps() { std::this_thread::sleep_for(std::chrono::milliseconds(50)); }
  std::uint64_t counted(const std::string& name) { return transport_->counters().at(name); }

  Vcan bus_{"vcan0"};
  Peer peer_{"vcan0"};
  std::unique_ptr<drivers::CanTransport> transport_;
};

TEST_F(SocketCan, receives_every_length_and_both_kinds_of_identifiers) {
  for (int length = 0; length <= 8; ++length) {
    std::vector<int> bytes(static_cast<std::size_t>(length));
    std::iota(bytes.begin(), bytes.end(), 0x10 * length);
    for (const canid_t id : {canid_t{0x7FF}, canid_t{0x1ABCDEF0} | CAN_EFF_FLAG}) {
      ASSERT_TRUE(peer_.send(frame_of(id, bytes)));
      const CanFrame got = only_frame();
      EXPECT_EQ(got.id, id & CAN_EFF_MASK);
      EXPECT_EQ(got.extended, (id & CAN_EFF_FLAG) != 0);
      EXPECT_EQ(std::vector<int>(got.data.begin(), got.data.begin() + got.length), bytes);
    }
  }
}

TEST_F(SocketCan, sends_what_another_socket_reads) {
  CanFrame frame;
  frame.id = 0x601;
  frame.length = 8;
  frame.data = {0x2B, 0x40, 0x60, 0, 6, 0, 0, 0};
  ASSERT_TRUE(transport_->send(frame).ok());
  const auto got = peer_.receive();
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(got->can_id, 0x601U);
  EXPECT_EQ(got->len, 8);
  EXPECT_EQ(got->data[1], 0x40);
  EXPECT_TRUE(frames_from(*transport_, 1, 0.05).empty()) << "own frames come back";
}

TEST_F(SocketCan, remote_frames_have_a_length_and_no_data) {
  ASSERT_TRUE(peer_.send(frame_of(0x701 | CAN_RTR_FLAG, {1})));
  const CanFrame got = only_frame();
  EXPECT_TRUE(got.remote);
  EXPECT_EQ(got.length, 1);
  EXPECT_EQ(got.data[0], 0);
}

TEST_F(SocketCan, frames_of_flexible_data_rate_do_not_disturb) {
  const Peer modern("vcan0", true);
  canfd_frame frame{};
  frame.can_id = 0x123;
  frame.len = 64;
  ASSERT_TRUE(modern.send_flexible(frame));
  ASSERT_TRUE(peer_.send(frame_of(0x181, {1, 2})));
  EXPECT_EQ(only_frame().id, 0x181U);
  EXPECT_EQ(counted("bytes_in"), counted("good") + counted("skipped"));
}

TEST_F(SocketCan, every_class_of_error_frames_arrives) {
  for (canid_t bit = 1; bit <= CAN_ERR_RESTARTED; bit <<= 1) {
    ASSERT_TRUE(peer_.send(error_of(bit)));
    const CanFrame got = only_frame();
    EXPECT_TRUE(got.error);
    EXPECT_EQ(got.id, bit);
  }
  EXPECT_EQ(counted("error_frames"), 9U);
  EXPECT_EQ(counted("bus_off"), 1U);
  EXPECT_EQ(counted("frames"), 0U);
}

TEST_F(SocketCan, a_frame_carries_the_time_of_its_arrival_not_of_its_reading) {
  wait_for_stamps();
  const double sent = monotonic();
  ASSERT_TRUE(peer_.send(frame_of(0x181, {1})));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  ASSERT_GE(monotonic() - sent, 0.2);
  EXPECT_NEAR(only_frame().t, sent, 0.01);
}

TEST_F(SocketCan, times_of_a_burst_are_in_order_and_apart_as_sent) {
  constexpr int kFrames = 20;
  wait_for_stamps();
  const double begin = monotonic();
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(peer_.send(frame_of(0x181, {i})));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const double end = monotonic();
  const auto frames = frames_from(*transport_, kFrames);
  ASSERT_EQ(frames.size(), std::size_t{kFrames});
  for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_GT(frames[i].t, frames[i - 1].t + 0.004);
  EXPECT_GE(frames.front().t, begin - 0.002);
  EXPECT_LE(frames.back().t, end + 0.002);
}

TEST_F(SocketCan, a_step_of_the_wall_clock_does_not_move_a_frame) {
  wait_for_stamps();
  timeval clock{};
  gettimeofday(&clock, nullptr);
  for (const int step_us : {500'000, -500'000}) {
    const double sent = monotonic();
    ASSERT_TRUE(peer_.send(frame_of(0x181, {2})));
    gettimeofday(&clock, nullptr);
    const long moved = clock.tv_usec + step_us;
    clock.tv_sec += moved < 0 ? -1 : moved / 1'000'000;
    clock.tv_usec = (moved + 1'000'000) % 1'000'000;
    if (settimeofday(&clock, nullptr) != 0) GTEST_SKIP() << "this machine's clock may not be set";
    const CanFrame got = only_frame();
    EXPECT_NEAR(got.t, sent, 0.02) << step_us;
    ASSERT_TRUE(peer_.send(frame_of(0x181, {3})));
    EXPECT_NEAR(only_frame().t, monotonic(), 0.02) << "after " << step_us;
  }
}

TEST_F(SocketCan, frames_lost_in_a_full_socket_are_counted) {
  constexpr std::uint64_t kSent = 5000;
  for (std::uint64_t i = 0; i < kSent; ++i)
    ASSERT_TRUE(peer_.send(frame_of(0x181, {1, 2, 3, 4, 5, 6, 7, 8})));
  const std::size_t kept = frames_from(*transport_, kSent, 0.3).size();
  EXPECT_LT(kept, kSent);
  ASSERT_TRUE(peer_.send(frame_of(0x182, {})));  // the count of losses comes with the next frame
  EXPECT_EQ(only_frame().id, 0x182U);
  EXPECT_EQ(kept + counted("lost_in_socket"), kSent);
  std::printf("kept %zu of %lu\n", kept, kSent);
}

TEST_F(SocketCan, a_full_bus_of_1_Mbit_is_read_without_loss_by_a_loop_of_10_ms) {
  constexpr std::size_t kPerTurn = 90;  // 9000 frames/s: 111 bits each
  std::size_t got = 0;
  for (int turn = 0; turn < 100; ++turn) {
    for (std::size_t i = 0; i < kPerTurn; ++i)
      ASSERT_TRUE(peer_.send(frame_of(0x181, {0, 0, 0, 0, 0, 0, 0, 0})));
    const auto frames = transport_->receive(monotonic());
    ASSERT_TRUE(frames.ok());
    got += frames.value().size();
  }
  got += frames_from(*transport_, 100 * kPerTurn - got).size();
  EXPECT_EQ(got, 100 * kPerTurn);
  EXPECT_EQ(counted("lost_in_socket"), 0U);
}

TEST_F(SocketCan, one_call_takes_a_bounded_number_of_frames) {
  for (int i = 0; i < 2000; ++i) (void)peer_.send(frame_of(0x181, {}));
  const auto frames = transport_->receive(monotonic());
  ASSERT_TRUE(frames.ok());
  EXPECT_LE(frames.value().size(), 512U);
}

TEST_F(SocketCan, an_interface_that_goes_down_is_an_error_with_its_remedy) {
  bus_.down();
  const auto frames = transport_->receive(monotonic());
  ASSERT_FALSE(frames.ok());
  EXPECT_EQ(frames.error().code, ErrorCode::device);
  EXPECT_NE(frames.error().text().find("ip link set vcan0 up"), std::string::npos) << frames.error().text();
  EXPECT_FALSE(transport_->send(CanFrame{}).ok());
  EXPECT_FALSE(drivers::open_can("socketcan:vcan0").ok());
  bus_.up();
  transport_ = opened("socketcan:vcan0");
  const Peer peer("vcan0");
  ASSERT_TRUE(peer.send(frame_of(0x181, {1})));
  EXPECT_EQ(only_frame().id, 0x181U);
}

TEST_F(SocketCan, a_fall_of_the_interface_behind_queued_frames_is_not_forgotten) {
  ASSERT_TRUE(peer_.send(frame_of(0x181, {1})));
  bus_.remove();
  bool failed = false;
  for (int i = 0; i < 3 && !failed; ++i) failed = !transport_->receive(monotonic()).ok();
  EXPECT_TRUE(failed);
}

TEST_F(SocketCan, a_removed_interface_is_an_error_and_a_new_one_of_that_name_opens) {
  bus_.remove();
  const auto frames = transport_->receive(monotonic());
  ASSERT_FALSE(frames.ok());
  EXPECT_EQ(frames.error().code, ErrorCode::device);
  EXPECT_FALSE(transport_->receive(monotonic()).ok()) << "a dead socket must not look like a silent bus";
  bus_.create();
  transport_ = opened("socketcan:vcan0");
  const Peer peer("vcan0");
  ASSERT_TRUE(peer.send(frame_of(0x181, {1})));
  EXPECT_EQ(only_frame().id, 0x181U);
}

TEST_F(SocketCan, an_interface_that_is_no_can_bus_or_absent_is_named) {
  for (const char* name : {"lo", "can77", "a_name_that_is_too_long"}) {
    const auto transport = drivers::open_can(std::string("socketcan:") + name);
    ASSERT_FALSE(transport.ok()) << name;
    EXPECT_EQ(transport.error().code, ErrorCode::device);
    EXPECT_NE(transport.error().text().find(name), std::string::npos);
  }
}

// Two cards on one bus: a real controller driver, bit rate and interrupts at both ends.
class CardPair : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!cards_up()) GTEST_SKIP() << kNoCards;
  }
  void TearDown() override {
    ip("link set can0 down");
    ip("link set can1 down");
  }
};

TEST_F(CardPair, frames_cross_a_real_controller_driver_both_ways) {
  const auto here = opened("socketcan:can0");
  const auto there = opened("socketcan:can1");
  for (int i = 0; i < 100; ++i) {
    CanFrame frame;
    frame.id = 0x200U + static_cast<unsigned>(i);
    frame.length = static_cast<std::uint8_t>(i % 9);
    if (frame.length > 0) frame.data[0] = static_cast<std::uint8_t>(i);
    ASSERT_TRUE(here->send(frame).ok());
    const auto got = frames_from(*there, 1);
    ASSERT_EQ(got.size(), 1U) << i;
    EXPECT_EQ(got[0].id, frame.id);
    EXPECT_EQ(got[0].data, frame.data);
    ASSERT_TRUE(there->send(frame).ok());
    ASSERT_EQ(frames_from(*here, 1).size(), 1U) << i;
  }
}

TEST_F(CardPair, a_card_that_is_restarted_goes_on_with_a_new_socket) {
  auto here = opened("socketcan:can0");
  const auto there = opened("socketcan:can1");
  ip("link set can0 down");
  EXPECT_FALSE(here->receive(monotonic()).ok());
  ASSERT_EQ(ip("link set can0 up type can bitrate 500000"), 0);
  here = opened("socketcan:can0");
  CanFrame frame;
  frame.id = 0x181;
  ASSERT_TRUE(there->send(frame).ok());
  EXPECT_EQ(frames_from(*here, 1).size(), 1U);
}

}  // namespace
}  // namespace odomcalib::vm
