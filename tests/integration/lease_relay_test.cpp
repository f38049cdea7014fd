// A client in real time moves a robot whose time runs five times as fast (tests/demo).
#include "tests/demo/lease_relay.hpp"

#include "tests/integration/service_loop.hpp"

namespace odomcalib::lease_relay_test {
namespace {

constexpr double kHaste = 5.0;  // s of the service's time in a second of the client's

class RelayedClient : public ServiceLoop {
 protected:
  void SetUp() override {
    ServiceLoop::SetUp();
    auto relay = demo::LeaseRelay::create(folder_ / "front", folder_ / "control");
    ASSERT_TRUE(relay.ok()) << relay.error().text();
    relay_ = std::move(relay).value();
    mover_ = std::make_unique<TestClient>(folder_ / "front");
    keeper_ = std::make_unique<TestClient>(folder_ / "front");
  }
  /// The client renews every 30 ms of its own time where it is `alive`.
  template <typename Condition>
  bool hurry_until(Condition condition, double seconds, bool alive = true) {
    for (const double end = clock_.time + seconds; clock_.time < end;) {
      robot_->step(0.002);
      clock_.time += 0.002;
      real_ += 0.002 / kHaste;
      if (alive && !held_.empty() && real_ >= renewal_due_) {
        keeper_->call("Renew", {{"lease", held_}, {"sent", real_}});
        renewal_due_ = real_ + 0.03;
      }
      relay_->serve(real_, clock_.time);
      service_->poll_once(0);
      relay_->serve(real_, clock_.time);
      if (condition()) return true;
    }
    return false;
  }
  void drive() {
    keeper_->call("Acquire", json::object());
    std::optional<control::Reply> reply;
    ASSERT_TRUE(hurry_until([&] { return (reply = keeper_->reply()).has_value(); }, 5.0));
    held_ = json::parse(reply->parameters).value("lease", "");
    ASSERT_FALSE(held_.empty());
    mover_->call("Straight", {{"lease", held_}, {"distance", 1.0}}, true);
    ASSERT_TRUE(hurry_until([this] { return robot_->fastest_rim() > 0.15; }, 10.0))
        << service_->status_json();
  }

  std::unique_ptr<demo::LeaseRelay> relay_;
  std::unique_ptr<TestClient> mover_, keeper_;
  std::string held_;
  double real_ = 0.0, renewal_due_ = 0.0;
};

TEST_F(RelayedClient, drives_to_the_end_of_the_motion) {
  drive();
  EXPECT_TRUE(relay_->leased());
  std::optional<control::Reply> reply;
  ASSERT_TRUE(hurry_until([&] { return (reply = mover_->reply()).has_value(); }, 60.0))
      << service_->status_json();
  EXPECT_EQ(reply->error, "") << reply->parameters;
  EXPECT_EQ(json::parse(reply->parameters)["result"]["moves"].size(), 2U);
}

TEST_F(RelayedClient, that_falls_silent_lets_go_of_the_robot) {
  drive();
  ASSERT_TRUE(hurry_until([this] { return !relay_->leased(); }, 4.0, false));
  EXPECT_GT(robot_->fastest_rim(), 0.15);
  EXPECT_TRUE(hurry_until([this] { return robot_->fastest_rim() < 0.01; }, 2.0, false));
}

TEST_F(RelayedClient, that_hangs_up_lets_go_of_the_robot) {
  drive();
  keeper_->hang_up();
  held_.clear();
  EXPECT_TRUE(hurry_until([this] { return robot_->fastest_rim() < 0.01; }, 2.0));
  EXPECT_FALSE(relay_->leased());
}

}  // namespace
}  // namespace odomcalib::lease_relay_test
