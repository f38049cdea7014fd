// LCM and a network that takes nothing for a while: the loop does not wait for it, the newest messages are
// kept, and what is lost is counted.
#include "daemon/service/publisher.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "daemon/service/settings.hpp"

namespace odomcalib::publisher_test {
namespace {

using std::chrono::steady_clock;
namespace settings = service::settings;

/// Messages that arrived, and whether the network holds up whoever sends.
struct Network {
  std::atomic<bool> stalls = false;
  std::atomic<int> held = 0;  // messages that have come to it
  std::mutex mutex;
  std::vector<std::string> channels, messages;

  std::vector<std::string> arrived() {
    const std::scoped_lock lock(mutex);
    return messages;
  }
};

class OutletTo final : public Outlet {
 public:
  explicit OutletTo(std::shared_ptr<Network> network) : network_(std::move(network)) {}
  bool publish(const std::string& channel, const std::string& message) override {
    ++network_->held;
    while (network_->stalls) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const std::scoped_lock lock(network_->mutex);
    network_->channels.push_back(channel);
    network_->messages.push_back(message);
    return true;
  }

 private:
  std::shared_ptr<Network> network_;
};

bool comes_true(const std::function<bool()>& condition) {
  for (int i = 0; i < 20'000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return condition();
}

double seconds_since(steady_clock::time_point begin) {
  return std::chrono::duration<double>(steady_clock::now() - begin).count();
}

/// s of the processor that this thread has had: other programs do not count.
double processor_time() {
  timespec spent{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}

class OnSlowNetwork : public ::testing::Test {
 protected:
  OnSlowNetwork()
      : publisher_(std::make_unique<Publisher>("udpm://", "P_", [network = network_](const std::string&) {
          return std::make_unique<OutletTo>(network);
        })) {}
  void TearDown() override {
    network_->stalls = false;
    publisher_.reset();
  }
  /// The first message is on its way and does not arrive.
  void stall() {
    network_->stalls = true;
    publisher_->send("TICKS", "first");
    ASSERT_TRUE(comes_true([this] { return network_->held == 1; }));
  }
  std::vector<std::string> arrive(std::size_t count) {
    network_->stalls = false;
    EXPECT_TRUE(comes_true([&] { return network_->arrived().size() == count; })) << network_->held;
    return network_->arrived();
  }

  std::shared_ptr<Network> network_ = std::make_shared<Network>();
  std::unique_ptr<Publisher> publisher_;
};

// If one call waited for the network, this test would never end.
TEST_F(OnSlowNetwork, nobody_waits_and_the_newest_messages_are_kept_in_their_order) {
  stall();
  constexpr std::size_t kMessages = 20'000;
  const double begin = processor_time();
  for (std::size_t i = 0; i < kMessages; ++i) publisher_->send("TICKS", std::to_string(i));
  EXPECT_LT(processor_time() - begin, 2.0);
  EXPECT_EQ(publisher_->counters().sent, 0U);
  EXPECT_EQ(publisher_->counters().dropped, kMessages - settings::kMostUnsent);
  const auto arrived = arrive(1 + settings::kMostUnsent);
  EXPECT_EQ(arrived[0], "first");
  for (std::size_t i = 0; i < settings::kMostUnsent; ++i)
    ASSERT_EQ(arrived[1 + i], std::to_string(kMessages - settings::kMostUnsent + i));
  EXPECT_TRUE(comes_true([this] { return publisher_->counters().sent == 1 + settings::kMostUnsent; }));
  EXPECT_EQ(network_->channels[0], "P_TICKS");
}

TEST_F(OnSlowNetwork, large_messages_are_bounded_by_their_bytes) {
  stall();
  const std::string scan(settings::kMostUnsent_bytes / 4, 's');
  for (int i = 0; i < 10; ++i) publisher_->send("SCAN", scan);
  EXPECT_EQ(publisher_->counters().dropped, 6U);
  publisher_->send("RESULT", std::string(2 * settings::kMostUnsent_bytes, 'r'));
  EXPECT_EQ(publisher_->counters().dropped, 10U) << "all others make room for it";
  EXPECT_EQ(arrive(2).back().front(), 'r');
}

TEST_F(OnSlowNetwork, the_end_waits_for_nobody) {
  stall();
  publisher_->send("TICKS", "second");
  const auto begin = steady_clock::now();
  publisher_.reset();
  EXPECT_LT(seconds_since(begin), 2.0);
  network_->stalls = false;
  EXPECT_TRUE(comes_true([this] { return network_.use_count() == 1; })) << "the thread has not ended";
  EXPECT_EQ(network_->arrived().size(), 1U) << "nothing is sent after the end";
}

TEST_F(OnSlowNetwork, what_waits_leaves_before_the_end_where_the_network_takes_it) {
  for (int i = 0; i < 100; ++i) publisher_->send("TICKS", std::to_string(i));
  publisher_.reset();
  EXPECT_EQ(network_->arrived().size(), 100U);
}

// At start the network may not be up; the service must not have to be restarted for it.
TEST(Publisher, that_could_not_be_opened_is_opened_later) {
  std::atomic<int> tries = 0;
  const auto network = std::make_shared<Network>();
  Publisher publisher("udpm://", "P_", [&, network](const std::string&) -> std::unique_ptr<Outlet> {
    if (++tries < 3) return nullptr;
    return std::make_unique<OutletTo>(network);
  });
  const auto told = [&publisher] { return publisher.counters().failed + publisher.counters().sent; };
  EXPECT_TRUE(comes_true([&publisher] { return publisher.refused() == "udpm://"; }));
  std::uint64_t given = 0;
  for (double now = 100.0; now < 120.0; now += 1.0) {
    publisher.serve(now);
    publisher.send("TICKS", "bytes");
    ++given;
    ASSERT_TRUE(comes_true([&] { return told() == given; }));
  }
  EXPECT_EQ(tries, 3);
  EXPECT_EQ(publisher.refused(), "");
  EXPECT_EQ(publisher.counters().failed, 10U);
  EXPECT_EQ(publisher.counters().sent, 10U);
}

}  // namespace
}  // namespace odomcalib::publisher_test
