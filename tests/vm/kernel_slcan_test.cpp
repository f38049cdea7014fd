// Carrier loss, error counters and a queue that fills up: the kernel's slcan driver, whose adapter is the
// test.
#include <linux/can/error.h>

#include <array>
#include <ctime>

#include "drivers/base/controller.hpp"
#include "tests/vm/can_bench.hpp"

namespace odomcalib::vm {
namespace {

using drivers::CanFrame;

class KernelSlcanBus : public ::testing::Test {
 protected:
  void open_up(const std::string& options = "") {
    adapter_.up(options);
    transport_ = opened("socketcan:" + adapter_.interface());
    ASSERT_NE(transport_, nullptr);
    (void)adapter_.heard();
  }
  /// The first error frame with one of these class bits.
  std::optional<CanFrame> error_frame(canid_t classes) {
    std::optional<CanFrame> found;
    wait_until(
        [&] {
          const auto frames = transport_->receive(monotonic());
          if (!frames) return true;
          for (const CanFrame& frame : frames.value())
            if (frame.error && (frame.id & classes) != 0) found = frame;
          return found.has_value();
        },
        1.0);
    return found;
  }
  static CanFrame some_frame() {
    CanFrame frame;
    frame.id = 0x201;
    frame.length = 8;
    return frame;
  }

  KernelSlcan adapter_;
  std::unique_ptr<drivers::CanTransport> transport_;
};

TEST_F(KernelSlcanBus, frames_go_both_ways) {
  ASSERT_NO_FATAL_FAILURE(open_up());
  adapter_.say("t18140A0B0C0D");
  const auto frames = frames_from(*transport_, 1);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].id, 0x181U);
  EXPECT_EQ(frames[0].data[3], 0x0D);
  CanFrame frame = some_frame();
  frame.length = 2;
  ASSERT_TRUE(transport_->send(frame).ok());
  std::string heard;
  EXPECT_TRUE(
      wait_until([&] { return (heard += adapter_.heard()).find("t20120000\r") != std::string::npos; }, 1.0))
      << heard;
}

TEST_F(KernelSlcanBus, warning_passive_and_recovery_arrive_as_error_frames) {
  ASSERT_NO_FATAL_FAILURE(open_up());
  adapter_.say("sw097000");
  EXPECT_TRUE(error_frame(CAN_ERR_CRTL).has_value());
  adapter_.say("sp130010");
  const auto passive = error_frame(CAN_ERR_CRTL);
  ASSERT_TRUE(passive.has_value());
  EXPECT_NE(passive->data[1] & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE), 0);
  adapter_.say("sa000000");
  EXPECT_TRUE(error_frame(CAN_ERR_CRTL).has_value());
}

TEST_F(KernelSlcanBus, a_missing_acknowledgement_arrives_as_an_error_frame) {
  ASSERT_NO_FATAL_FAILURE(open_up());
  adapter_.say("e1a");
  EXPECT_TRUE(error_frame(CAN_ERR_ACK | CAN_ERR_PROT).has_value());
}

TEST_F(KernelSlcanBus, bus_off_is_told_sending_fails_and_down_and_up_heals) {
  ASSERT_NO_FATAL_FAILURE(open_up());
  adapter_.say("sb255000");
  ASSERT_TRUE(error_frame(CAN_ERR_BUSOFF).has_value());
  EXPECT_EQ(transport_->counters().at("bus_off"), 1U);
  EXPECT_TRUE(wait_until([&] { return !transport_->send(some_frame()).ok(); }, 1.0))
      << "frames are taken for a bus that is off";
  EXPECT_FALSE(drivers::open_can("socketcan:" + adapter_.interface()).ok())
      << "an interface without carrier opens";
  adapter_.down();
  EXPECT_FALSE(transport_->receive(monotonic()).ok());
  ASSERT_NO_FATAL_FAILURE(open_up());
  EXPECT_TRUE(wait_until([&] { return transport_->send(some_frame()).ok(); }, 1.0));
  adapter_.say("t1810");
  EXPECT_EQ(frames_from(*transport_, 1).size(), 1U);
}

TEST_F(KernelSlcanBus, nothing_sent_during_bus_off_comes_out_after_the_restart) {
  ASSERT_NO_FATAL_FAILURE(open_up());
  adapter_.say("sb255000");
  ASSERT_TRUE(error_frame(CAN_ERR_BUSOFF).has_value());
  for (int i = 0; i < 20; ++i) (void)transport_->send(some_frame());
  adapter_.down();
  ASSERT_NO_FATAL_FAILURE(open_up());
  EXPECT_FALSE(wait_until([&] { return adapter_.heard().find("t201") != std::string::npos; }, 0.2));
}

TEST_F(KernelSlcanBus, an_adapter_that_nobody_serves_fills_the_queue_without_blocking) {
  ASSERT_NO_FATAL_FAILURE(open_up("txqueuelen 10"));
  adapter_.deaf(true);
  const double begin = monotonic();
  std::uint64_t refused = 0;
  for (int i = 0; i < 5000; ++i) refused += transport_->send(some_frame()).ok() ? 0 : 1;
  EXPECT_LT(monotonic() - begin, 5.0);
  EXPECT_GT(refused, 0U);
  EXPECT_EQ(transport_->counters().at("send_failed"), refused);
  EXPECT_EQ(transport_->counters().at("frames_sent"), 5000 - refused);
}

TEST_F(KernelSlcanBus, a_pulled_plug_is_an_error_that_costs_no_processor_time) {
  ASSERT_NO_FATAL_FAILURE(open_up());
  adapter_.unplug();
  EXPECT_TRUE(wait_until([&] { return !transport_->receive(monotonic()).ok(); }, 1.0));
  const std::clock_t before = std::clock();
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(transport_->receive(monotonic()).ok());
  EXPECT_LT(std::clock() - before, CLOCKS_PER_SEC / 10);
}

TEST_F(KernelSlcanBus, garbage_from_the_adapter_makes_no_frames) {
  ASSERT_NO_FATAL_FAILURE(open_up());
  adapter_.say("t18190102");  // length 9
  adapter_.say("tXYZ0");      // no digits
  adapter_.say("t181");       // cut off
  adapter_.say("t18110Q");    // half a byte
  adapter_.say("t1811AA");    // the only frame
  const auto frames = frames_from(*transport_, 2, 0.3);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].data[0], 0xAA);
}

}  // namespace
}  // namespace odomcalib::vm
