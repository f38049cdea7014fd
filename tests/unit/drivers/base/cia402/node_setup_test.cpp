// The set-up of a node by itself: answers to SDO requests in, requests and NMT commands out.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "drivers/base/cia402/node_setup.hpp"
#include "drivers/base/profile/profile.hpp"
#include "tests/unit/drivers/base/cia402/drive_bench.hpp"

namespace odomcalib::drivers::node_setup_test {
namespace {

using drive_bench::to_can;
using drive_bench::to_sim;
using Step = drivers::NodeSetup::Step;

class NodeSetup : public testing::Test {
 protected:
  NodeSetup() { node_.reset(0.0); }

  /// The last step that was more than none. The simulated drive answers.
  Step run(double duration) {
    Step last = Step::none;
    for (const double end = now_ + duration; now_ < end;) {
      now_ += drive_bench::kStep;
      node_.advance(now_, {});
      for (const sim::Frame& frame : node_.take_frames(now_)) sdo_.on_frame(to_can(frame, now_), now_);
      sdo_.on_time(now_);
      const Step step = setup_.ready() ? Step::none : setup_.advance(sdo_, seen_, now_);
      if (step != Step::none) last = step;
      send();
    }
    return last;
  }

  void send() {
    for (const CanFrame& frame : sdo_.take_frames()) out_.push_back(frame);
    for (const CanFrame& frame : out_) node_.receive(to_sim(frame), now_);
    sent_.insert(sent_.end(), out_.begin(), out_.end());
    out_.clear();
  }

  Profile profile_ = read_profile("drivers/base/profiles/sim-dual.toml").value();
  sim::DriveNode node_{{}};
  canopen::SdoClient sdo_{profile_.node};
  std::vector<CanFrame> out_, sent_;
  drivers::NodeSetup setup_{profile_, out_};
  drivers::NodeSetup::Seen seen_;
  double now_ = 0.0;
};

TEST_F(NodeSetup, asks_for_nobody_while_another_master_is_at_work) {
  seen_.other_master = true;
  EXPECT_EQ(run(1.0), Step::none);
  EXPECT_TRUE(sent_.empty());
  seen_.other_master = false;
  EXPECT_EQ(run(1.0), Step::configured);
}

TEST_F(NodeSetup, is_ready_when_the_node_runs_and_both_kinds_of_data_came) {
  ASSERT_EQ(run(1.0), Step::configured);
  EXPECT_TRUE(setup_.watchdog_armed());
  EXPECT_FALSE(setup_.as_set_up().empty());
  ASSERT_TRUE(setup_.identity());
  EXPECT_EQ(setup_.identity()->serial, 4242U);
  seen_ = {false, 0x05, true, false};
  EXPECT_EQ(run(0.1), Step::none);
  seen_.status = true;
  EXPECT_EQ(run(0.1), Step::running);
  EXPECT_TRUE(setup_.take_events().empty());
}

TEST_F(NodeSetup, says_what_stays_away_after_the_start) {
  ASSERT_EQ(run(1.0), Step::configured);
  seen_ = {false, 0x05, true, false};
  run(2.1);
  EXPECT_FALSE(setup_.started());
  const auto events = setup_.take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, "start_failed");
  EXPECT_NE(events[0].text.find("sends no status"), std::string::npos) << events[0].text;
}

TEST_F(NodeSetup, of_a_node_that_is_lost_its_watchdog_is_not_counted_on) {
  ASSERT_EQ(run(1.0), Step::configured);
  setup_.begin_again(now_, 0.5);
  EXPECT_FALSE(setup_.watchdog_armed());
  EXPECT_TRUE(setup_.identity()) << "who it was stays known";
  sent_.clear();
  run(0.4);
  EXPECT_TRUE(sent_.empty());
  EXPECT_EQ(run(1.5), Step::configured);
  EXPECT_TRUE(setup_.watchdog_armed());
}

}  // namespace
}  // namespace odomcalib::drivers::node_setup_test
