// The line to the controller when it does not take what is sent for a while.
#include "daemon/service/base_link.hpp"

#include <gtest/gtest.h>

#include "tests/sim/wires/pty.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::base_link_test {
namespace {

class Standing : public Clock {
 public:
  [[nodiscard]] double now() const override { return 1.0; }
  [[nodiscard]] std::int64_t wall_us() const override { return 0; }
};

TEST(BaseLink, a_buffer_that_was_full_once_is_no_problem_for_ever) {
  auto pty = std::move(sim::Pty::open()).value();
  auto link = value_of(
      BaseLink::create("serial:" + pty->path() + "?baud=57600", "drivers/base/profiles/ros_arduino.toml"));
  link.step(Standing());
  ASSERT_TRUE(link.connected());
  const auto send = [&link] {
    link.controller().quick_stop(1.0);
    link.flush();
  };
  for (int i = 0; i < 200'000 && !link.problem(); ++i) send();
  ASSERT_TRUE(link.problem());
  for (int i = 0; i < 10; ++i) (void)pty->read();
  send();
  EXPECT_FALSE(link.problem()) << link.problem()->text();
  EXPECT_EQ(link.reconnects(), 0U);
}

}  // namespace
}  // namespace odomcalib::base_link_test
