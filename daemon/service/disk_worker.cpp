#include "daemon/service/disk_worker.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>
#include <utility>

namespace odomcalib {

// Without a descriptor (-1) the loop finds what is done when its wait for input is over, 20 ms later.
DiskWorker::DiskWorker() : done_fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)), thread_([this] { run(); }) {}

DiskWorker::~DiskWorker() {
  finish();
  set(State::ended);
  thread_.join();
  if (done_fd_ >= 0) close(done_fd_);
}

void DiskWorker::set(State state) {
  state_.store(state, std::memory_order_release);
  state_.notify_all();
}

void DiskWorker::post(std::function<void()> work, std::function<void()> done) {
  waiting_.push_back({std::move(work), std::move(done)});
  hand_over();
}

void DiskWorker::hand_over() {
  if (waiting_.empty() || state_.load(std::memory_order_acquire) != State::idle) return;
  running_ = std::move(waiting_.front());
  waiting_.pop_front();
  set(State::working);
}

void DiskWorker::run() {
  for (;;) {
    const State state = state_.load(std::memory_order_acquire);
    if (state == State::ended) return;
    if (state != State::working) {
      state_.wait(state, std::memory_order_acquire);
      continue;
    }
    running_.work();
    set(State::done);
    const std::uint64_t one = 1;
    (void)!write(done_fd_, &one, sizeof(one));
  }
}

void DiskWorker::serve() {
  // First: the thread may be put aside between "done" and its signal, which then comes when the work has been
  // taken long ago, and would wake the loop for ever.
  std::uint64_t count = 0;
  (void)!read(done_fd_, &count, sizeof(count));
  if (state_.load(std::memory_order_acquire) != State::done) return;
  ++taken_;
  const Job job = std::exchange(running_, {});
  set(State::idle);
  hand_over();
  job.done();
}

void DiskWorker::finish() {
  for (;;) {
    state_.wait(State::working, std::memory_order_acquire);
    running_ = {};
    set(State::idle);
    if (waiting_.empty()) return;
    hand_over();
  }
}

}  // namespace odomcalib
