// The process data of a node by themselves: PDOs in, PDOs, counts and events out.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "drivers/base/cia402/process_data.hpp"
#include "drivers/base/profile/profile.hpp"

namespace odomcalib::drivers::process_data_test {
namespace {

constexpr std::uint32_t kBothEnabled = 0x00270027, kLeftEnabled = 0x00400027;

class ProcessData : public testing::Test {
 protected:
  void receive(std::uint32_t id, std::uint32_t first, std::uint32_t second, bool expected = true) {
    CanFrame frame;
    frame.id = id;
    frame.length = 8;
    frame.t = now_;
    for (unsigned byte = 0; byte < 4; ++byte) {
      frame.data[byte] = static_cast<std::uint8_t>(first >> (8 * byte));
      frame.data[4 + byte] = static_cast<std::uint8_t>(second >> (8 * byte));
    }
    for (const canopen::Pdo& pdo : profile_.pdos)
      if (pdo.cob_id == id) data_.on_frame(pdo, frame, expected, now_);
  }
  void counts(std::uint32_t left, std::uint32_t right, bool expected = true) {
    receive(0x181, left, right, expected);
  }
  void status(std::uint32_t both, bool expected = true) { receive(0x281, both, 0, expected); }

  /// Torque is wanted, and the axes follow.
  void enabled() {
    counts(0, 0);
    data_.enable("", now_);
    status(kBothEnabled);
    now_ += 0.02;
    counts(0, 0);
    data_.cycle(false, now_);
    out_.clear();
  }

  Profile profile_ = read_profile("drivers/base/profiles/sim-dual.toml").value();
  std::vector<CanFrame> out_;
  drivers::ProcessData data_{profile_, out_};
  double now_ = 1.0;
};

TEST_F(ProcessData, mean_nothing_before_the_mapping_is_ours) {
  counts(0, 0, false);
  status(kBothEnabled, false);
  EXPECT_FALSE(data_.has_positions());
  EXPECT_FALSE(data_.has_status());
  EXPECT_FALSE(data_.any_axis(canopen::DriveState::enabled));
  EXPECT_TRUE(data_.take_ticks().empty());
  EXPECT_EQ(data_.used(), 2U);
}

TEST_F(ProcessData, a_target_goes_before_the_control_word_that_lets_it_work) {
  enabled();
  ASSERT_EQ(data_.motion().motion(), Motion::on);
  ASSERT_TRUE(data_.command(1.0, 1.0, now_));
  now_ += 0.02;
  counts(0, 0);
  data_.cycle(false, now_);
  ASSERT_EQ(out_.size(), 2U);
  EXPECT_EQ(out_[0].id, 0x301U);
  EXPECT_NE(out_[0].data[0], 0U);
  EXPECT_EQ(out_[1].id, 0x201U);
}

TEST_F(ProcessData, what_the_rest_of_the_node_refuses_gets_no_torque) {
  data_.enable("not configured", now_);
  EXPECT_FALSE(data_.motion().active());
  EXPECT_TRUE(out_.empty());
  const auto events = data_.take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].text, "not configured");
}

TEST_F(ProcessData, torque_that_was_not_asked_for_is_taken_away_unless_it_is_anothers) {
  status(kBothEnabled);
  data_.cycle(true, now_);
  EXPECT_TRUE(out_.empty());
  now_ += 1.0;
  data_.cycle(false, now_);
  EXPECT_FALSE(out_.empty());
}

TEST_F(ProcessData, an_axis_that_loses_its_torque_stops_the_other) {
  enabled();
  status(kLeftEnabled);
  EXPECT_EQ(data_.motion().motion(), Motion::stopping);
  const auto events = data_.take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, "axis_not_enabled");
  EXPECT_TRUE(events[0].stop);
}

TEST_F(ProcessData, a_node_that_begins_anew_has_no_data_yet) {
  enabled();
  data_.forget();
  EXPECT_FALSE(data_.has_positions());
  EXPECT_FALSE(data_.motion().active());
  data_.take_ticks();
  counts(5, 5);
  counts(5, 5);
  for (const TickSample& tick : data_.take_ticks()) EXPECT_EQ(tick.segment, 1);
}

}  // namespace
}  // namespace odomcalib::drivers::process_data_test
