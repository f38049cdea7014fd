// Work beside the loop: in order, one after the other, and the loop hears of it only when it asks.
#include "daemon/service/disk_worker.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <future>
#include <string>
#include <thread>
#include <vector>

namespace {

// The thread is put aside by the scheduler before it signals, until it is let go.
std::atomic<bool> put_aside = false;
std::atomic<int> signals_sent = 0;

}  // namespace

// In this program it comes before the function of the C library.
extern "C" ssize_t write(int fd, const void* bytes, size_t size) {
  const bool signal = size == sizeof(std::uint64_t);  // of an eventfd
  while (signal && put_aside) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto done = syscall(SYS_write, fd, bytes, size);
  if (signal) ++signals_sent;
  return done;
}

namespace odomcalib::disk_worker_test {
namespace {

using namespace std::chrono_literals;

class Disk : public testing::Test {
 protected:
  void post(const std::string& name, std::future<void> until = {}) {
    worker_.post(
        [this, name, wait = std::make_shared<std::future<void>>(std::move(until))] {
          if (wait->valid()) wait->wait();
          worked_.push_back(name);
        },
        [this, name] { told_.push_back(name); });
  }
  bool wakes(int timeout_ms) {
    pollfd file{worker_.fd(), POLLIN, 0};
    return poll(&file, 1, timeout_ms) == 1;
  }
  /// Turns of a loop that waits for input until so many were told.
  void turn_until(std::size_t told) {
    for (int i = 0; i < 100 && told_.size() < told; ++i) {
      ASSERT_TRUE(wakes(5000));
      worker_.serve();
    }
  }

  std::vector<std::string> worked_;  // belongs to the thread until it was told
  std::vector<std::string> told_;
  std::promise<void> disk_;
  DiskWorker worker_;
};

TEST_F(Disk, works_in_the_order_in_which_it_was_asked) {
  for (const char* name : {"a", "b", "c", "d"}) post(name);
  turn_until(4);
  EXPECT_EQ(told_, (std::vector<std::string>{"a", "b", "c", "d"}));
  EXPECT_EQ(worked_, told_);
}

TEST_F(Disk, that_takes_its_time_holds_up_nobody) {
  const auto begin = std::chrono::steady_clock::now();
  post("slow", disk_.get_future());
  post("behind it");
  for (int i = 0; i < 1000; ++i) worker_.serve();
  EXPECT_FALSE(wakes(0));
  EXPECT_TRUE(told_.empty());
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 2s);
  disk_.set_value();
  turn_until(2);
  EXPECT_EQ(told_, (std::vector<std::string>{"slow", "behind it"}));
  EXPECT_FALSE(wakes(0));
}

TEST_F(Disk, tells_nothing_before_it_is_asked) {
  post("a");
  ASSERT_TRUE(wakes(5000));
  EXPECT_TRUE(told_.empty());
  worker_.serve();
  EXPECT_EQ(told_.size(), 1U);
}

TEST_F(Disk, takes_new_work_while_it_tells_of_the_last) {
  worker_.post([] {}, [this] { post("next"); });
  ASSERT_TRUE(wakes(5000));
  worker_.serve();
  turn_until(1);
  EXPECT_EQ(told_, (std::vector<std::string>{"next"}));
}

// A loop that it woke without end would turn as fast as the processor can.
TEST_F(Disk, whose_thread_is_put_aside_before_it_signals_wakes_the_loop_once) {
  const int before = signals_sent;
  put_aside = true;
  post("a");
  for (int i = 0; i < 5000 && told_.empty(); ++i) {
    worker_.serve();
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(told_, (std::vector<std::string>{"a"}));
  put_aside = false;
  for (int i = 0; i < 5000 && signals_sent == before; ++i) std::this_thread::sleep_for(1ms);
  ASSERT_TRUE(wakes(0));
  worker_.serve();
  EXPECT_FALSE(wakes(0));
}

TEST_F(Disk, finishes_what_it_was_asked_for_and_calls_nobody_any_more) {
  for (const char* name : {"a", "b", "c"}) post(name);
  worker_.finish();
  EXPECT_EQ(worked_, (std::vector<std::string>{"a", "b", "c"}));
  worker_.serve();
  EXPECT_TRUE(told_.empty());
  worker_.finish();
}

}  // namespace
}  // namespace odomcalib::disk_worker_test
