// The slave's SDO server against the byte examples of CiA 301 and of real drives.
#include <gtest/gtest.h>

#include "tests/sim/wires/drive_node.hpp"

namespace odomcalib::sim::sdo_test {
namespace {

class Sdo : public testing::Test {
 protected:
  Sdo() : node({}) {
    node.advance(0.5, {});
    node.take_frames(0.5);
  }

  /// Sends one request and returns the answer's bytes; all zero when none came within a second.
  SdoBytes ask(std::initializer_list<int> bytes) {
    now += 0.01;
    node.receive(make_frame(0x601, bytes), now);
    for (const Frame& frame : node.take_frames(now + 1.0))
      if (frame.id == 0x581 && frame.length == 8) return frame.data;
    return {};
  }

  static SdoBytes bytes(std::initializer_list<int> list) { return make_frame(0, list).data; }

  DriveNode node;
  double now = 1.0;
};

TEST_F(Sdo, reads_the_status_word_as_four_bytes_like_the_real_drive) {
  EXPECT_EQ(ask({0x40, 0x41, 0x60, 0, 0, 0, 0, 0}), bytes({0x43, 0x41, 0x60, 0, 0x60, 0x14, 0x60, 0x14}));
}

TEST_F(Sdo, writes_two_bytes_and_confirms) {
  EXPECT_EQ(ask({0x2B, 0x17, 0x10, 0, 0xF4, 0x01, 0, 0}), bytes({0x60, 0x17, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x17, 0x10, 0, 0, 0, 0, 0}), bytes({0x4B, 0x17, 0x10, 0, 0xF4, 0x01, 0, 0}));
}

TEST_F(Sdo, reads_a_string_in_segments_with_alternating_toggle) {
  EXPECT_EQ(ask({0x40, 0x08, 0x10, 0, 0, 0, 0, 0}), bytes({0x41, 0x08, 0x10, 0, 16, 0, 0, 0}));
  EXPECT_EQ(ask({0x60, 0, 0, 0, 0, 0, 0, 0}), bytes({0x00, 'O', 'D', 'O', 'M', 'C', 'A', 'L'}));
  EXPECT_EQ(ask({0x70, 0, 0, 0, 0, 0, 0, 0}), bytes({0x10, 'I', 'B', '-', 'S', 'I', 'M', '-'}));
  EXPECT_EQ(ask({0x60, 0, 0, 0, 0, 0, 0, 0}), bytes({0x0B, '2', 'X', 0, 0, 0, 0, 0}));
}

TEST_F(Sdo, aborts_a_wrong_toggle) {
  ask({0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask({0x70, 0, 0, 0, 0, 0, 0, 0}), bytes({0x80, 0x08, 0x10, 0, 0, 0, 0x03, 0x05}));
}

TEST_F(Sdo, aborts_what_cannot_be_done_with_the_standard_codes) {
  EXPECT_EQ(ask({0x40, 0x72, 0x60, 0, 0, 0, 0, 0}), bytes({0x80, 0x72, 0x60, 0, 0, 0, 0x02, 0x06}));
  EXPECT_EQ(ask({0x40, 0x18, 0x10, 9, 0, 0, 0, 0}), bytes({0x80, 0x18, 0x10, 9, 0x11, 0, 0x09, 0x06}));
  EXPECT_EQ(ask({0x23, 0x18, 0x10, 1, 1, 0, 0, 0}), bytes({0x80, 0x18, 0x10, 1, 0x02, 0, 0x01, 0x06}));
  EXPECT_EQ(ask({0x2F, 0x17, 0x10, 0, 1, 0, 0, 0}), bytes({0x80, 0x17, 0x10, 0, 0x10, 0, 0x07, 0x06}));
  EXPECT_EQ(ask({0xA0, 0x08, 0x10, 0, 0, 0, 0, 0}), bytes({0x80, 0x08, 0x10, 0, 0x01, 0, 0x04, 0x05}));
}

TEST_F(Sdo, takes_the_type_for_a_write_without_size) {
  EXPECT_EQ(ask({0x22, 0x17, 0x10, 0, 0x64, 0, 0, 0})[0], 0x60);
  EXPECT_EQ(node.dictionary().value({0x1017, 0}), 100U);
}

TEST_F(Sdo, takes_a_segmented_write) {
  EXPECT_EQ(ask({0x21, 0x00, 0x21, 1, 4, 0, 0, 0}), bytes({0x60, 0x00, 0x21, 1, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0x07, 0x40, 0x42, 0x0F, 0, 0, 0, 0}), bytes({0x20, 0, 0, 0, 0, 0, 0, 0}));  // 1 000 000 um
  EXPECT_EQ(node.geometry_in_ram()[0], 1'000'000U);
}

TEST_F(Sdo, geometry_outside_1_mm_to_10_m_is_refused_and_the_bounds_are_taken) {
  const auto write = [this](std::uint32_t um) {
    const auto byte = [um](unsigned i) { return static_cast<int>(um >> (8 * i) & 0xFFU); };
    return ask({0x23, 0x00, 0x21, 3, byte(0), byte(1), byte(2), byte(3)});
  };
  EXPECT_EQ(write(999), bytes({0x80, 0x00, 0x21, 3, 0x30, 0, 0x09, 0x06}));
  EXPECT_EQ(write(10'000'001), bytes({0x80, 0x00, 0x21, 3, 0x30, 0, 0x09, 0x06}));
  EXPECT_EQ(write(1000)[0], 0x60);
  EXPECT_EQ(write(10'000'000)[0], 0x60);
}

TEST_F(Sdo, what_is_not_stored_is_gone_after_a_reset_and_what_is_stored_stays) {
  ask({0x23, 0x00, 0x21, 1, 0x40, 0x42, 0x0F, 0});
  node.reset(now);
  node.advance(now + 0.5, {});
  EXPECT_EQ(node.geometry_in_ram()[0], 150'000U);
  ask({0x23, 0x00, 0x21, 1, 0x40, 0x42, 0x0F, 0});
  EXPECT_EQ(ask({0x23, 0x10, 0x10, 1, 0x73, 0x61, 0x76, 0x65})[0], 0x60);
  node.reset(now);
  node.advance(now + 1.0, {});
  EXPECT_EQ(node.geometry_in_ram()[0], 1'000'000U);
  EXPECT_EQ(node.store_count(), 1U);
}

TEST_F(Sdo, storing_takes_its_time_and_needs_the_signature) {
  node.receive(make_frame(0x601, {0x23, 0x10, 0x10, 1, 0x73, 0x61, 0x76, 0x65}), 5.0);
  EXPECT_TRUE(node.take_frames(5.049).empty());
  EXPECT_EQ(node.take_frames(5.051).size(), 1U);
  EXPECT_EQ(ask({0x23, 0x10, 0x10, 1, 0x73, 0x61, 0x76, 0x66}),
            bytes({0x80, 0x10, 0x10, 1, 0x20, 0, 0, 0x08}));
}

TEST_F(Sdo, faults_are_planned_per_object) {
  node.sdo_faults().abort_on_write[{0x2100, 2}] = abort_code::kHardware;
  EXPECT_EQ(ask({0x23, 0x00, 0x21, 2, 0x40, 0x42, 0x0F, 0}), bytes({0x80, 0x00, 0x21, 2, 0, 0, 0x06, 0x06}));
  EXPECT_EQ(ask({0x23, 0x00, 0x21, 1, 0x40, 0x42, 0x0F, 0})[0], 0x60);
  node.sdo_faults().read_back[{0x2100, 1}] = 7;
  EXPECT_EQ(ask({0x40, 0x00, 0x21, 1, 0, 0, 0, 0}), bytes({0x43, 0x00, 0x21, 1, 7, 0, 0, 0}));
  node.faults.store_is_lost = true;
  EXPECT_EQ(ask({0x23, 0x10, 0x10, 1, 0x73, 0x61, 0x76, 0x65})[0], 0x60);
  EXPECT_EQ(node.geometry_stored()[0], 150'000U);
  node.sdo_faults().silent = true;
  EXPECT_EQ(ask({0x40, 0x41, 0x60, 0, 0, 0, 0, 0}), SdoBytes{});
}

TEST_F(Sdo, a_stopped_node_does_not_answer) {
  node.receive(make_frame(0, {0x02, 1}), now);
  EXPECT_EQ(ask({0x40, 0x41, 0x60, 0, 0, 0, 0, 0}), SdoBytes{});
}

}  // namespace
}  // namespace odomcalib::sim::sdo_test
