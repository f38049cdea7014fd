// The slave as a CiA 402 drive: life signs, PDOs, state machine, reactions.
#include "tests/sim/wires/drive_node.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace odomcalib::sim::drive_node_test {
namespace {

class Drive : public testing::Test {
 protected:
  Drive() : node({}) { run(0.5); }

  /// Advances in milliseconds and keeps what the node sent.
  void run(double seconds) {
    for (const double end = now + seconds; now < end - 1e-9;) {
      now += 0.001;
      node.advance(now, wheels);
      for (const Frame& frame : node.take_frames(now)) sent.push_back({now, frame});
    }
  }
  void send(std::uint32_t id, std::initializer_list<int> bytes) { node.receive(make_frame(id, bytes), now); }
  void start() { send(0x000, {1, 1}); }
  void control(int word) { send(0x201, {word & 0xFF, word >> 8}); }
  void enable() {
    start();
    node.dictionary().write({0x6060, 0}, std::array<std::uint8_t, 1>{3});
    for (const int word : {6, 7, 15}) control(word);
  }
  std::uint32_t status() { return node.dictionary().value({0x6041, 0}); }
  AbortCode write(ObjectKey key, std::uint32_t value) {
    std::array<std::uint8_t, 4> bytes{};
    const unsigned size = node.dictionary().find(key)->bytes;
    put_u32(bytes.data(), size, value);
    return node.dictionary().write(key, std::span(bytes).first(size));
  }
  std::vector<std::pair<double, Frame>> all(std::uint32_t id) const {
    std::vector<std::pair<double, Frame>> out;
    for (const auto& item : sent)
      if (item.second.id == id) out.push_back(item);
    return out;
  }

  double now = 0.0;
  WheelState wheels;
  DriveNode node;
  std::vector<std::pair<double, Frame>> sent;
};

TEST_F(Drive, says_boot_up_once_and_no_heartbeat_by_default) {
  ASSERT_EQ(all(0x701).size(), 1U);
  EXPECT_EQ(all(0x701)[0].second, make_frame(0x701, {0}));
  run(1.0);
  EXPECT_EQ(all(0x701).size(), 1U);
}

TEST_F(Drive, sends_heartbeats_with_its_state_at_the_period) {
  write({0x1017, 0}, 100);
  sent.clear();
  run(1.0);
  EXPECT_NEAR(static_cast<double>(all(0x701).size()), 10.0, 1.0);
  EXPECT_EQ(all(0x701).back().second.data[0], 0x7F);
  start();
  run(0.2);
  EXPECT_EQ(all(0x701).back().second.data[0], 0x05);
  node.faults.heartbeat_stopped = true;
  sent.clear();
  run(1.0);
  EXPECT_TRUE(all(0x701).empty());
}

TEST_F(Drive, sends_no_pdo_before_it_is_started) {
  run(0.5);
  EXPECT_TRUE(all(0x181).empty());
  start();
  run(0.5);
  EXPECT_EQ(all(0x181).size(), 25U);
  EXPECT_EQ(all(0x281).size(), 10U);
  EXPECT_EQ(all(0x181)[0].second.length, 8);
}

TEST_F(Drive, positions_are_32_bit_little_endian_left_first_and_wrap) {
  wheels.counts = {0x80000000LL + 2, -3};
  start();
  run(0.03);
  EXPECT_EQ(all(0x181).back().second, make_frame(0x181, {2, 0, 0, 0x80, 0xFD, 0xFF, 0xFF, 0xFF}));
}

TEST_F(Drive, walks_through_the_states_of_cia_402_with_the_real_drives_words) {
  start();
  EXPECT_EQ(status() & 0xFFFFU, 0x1460U);
  control(6);
  EXPECT_EQ(status() & 0xFFFFU, 0x1421U);
  control(15);  // not allowed from here
  EXPECT_EQ(status() & 0xFFFFU, 0x1421U);
  control(7);
  EXPECT_EQ(status() & 0x6FU, 0x23U);
  control(15);
  EXPECT_EQ(status(), 0x14271427U);
  control(2);
  EXPECT_EQ(status() & 0x6FU, 0x07U);
  control(15);
  EXPECT_EQ(status() & 0x6FU, 0x27U);
  control(0);
  EXPECT_EQ(status() & 0x4FU, 0x40U);
}

TEST_F(Drive, control_words_in_pre_operational_are_not_heard_by_pdo) {
  control(6);
  EXPECT_EQ(status() & 0x6FU, 0x60U & 0x6FU);
}

TEST_F(Drive, targets_are_hundredths_of_rpm_and_act_only_when_enabled) {
  start();
  write({0x6060, 0}, 3);
  send(0x301, {0x70, 0x17, 0, 0, 0x90, 0xE8, 0xFF, 0xFF});  // 60 rpm, -60 rpm
  EXPECT_FALSE(node.order().torque);
  for (const int word : {6, 7, 15}) control(word);
  EXPECT_TRUE(node.order().torque);
  EXPECT_NEAR(node.order().rate[0], 2.0 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(node.order().rate[1], -2.0 * std::numbers::pi, 1e-9);
}

TEST_F(Drive, without_profile_velocity_mode_the_wheels_stand) {
  start();
  send(0x301, {0x70, 0x17, 0, 0, 0x70, 0x17, 0, 0});
  for (const int word : {6, 7, 15}) control(word);
  EXPECT_TRUE(node.order().torque);
  EXPECT_EQ(node.order().rate[0], 0.0);
}

TEST_F(Drive, actual_speed_is_tenths_of_rpm) {
  wheels.rate = {2.0 * std::numbers::pi, -2.0 * std::numbers::pi};
  run(0.001);
  EXPECT_EQ(node.dictionary().value({0x606C, 1}), 600U);
  EXPECT_EQ(static_cast<std::int32_t>(node.dictionary().value({0x606C, 2})), -600);
}

TEST_F(Drive, geometry_and_store_are_refused_while_enabled) {
  enable();
  EXPECT_EQ(write({0x2100, 1}, 150'100), abort_code::kState);
  EXPECT_EQ(write({0x1010, 1}, 0x65766173), abort_code::kState);
  control(0);
  EXPECT_EQ(write({0x2100, 1}, 150'100), abort_code::kNone);
  EXPECT_EQ(write({0x1010, 1}, 0x65766173), abort_code::kNone);
}

TEST_F(Drive, reacts_to_a_silent_master_as_6007_says) {
  for (const auto& [option, state] : {std::pair{0U, DriveState::operation_enabled},
                                      {1U, DriveState::fault},
                                      {2U, DriveState::switch_on_disabled},
                                      {3U, DriveState::quick_stop_active}}) {
    node.reset(now);
    run(0.5);
    write({0x6007, 0}, option);
    write({0x1029, 1}, 1);           // and it stays operational
    write({0x1016, 1}, 0x007F00C8);  // node 127, 200 ms
    enable();
    run(1.0);
    EXPECT_EQ(node.drive_state(), DriveState::operation_enabled)
        << "monitoring starts with the first heartbeat";
    for (int i = 0; i < 10; ++i) {
      send(0x77F, {5});
      run(0.1);
    }
    EXPECT_EQ(node.drive_state(), DriveState::operation_enabled);
    sent.clear();
    run(0.09);
    EXPECT_TRUE(all(0x081).empty());
    run(0.02);
    ASSERT_EQ(all(0x081).size(), 1U);
    EXPECT_EQ(all(0x081)[0].second.data[0], 0x30);
    EXPECT_EQ(all(0x081)[0].second.data[1], 0x81);
    EXPECT_EQ(node.drive_state(), state) << "6007h = " << option;
  }
}

TEST_F(Drive, leaves_operational_when_the_master_falls_silent_as_1029_says) {
  for (const auto& [behaviour, state] :
       {std::pair{0, NmtState::pre_operational}, {1, NmtState::operational}, {2, NmtState::stopped}}) {
    write({0x1029, 1}, static_cast<std::uint32_t>(behaviour));
    write({0x1016, 1}, 0x007F0064);
    start();
    send(0x77F, {5});
    run(0.09);
    EXPECT_EQ(node.nmt_state(), NmtState::operational);
    run(0.02);
    EXPECT_EQ(node.nmt_state(), state) << behaviour;
    node.reset(now);
    run(0.5);
  }
}

TEST_F(Drive, a_fault_is_left_only_by_a_rising_edge_of_bit_7) {
  enable();
  node.emergency(0x2310, 0x03, now);
  run(0.01);
  EXPECT_EQ(status() & 0x4FU, 0x08U);
  EXPECT_EQ(all(0x081).back().second, make_frame(0x081, {0x10, 0x23, 0x03, 0, 0, 0, 0, 0}));
  control(15);
  EXPECT_EQ(status() & 0x4FU, 0x08U);
  control(0x80);
  run(0.01);
  EXPECT_EQ(status() & 0x4FU, 0x40U);
  EXPECT_EQ(all(0x081).back().second, make_frame(0x081, {0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST_F(Drive, mapping_changes_only_in_the_prescribed_order) {
  EXPECT_EQ(write({0x1A00, 0}, 0), abort_code::kState) << "while the PDO is valid";
  EXPECT_EQ(write({0x1800, 1}, 0x80000181), abort_code::kNone);
  EXPECT_EQ(write({0x1A00, 1}, 0x606C0120), abort_code::kState) << "while the count is not zero";
  EXPECT_EQ(write({0x1A00, 0}, 0), abort_code::kNone);
  EXPECT_EQ(write({0x1A00, 1}, 0x606C0120), abort_code::kNone);
  EXPECT_EQ(write({0x1A00, 2}, 0x10000020), abort_code::kNotMappable);
  EXPECT_EQ(write({0x1A00, 2}, 0x77770020), abort_code::kNoObject);
  EXPECT_EQ(write({0x1A00, 2}, 0x60410020), abort_code::kNone);
  EXPECT_EQ(write({0x1A00, 3}, 0x60600008), abort_code::kNone);
  EXPECT_EQ(write({0x1A00, 0}, 3), abort_code::kPdoTooLong);
  EXPECT_EQ(write({0x1A00, 0}, 2), abort_code::kNone);
  EXPECT_EQ(write({0x1800, 5}, 5), abort_code::kNone);
  EXPECT_EQ(write({0x1800, 1}, 0x181), abort_code::kNone);
  start();
  EXPECT_EQ(write({0x1800, 1}, 0x80000181), abort_code::kState) << "in operational";
  wheels.rate = {2.0 * std::numbers::pi, 0.0};
  run(0.1);
  EXPECT_EQ(all(0x181).size(), 20U);
  EXPECT_EQ(all(0x181).back().second.data[0], 0x58);
  EXPECT_EQ(all(0x181).back().second.data[1], 0x02);
}

TEST_F(Drive, a_pdo_of_type_1_follows_sync) {
  write({0x1800, 1}, 0x80000181);
  write({0x1800, 2}, 1);
  write({0x1800, 1}, 0x181);
  start();
  run(0.2);
  EXPECT_TRUE(all(0x181).empty());
  for (int i = 0; i < 3; ++i) {
    send(0x080, {});
    run(0.01);
  }
  EXPECT_EQ(all(0x181).size(), 3U);
}

TEST_F(Drive, a_short_receive_pdo_is_discarded_with_an_emergency) {
  enable();
  send(0x301, {0x70, 0x17, 0, 0, 0x70, 0x17, 0});
  run(0.002);
  EXPECT_EQ(node.order().rate[0], 0.0);
  ASSERT_EQ(all(0x081).size(), 1U);
  EXPECT_EQ(all(0x081)[0].second.data[0], 0x10);
  EXPECT_EQ(all(0x081)[0].second.data[1], 0x82);
}

TEST_F(Drive, frozen_pdos_go_on_with_old_content_and_silent_ones_stop) {
  start();
  wheels.counts = {100, 100};
  run(0.1);
  node.faults.pdo_frozen = true;
  wheels.counts = {200, 200};
  sent.clear();
  run(0.1);
  EXPECT_EQ(all(0x181).size(), 5U);
  EXPECT_EQ(all(0x181).back().second.data[0], 100);
  node.faults.pdo_silent = true;
  sent.clear();
  run(0.1);
  EXPECT_TRUE(all(0x181).empty());
}

TEST_F(Drive, reset_boots_again_without_torque_and_with_counters_at_zero) {
  enable();
  wheels.counts = {500, 700};
  run(0.1);
  send(0x000, {0x81, 1});
  sent.clear();
  run(0.3);
  EXPECT_EQ(all(0x701).size(), 1U);
  EXPECT_EQ(node.nmt_state(), NmtState::pre_operational);
  EXPECT_EQ(node.drive_state(), DriveState::switch_on_disabled);
  EXPECT_FALSE(node.order().torque);
  EXPECT_EQ(node.dictionary().value({0x6064, 1}), 0U);
  EXPECT_EQ(node.dictionary().value({0x6060, 0}), 0U) << "the mode is forgotten";
}

TEST_F(Drive, commands_to_another_node_are_not_obeyed) {
  send(0x000, {1, 2});
  EXPECT_EQ(node.nmt_state(), NmtState::pre_operational);
  send(0x000, {1, 0});
  EXPECT_EQ(node.nmt_state(), NmtState::operational);
}

}  // namespace
}  // namespace odomcalib::sim::drive_node_test
