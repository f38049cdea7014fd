// The thread that waits for the disk in place of the loop. Loop and thread hand a single piece of work back
// and forth without a lock: a thread that the scheduler has put aside holds nothing that the loop waits for.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <thread>

#include "daemon/writeback/background.hpp"

namespace odomcalib {

class DiskWorker final : public Background {
 public:
  DiskWorker();
  ~DiskWorker() override;

  void post(std::function<void()> work, std::function<void()> done) override;
  void serve() override;
  [[nodiscard]] int fd() const override { return done_fd_; }
  [[nodiscard]] std::uint64_t taken() const override { return taken_; }
  void finish() override;

 private:
  enum class State { idle, working, done, ended };  // the thread owns `running_` while working
  struct Job {
    std::function<void()> work, done;
  };

  void run();
  void hand_over();
  void set(State state);

  std::deque<Job> waiting_;
  Job running_;
  std::atomic<State> state_ = State::idle;
  int done_fd_ = -1;
  std::uint64_t taken_ = 0;
  std::thread thread_;  // last: everything it uses exists
};

}  // namespace odomcalib
