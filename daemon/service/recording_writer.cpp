#include "daemon/service/recording_writer.hpp"

#include <utility>

namespace odomcalib {

RecordingWriter::RecordingWriter(std::unique_ptr<RecordingSink> sink)
    : sink_(std::move(sink)), thread_([this] { run(); }) {}

RecordingWriter::~RecordingWriter() {
  end();
  thread_.join();
}

bool RecordingWriter::push(RecordedItem item) {
  const std::size_t size = item.bytes.size();
  if (bytes_waiting() + size > kMostBytes) return false;
  auto kept = std::make_unique<RecordedItem>(std::move(item));
  if (!queue_.push(kept.get())) return false;
  (void)kept.release();  // NOLINT(bugprone-unused-return-value): the queue has it
  waiting_.fetch_add(size, std::memory_order_relaxed);
  wake();
  return true;
}

void RecordingWriter::end() {
  ended_.store(true, std::memory_order_release);
  wake();
}

void RecordingWriter::wake() {
  calls_.fetch_add(1, std::memory_order_release);
  calls_.notify_one();
}

std::optional<Error> RecordingWriter::problem() const {
  return failed_.load(std::memory_order_acquire) ? problem_ : std::nullopt;
}

void RecordingWriter::note(const Result<void>& done) {
  if (done.ok() || failed_.load(std::memory_order_relaxed)) return;
  problem_ = done.error();
  failed_.store(true, std::memory_order_release);
}

void RecordingWriter::drain() {
  RecordedItem* taken = nullptr;
  while (queue_.pop(taken)) {
    const std::unique_ptr<RecordedItem> item(taken);
    if (!failed_.load(std::memory_order_relaxed)) note(sink_->write(*item));
    waiting_.fetch_sub(item->bytes.size(), std::memory_order_relaxed);
  }
}

void RecordingWriter::run() {
  note(sink_->open());
  for (;;) {
    // Both are read before the queue: what comes later changes calls_, and after the end nothing comes.
    const std::uint32_t calls = calls_.load(std::memory_order_acquire);
    const bool last = ended_.load(std::memory_order_acquire);
    drain();
    if (last) break;
    calls_.wait(calls, std::memory_order_acquire);
  }
  if (!failed_.load(std::memory_order_relaxed)) note(sink_->finish());
  finished_.store(true, std::memory_order_release);
}

}  // namespace odomcalib
